//! Choosing one of many lights in proportion to its power, in constant time.

/// An alias table (A. Walker 1977, construction by M. Vose 1991) over non-negative weights.
#[derive(Clone, Debug, Default)]
pub(crate) struct AliasTable {
    entries: Vec<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    /// Share of the column that keeps its own index, in 1/2³²; the rest goes to `alias`.
    threshold: u64,
    alias: u32,
}

impl AliasTable {
    /// A table that draws index i with probability `weights[i] / sum`, to within 2⁻³² a column; empty if no weight is
    /// positive.
    pub(crate) fn new(weights: &[f64]) -> Self {
        let total: f64 = weights.iter().sum();
        if total.is_nan() || total <= 0.0 {
            return Self::default();
        }
        let columns = weights.len() as f64;
        let mut scaled: Vec<f64> = weights.iter().map(|w| w / total * columns).collect();
        let mut entries: Vec<Entry> =
            (0u32..).zip(weights).map(|(alias, _)| Entry { threshold: FULL, alias }).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) =
            (0..scaled.len()).partition(|&i| scaled[i] < 1.0);
        while let (Some(&low), Some(&high)) = (small.last(), large.last()) {
            small.pop();
            entries[low] = Entry { threshold: (scaled[low] * FULL as f64) as u64, alias: high as u32 };
            scaled[high] -= 1.0 - scaled[low];
            if scaled[high] < 1.0 {
                large.pop();
                small.push(high);
            }
        }
        // What rounding leaves unpaired weighs 1 to within rounding, unless it weighs nothing.
        let heaviest =
            (0..weights.len()).fold(0, |best, i| if weights[i] > weights[best] { i } else { best });
        for low in small.into_iter().filter(|&i| weights[i] <= 0.0) {
            entries[low] = Entry { threshold: 0, alias: heaviest as u32 };
        }
        Self { entries }
    }

    /// Whether there is nothing to draw from.
    pub(crate) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The index that two uniform words draw. The table must not be empty.
    #[inline]
    pub(crate) fn draw(&self, column: u32, coin: u32) -> usize {
        let column = ((u64::from(column) * self.entries.len() as u64) >> 32) as usize;
        let entry = self.entries[column];
        if u64::from(coin) < entry.threshold { column } else { entry.alias as usize }
    }
}

/// A column that always keeps its own index.
const FULL: u64 = 1 << 32;

#[cfg(test)]
mod tests;
