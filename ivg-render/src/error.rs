/// Why a scene cannot be rendered. The scene is checked as a whole before the first pixel.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A picture of no or too many pixels.
    #[error(
        "a picture of {width} x {height} pixels with {supersampling} x {supersampling} samples a pixel is not possible: 1 to {MAX_SIDE} samples a side are"
    )]
    Size {
        /// Width asked for \[pixels\].
        width: u32,
        /// Height asked for \[pixels\].
        height: u32,
        /// Samples a pixel and axis asked for.
        supersampling: u32,
    },
    /// An option that is not about the size lies outside its range.
    #[error("{option} is {value}: it must lie in {range}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value asked for.
        value: u32,
        /// The range, in words.
        range: &'static str,
    },
    /// A mesh has normals, texture coordinates or materials, but not one for each vertex or triangle.
    #[error(
        "mesh {mesh}: {found} {attribute} for {expected}: there must be one each, or none where that is allowed"
    )]
    AttributeCount {
        /// Index of the mesh in the render scene.
        mesh: usize,
        /// Which attribute.
        attribute: &'static str,
        /// How many there are.
        found: usize,
        /// How many vertices or triangles there are.
        expected: usize,
    },
    /// A triangle names a vertex or material that does not exist.
    #[error("mesh {mesh}, triangle {triangle}: {what} {index} does not exist; there are {count}")]
    Index {
        /// Index of the mesh in the render scene.
        mesh: usize,
        /// Index of the triangle in the mesh.
        triangle: usize,
        /// Vertex or material.
        what: &'static str,
        /// The index it names.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A progressive mesh that is on the device does not fit what it is given or drawn with.
    #[error("a progressive mesh {problem}")]
    Progressive {
        /// What is wrong.
        problem: &'static str,
    },
    /// A material names a texture that does not exist, or a texture has not the texels its size says.
    #[error("material or texture {name:?}: {problem}")]
    Texture {
        /// Name of the material or texture.
        name: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// Not-a-number or an infinite value in a mesh, a material, a light or the camera.
    #[error("{what} has a value that is not finite")]
    NotFinite {
        /// What holds it, by name or index.
        what: String,
    },
    /// The camera looks nowhere or its angle is out of range.
    #[error("the camera {problem}")]
    Camera {
        /// What is wrong.
        problem: &'static str,
    },
    /// The grid has vertices without a value.
    #[error("the grid has {missing} vertices without a value: fill it before rendering")]
    GridNotFilled {
        /// How many.
        missing: usize,
    },
    /// The options ask for a reconstruction that cannot be evaluated from what the grid holds.
    #[error(
        "the grid holds {holds}, from which {reconstruction} cannot be evaluated: use Reconstruction::for_encoding"
    )]
    Reconstruction {
        /// Name of the reconstruction asked for.
        reconstruction: &'static str,
        /// Name of what the grid holds.
        holds: &'static str,
    },
    /// More triangles or vertices than 32-bit indices can name.
    #[error("the scene has {count} {what}: at most {limit} can be rendered")]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
}

/// Largest number of samples along a side of a picture, supersampling included: what every WebGPU device can
/// render to (`maxTextureDimension2D`).
pub const MAX_SIDE: u32 = 8192;
