//! A set of nodes, one bit each.

/// Marked nodes of a level.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    words: Vec<u64>,
    len: usize,
}

impl Marks {
    pub(super) fn new(len: usize) -> Self {
        Self { words: vec![0; len.div_ceil(64)], len }
    }

    #[inline]
    pub(super) fn insert(&mut self, node: usize) {
        self.words[node / 64] |= 1 << (node % 64);
    }

    #[inline]
    pub(super) fn contains(&self, node: usize) -> bool {
        self.words[node / 64] >> (node % 64) & 1 == 1
    }

    /// Whether every node is marked.
    pub(super) fn is_full(&self) -> bool {
        self.count() == self.len
    }

    /// Whether no node is marked.
    pub(super) fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// Number of marked nodes.
    pub(super) fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Marks those nodes that are not marked, and no others.
    pub(super) fn complement(&mut self) {
        self.words.iter_mut().for_each(|word| *word = !*word);
        self.cut();
    }

    pub(super) fn clear(&mut self) {
        self.words.fill(0);
    }

    /// Marks every node.
    pub(super) fn fill(&mut self) {
        self.words.fill(u64::MAX);
        self.cut();
    }

    /// Takes the marks from those nodes for which `keep` says no.
    pub(super) fn retain(&mut self, mut keep: impl FnMut(usize) -> bool) {
        for (index, word) in self.words.iter_mut().enumerate() {
            let mut rest = *word;
            while rest != 0 {
                let bit = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                if !keep(64 * index + bit) {
                    *word &= !(1 << bit);
                }
            }
        }
    }

    /// The marked nodes, ascending.
    #[inline]
    pub(super) fn iter(&self) -> impl Iterator<Item = usize> {
        self.words.iter().enumerate().flat_map(|(group, &word)| nodes(group, word))
    }

    /// Marks everything that `other` marks.
    pub(super) fn join(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(word, other)| *word |= other);
    }

    /// Number of groups of 64 nodes.
    pub(super) fn groups(&self) -> usize {
        self.words.len()
    }

    /// The bits of a group, that of its first node lowest.
    #[inline]
    pub(super) fn word(&self, group: usize) -> u64 {
        self.words[group]
    }

    /// Marks the nodes of a group whose bits are set.
    #[inline]
    pub(super) fn insert_word(&mut self, group: usize, word: u64) {
        self.words[group] |= word;
    }

    /// Replaces the bits of each group.
    #[inline]
    pub(super) fn map_words(&mut self, new: impl Fn(usize, u64) -> u64) {
        self.words.iter_mut().enumerate().for_each(|(group, word)| *word = new(group, *word));
    }

    /// The marked nodes and those a stride before or after them.
    pub(super) fn with_neighbours(self, strides: [usize; 3]) -> Self {
        let mut all = self.clone();
        for stride in strides {
            let (groups, bits) = (stride / 64, stride % 64);
            let at =
                |group: Option<usize>| group.and_then(|group| self.words.get(group)).copied().unwrap_or(0);
            // A shift by all 64 bits is none at all.
            let carry = |word: u64, up: bool| match (bits, up) {
                (0, _) => 0,
                (_, true) => word >> (64 - bits),
                (_, false) => word << (64 - bits),
            };
            for (group, word) in all.words.iter_mut().enumerate() {
                *word |=
                    at(group.checked_sub(groups)) << bits | carry(at(group.checked_sub(groups + 1)), true);
                *word |=
                    at(group.checked_add(groups)) >> bits | carry(at(group.checked_add(groups + 1)), false);
            }
        }
        all.cut();
        all
    }

    /// Takes away marks beyond the last node.
    fn cut(&mut self) {
        if !self.len.is_multiple_of(64)
            && let Some(last) = self.words.last_mut()
        {
            *last &= (1 << (self.len % 64)) - 1;
        }
    }
}

/// The nodes of a group whose bits are set.
#[inline]
pub(super) fn nodes(group: usize, mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros() as usize)?;
        word &= word - 1;
        Some(64 * group + bit)
    })
}
