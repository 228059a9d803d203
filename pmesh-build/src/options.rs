//! What a caller chooses, and what it is told afterwards.

/// How the order of collapses is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Cost {
    /// Area-weighted quadrics (Garland and Heckbert 1997) of the planes around both end points, evaluated at the
    /// vertex that stays, with constraint planes along borders and seams; and at least the square of the distance between
    /// the whole surface and what is left of it there, times the area that a vertex stands for on average.
    #[default]
    Quadric,
    /// Edge length times the greatest turn of a normal (Melax, "A Simple, Fast, and Effective Polygon Reduction
    /// Algorithm", Game Developer, November 1998): what Web3D 2008 orders its vertices by. For comparison.
    Melax,
}

impl Cost {
    /// Both, in the order in which a user should try them.
    pub const ALL: [Self; 2] = [Self::Quadric, Self::Melax];

    /// The name a user writes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quadric => "quadric",
            Self::Melax => "melax",
        }
    }

    /// The cost of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|cost| cost.name() == name)
    }
}

/// Choices of [`build`](crate::build).
#[derive(Debug, Clone, PartialEq)]
pub struct BuildOptions {
    /// What a collapse costs.
    pub cost: Cost,
    /// Whether vertices at exactly the same position become one vertex with several wedges. Without it a mesh that
    /// repeats its vertices along seams tears there. Default: true.
    pub weld: bool,
    /// How much a deviation of attributes counts beside one of the surface. Default: nothing.
    pub attributes: AttributeWeights,
}

/// How many metres of distance a unit of deviation of an attribute is worth, for [`Cost::Quadric`]. With a weight the
/// order spares vertices where the attribute bends, and the error of a level is the root mean square of distance and
/// weighted deviation together. An attribute that runs linearly costs nothing; neither does one with weight 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AttributeWeights {
    /// Metres a unit of a coordinate of a normal \[m\]; 0 or more.
    pub normal: f64,
    /// Metres a unit of a texture coordinate (the width of the image) \[m\]; 0 or more.
    pub uv: f64,
    /// Metres for a colour or alpha from 0 to 255 \[m\]; 0 or more.
    pub colour: f64,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { cost: Cost::Quadric, weld: true, attributes: AttributeWeights::default() }
    }
}

/// What [`build`](crate::build) found, dropped and made. Counts, unless a unit is given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct BuildReport {
    /// Vertices of the input.
    pub input_vertices: usize,
    /// Triangles of the input.
    pub input_triangles: usize,
    /// Vertices that were welded to another one at the same position.
    pub welded_vertices: usize,
    /// Wedges that were merged with another one of the same vertex and the same attributes.
    pub merged_wedges: usize,
    /// Triangles dropped because two corners are the same vertex.
    pub dropped_degenerate: usize,
    /// Triangles dropped because an earlier one has the same vertices in the same turn and the same material.
    pub dropped_duplicate: usize,
    /// Vertices dropped because no triangle that was kept uses them.
    pub dropped_unreferenced: usize,
    /// Triangles kept although their area is zero.
    pub zero_area: usize,
    /// Edges of the kept mesh with one face.
    pub boundary_edges: usize,
    /// Edges of the kept mesh with two faces that differ in wedges or material.
    pub seam_edges: usize,
    /// Edges of the kept mesh with three or more faces.
    pub nonmanifold_edges: usize,
    /// Vertices of the full level.
    pub vertices: usize,
    /// Wedges of the full level.
    pub wedges: usize,
    /// Faces of the full level.
    pub faces: usize,
    /// Vertices of the coarsest level.
    pub base_vertices: usize,
    /// Faces of the coarsest level.
    pub base_faces: usize,
    /// Collapses made under relaxed rules on borders, seams and topology.
    pub relaxed_collapses: usize,
    /// Collapses made without regard to flipped or flattened faces either.
    pub forced_collapses: usize,
    /// Number of vertices when the first relaxed collapse was made; 0 if there was none.
    pub relaxed_from: usize,
    /// Vertices that had lost all their faces and were removed.
    pub isolated_vertices: usize,
    /// Distance between neighbouring f32 numbers at the largest coordinate \[m\]: details below it were lost before
    /// the mesh came here.
    pub coordinate_spacing: f32,
    /// Diagonal of the bounding box \[m\].
    pub diagonal: f64,
}

impl BuildReport {
    /// Number of levels: every vertex count from the base to the full mesh.
    pub fn levels(&self) -> usize {
        self.vertices - self.base_vertices + 1
    }

    /// Whether the coordinates are so coarse that the shape suffers: fewer than 12 bits over the diagonal, the least
    /// that meshes are commonly quantised to.
    pub fn precision_lost(&self) -> bool {
        self.diagonal > 0.0 && f64::from(self.coordinate_spacing) * 4096.0 > self.diagonal
    }
}
