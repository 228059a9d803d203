//! The registries of encodings, orders and units. Source: `spec/tables/registry.toml`.

use crate::values::Quantity;

/// How the values of a vertex are stored: the registry entries that this crate has (`spec/ivg.md`, section 6).
///
/// | encoding | bytes a vertex | decoding \[ns\] | error \[%\] | what is lost |
/// |---|---|---|---|---|
/// | `packed-oct24` | 42 | 40 | 4.4, six 2.5 | the channels' directions become one; direction off by 0.05° at most, colour by 1/511 |
/// | `packed-xyz24` | 42 | 38 | 4.4, six 2.5 | as `packed-oct24`; direction off by 0.55° at most |
/// | `pair-f16` | 72 | 60 | 4.4, six 2.5 | one direction; off by 0.04° at most, colour by 1/2048 |
/// | `pair-f16x4` | 96 | 72 | 4.4, six 2.5 | as `pair-f16` |
/// | `pair-f32` | 144 | 48 | 4.4, six 2.5 | one direction, nothing else |
/// | `vectors-f32` | 216 | 26 | 2.2, six 1.8 | nothing |
/// | `sh2-28` | 28 | 13 | 1.5 | light finer than degree 2; a ratio off by half of 1/127 of its bound |
///
/// The error is the relative RMSE of the irradiance of surfaces on a baked grid (a room, 16³ vertices) against path tracing,
/// evaluated from three vectors and from six; `cargo run --release -p ivg-bake --example accuracy` prints it for any scene. The
/// papers' formula is off by 26 %.
///
/// Decoding is a vertex' share of checksum, checks and conversion to binary32 on one core of a server of 2024, as
/// `cargo bench -p ivg-format --bench codec` prints it: two to nine times as fast as zstd gives back the same numbers.
/// Copying them takes 10 ns.
///
/// What these losses mean for the irradiance of a surface is another matter, and measured on baked grids by
/// `cargo run --release -p ivg-bake --example accuracy`. In short: the one direction for three channels costs several times
/// what rounding does, where lights of different colours come from different sides; no choice of bits mends that. There, and
/// wherever accuracy for the bytes counts, plain spherical harmonics, [`Encoding::Sh2`], are the better choice. The packed
/// encodings are for drawing from textures, three fetches a lookup; [`Encoding::VectorsF32`] is for keeping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Encoding {
    /// A direction of 24 bits in the octahedral map and a colour in RGB9E5 for each hemisphere: 42 bytes.
    #[default]
    PackedOct24,
    /// As Web3D 2008 has it: a direction of 8 bits a coordinate and a colour in RGB9E5 for each hemisphere: 42 bytes.
    PackedXyz24,
    /// Direction and colour of each hemisphere in binary16: 72 bytes.
    PairF16,
    /// As [`Encoding::PairF16`], each padded to four numbers, as textures want them: 96 bytes.
    PairF16x4,
    /// Direction and colour of each hemisphere in binary32: 144 bytes.
    PairF32,
    /// 54 binary32 numbers `[hemisphere 6][rgb 3][xyz 3]`: 216 bytes, exact.
    VectorsF32,
    /// Spherical harmonics of the radiance to degree 2: RGB9E5 for the mean, 8 bits for the ratio of each other
    /// coefficient to it: 28 bytes, the most accurate for its size.
    Sh2,
}

impl Encoding {
    /// Every encoding that this crate has, in the order of their ids.
    pub const ALL: &'static [Self] = &[
        Self::PackedOct24,
        Self::PackedXyz24,
        Self::PairF16,
        Self::PairF16x4,
        Self::PairF32,
        Self::VectorsF32,
        Self::Sh2,
    ];

    /// The number in the registry, as stored in the header.
    #[must_use]
    pub const fn id(self) -> u16 {
        match self {
            Self::PackedOct24 => 1,
            Self::PackedXyz24 => 2,
            Self::PairF16 => 3,
            Self::PairF16x4 => 4,
            Self::PairF32 => 5,
            Self::VectorsF32 => 6,
            Self::Sh2 => 7,
        }
    }

    /// The encoding with this registry number, if this crate has it.
    #[must_use]
    pub fn from_id(id: u16) -> Option<Self> {
        Self::ALL.iter().copied().find(|encoding| encoding.id() == id)
    }

    /// The name in the registry, as users write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PackedOct24 => "packed-oct24",
            Self::PackedXyz24 => "packed-xyz24",
            Self::PairF16 => "pair-f16",
            Self::PairF16x4 => "pair-f16x4",
            Self::PairF32 => "pair-f32",
            Self::VectorsF32 => "vectors-f32",
            Self::Sh2 => "sh2-28",
        }
    }

    /// The encoding with this registry name, if this crate has it.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|encoding| encoding.name() == name)
    }

    /// Stored bytes of one vertex.
    #[must_use]
    pub const fn bytes_per_vertex(self) -> u64 {
        match self {
            Self::PackedOct24 | Self::PackedXyz24 => 42,
            Self::PairF16 => 72,
            Self::PairF16x4 => 96,
            Self::PairF32 => 144,
            Self::VectorsF32 => 216,
            Self::Sh2 => 28,
        }
    }

    /// What the numbers of a vertex are.
    #[must_use]
    pub const fn quantity(self) -> Quantity {
        match self {
            Self::Sh2 => Quantity::Radiance,
            _ => Quantity::Vectors,
        }
    }
}

/// What the numbers of the grid measure. glTF's light intensities are carried 1:1; nothing is ever multiplied
/// by 683 (IVG-HDR-05).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Units {
    /// Irradiance vectors in W/m², radiance harmonics in W/(m² sr).
    #[default]
    Radiometric,
    /// Irradiance vectors in lux, radiance harmonics in cd/m².
    Photometric,
}

impl Units {
    /// The number in the registry, as stored in the header.
    #[must_use]
    pub const fn id(self) -> u8 {
        match self {
            Self::Radiometric => 0,
            Self::Photometric => 1,
        }
    }

    /// The units with this registry number.
    #[must_use]
    pub const fn from_id(id: u8) -> Option<Self> {
        match id {
            0 => Some(Self::Radiometric),
            1 => Some(Self::Photometric),
            _ => None,
        }
    }

    /// The name in the registry.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Radiometric => "radiometric",
            Self::Photometric => "photometric",
        }
    }
}

/// In which order bundles take the vertices: the registry entries that this crate has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Order {
    /// Some vertices of every slice across the longest axis, each slice in its own permutation (IVG-ORD-07).
    #[default]
    Slices,
    /// A recursive spread over the volume: every prefix covers all of it evenly (IVG-OCT-02).
    Octree,
    /// Each bundle lists its vertices, so that a writer can send what matters most first (IVG-DIRE-01).
    Explicit,
}

impl Order {
    /// Every order that this crate has, in the order of their ids.
    pub const ALL: &'static [Self] = &[Self::Slices, Self::Octree, Self::Explicit];

    /// The number in the registry, as stored in the header.
    #[must_use]
    pub const fn id(self) -> u16 {
        match self {
            Self::Slices => 1,
            Self::Octree => 2,
            Self::Explicit => 3,
        }
    }

    /// The order with this registry number, if this crate has it.
    #[must_use]
    pub fn from_id(id: u16) -> Option<Self> {
        Self::ALL.iter().copied().find(|order| order.id() == id)
    }

    /// The name in the registry, as users write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slices => "slices",
            Self::Octree => "octree",
            Self::Explicit => "explicit",
        }
    }

    /// The order with this registry name, if this crate has it.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|order| order.name() == name)
    }
}
