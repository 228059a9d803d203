//! How a file stores its packets and its positions: the registries of the header.

/// How packets are stored (PMESH-HDR-03).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Arrays as graphics processors take them.
    #[default]
    Raw,
    /// The same things, entropy coded.
    Coded,
}

impl Mode {
    /// All modes, by ascending id.
    pub const ALL: &[Self] = &[Self::Raw, Self::Coded];

    /// The name in the specification: `raw` or `coded`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Coded => "coded",
        }
    }

    /// The mode of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|mode| mode.name() == name)
    }

    /// The number in the header.
    pub(crate) const fn id(self) -> u8 {
        match self {
            Self::Raw => 1,
            Self::Coded => 2,
        }
    }

    /// The mode of that number; `None` for 0, which is forbidden, and for reserved ones.
    pub(crate) fn from_id(id: u8) -> Option<Self> {
        Self::ALL.iter().copied().find(|mode| mode.id() == id)
    }
}

/// How positions are stored (PMESH-HDR-04).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Positions {
    /// Three binary32 numbers, as given.
    #[default]
    F32,
    /// That many bits along the longest side of the bounding box, [`Positions::LEAST_BITS`] to [`Positions::MOST_BITS`].
    Quantised(u8),
}

/// Names of the quantised encodings, from [`Positions::LEAST_BITS`] on.
const QUANTISED: [&str; 7] = ["q10", "q11", "q12", "q13", "q14", "q15", "q16"];

impl Positions {
    /// The fewest bits that positions can be quantised to.
    pub const LEAST_BITS: u8 = 10;

    /// The most bits that positions can be quantised to.
    pub const MOST_BITS: u8 = 16;

    /// All encodings, by ascending id.
    pub const ALL: &[Self] = &[
        Self::F32,
        Self::Quantised(10),
        Self::Quantised(11),
        Self::Quantised(12),
        Self::Quantised(13),
        Self::Quantised(14),
        Self::Quantised(15),
        Self::Quantised(16),
    ];

    /// The name in the specification: `f32`, or `q10` to `q16`; `-` for a number of bits that does not exist.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::Quantised(bits) => {
                let index = bits.checked_sub(Self::LEAST_BITS).map(usize::from);
                index.and_then(|index| QUANTISED.get(index)).copied().unwrap_or("-")
            }
        }
    }

    /// The encoding of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|positions| positions.name() == name)
    }

    /// Bits of a coordinate on the lattice; `None` for binary32 numbers.
    #[must_use]
    pub const fn bits(self) -> Option<u8> {
        match self {
            Self::F32 => None,
            Self::Quantised(bits) => Some(bits),
        }
    }

    /// Whether it is one of [`Positions::ALL`].
    pub(crate) fn exists(self) -> bool {
        Self::ALL.contains(&self)
    }

    /// The number in the header; 0 for a number of bits that does not exist.
    pub(crate) fn id(self) -> u8 {
        (1u8..).zip(Self::ALL).find(|&(_, &positions)| positions == self).map_or(0, |(id, _)| id)
    }

    /// The encoding of that number; `None` for 0, which is forbidden, and for reserved ones.
    pub(crate) fn from_id(id: u8) -> Option<Self> {
        id.checked_sub(1).and_then(|index| Self::ALL.get(usize::from(index))).copied()
    }
}
