//! Which arrays a file has.

/// What a file stores beside positions, faces and parents (PMESH-HDR-05).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    /// Wedges have unit normals.
    pub normals: bool,
    /// Wedges have texture coordinates.
    pub uvs: bool,
    /// Wedges have colours.
    pub colours: bool,
    /// Faces have materials; without, every face has material 0.
    pub materials: bool,
    /// A vertex may have several wedges; without, wedge and vertex have the same index.
    pub seams: bool,
}

impl Attributes {
    /// From the bits of the header; `None` if one of them is reserved.
    #[must_use]
    pub const fn from_bits(bits: u16) -> Option<Self> {
        if bits >> 5 != 0 {
            return None;
        }
        Some(Self {
            normals: bits & 1 != 0,
            uvs: bits & 2 != 0,
            colours: bits & 4 != 0,
            materials: bits & 8 != 0,
            seams: bits & 16 != 0,
        })
    }

    /// The bits of the header.
    #[must_use]
    pub const fn bits(self) -> u16 {
        self.normals as u16
            | (self.uvs as u16) << 1
            | (self.colours as u16) << 2
            | (self.materials as u16) << 3
            | (self.seams as u16) << 4
    }

    /// Whether wedges have any attribute.
    #[must_use]
    pub const fn on_wedges(self) -> bool {
        self.normals || self.uvs || self.colours
    }
}
