// Numbers and structures that Rust and the shaders share; layout.rs has their meaning and tests that both agree.

const SHADOW_FILTER_RADIUS: i32 = 2;
const SHADOW_BORDER: u32 = 4u;
const SAME_SURFACE: f32 = 1e-6;
const DIRECTIONAL_TILES: u32 = 4u;
const LIGHT_AREA: u32 = 0u;
const LIGHT_POINT: u32 = 1u;
const LIGHT_SPOT: u32 = 2u;
const LIGHT_DIRECTIONAL: u32 = 3u;
const PI: f32 = 3.14159265358979;

struct LightRecord {
    position: vec3f,
    kind: u32,
    axis: vec3f,
    disk: f32,
    tangent: vec3f,
    first_layer: u32,
    bitangent: vec3f,
    layers: u32,
    strength: vec3f,
    reach: f32,
    cone_scale: f32,
    cone_offset: f32,
    padding: vec2f,
}

struct FrameRecord {
    view_projection: mat4x4f,
    eye: vec3f,
    light_count: u32,
    lattice_origin: vec3f,
    shadow_size: u32,
    lattice_inverse_step: vec3f,
    indirect: u32,
    lattice_dims: vec3u,
    reconstruction: u32,
    normal_bias: f32,
    value_scale: f32,
    filter_kind: u32,
    padding: u32,
}

struct MaterialRecord {
    albedo: vec3f,
    textured: u32,
    emission: vec3f,
    two_sided: u32,
}

struct FaceRecord {
    matrix: mat4x4f,
    perspective: u32,
    bias: f32,
    cap: f32,
    padding: u32,
}
