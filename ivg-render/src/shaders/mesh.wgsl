// Corners of progressive meshes, fetched from arrays that stay on the device: gpu/mesh.rs. What is computed here for each
// corner, upload.rs computes for other meshes.

@group(2) @binding(0) var<storage, read> mesh_positions: array<f32>;
@group(2) @binding(1) var<storage, read> mesh_normals: array<f32>;
@group(2) @binding(2) var<storage, read> mesh_uvs: array<f32>;
@group(2) @binding(3) var<storage, read> mesh_corners: array<u32>;
@group(2) @binding(4) var<storage, read> mesh_materials: array<u32>;

// `wanted`: 0 for the faces of every material, else the only one that is drawn, plus one.
@vertex
fn vertex_mesh(@builtin(vertex_index) corner: u32, @builtin(instance_index) wanted: u32) -> Surface {
    let face = corner / 3u;
    if wanted != 0u && mesh_materials[face] + 1u != wanted {
        // All corners of the face in one place out of view.
        return Surface(vec4f(2.0, 2.0, 2.0, 1.0), vec3f(0.0), vec3f(0.0), vec2f(0.0), vec3f(0.0));
    }
    let a = mesh_position(mesh_corners[3u * face]);
    let across = cross(
        mesh_position(mesh_corners[3u * face + 1u]) - a,
        mesh_position(mesh_corners[3u * face + 2u]) - a,
    );
    let area = length(across);
    var face_normal = vec3f(0.0);
    if area > 0.0 {
        face_normal = across * (1.0 / area);
    }
    let wedge = mesh_corners[corner];
    let position = mesh_position(wedge);
    let normal = vec3f(mesh_normals[3u * wedge], mesh_normals[3u * wedge + 1u], mesh_normals[3u * wedge + 2u]);
    var uv = vec2f(0.0);
    // Of a mesh without texture coordinates the array has none but a few zeros.
    if 2u * wedge + 1u < arrayLength(&mesh_uvs) {
        uv = vec2f(mesh_uvs[2u * wedge], mesh_uvs[2u * wedge + 1u]);
    }
    return Surface(frame.view_projection * vec4f(position, 1.0), position, normal, uv, face_normal);
}

fn mesh_position(wedge: u32) -> vec3f {
    return vec3f(mesh_positions[3u * wedge], mesh_positions[3u * wedge + 1u], mesh_positions[3u * wedge + 2u]);
}
