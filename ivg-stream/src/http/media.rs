//! Media types of the files in a scene directory.

use std::path::Path;

/// Media type of an irradiance grid, `spec/stream.md` STR-SRV-06.
pub const MEDIA_TYPE_IVG: &str = "application/vnd.ivg.irradiance-grid";
/// Media type of a progressive mesh, `spec/stream.md` STR-SRV-06.
pub const MEDIA_TYPE_PMESH: &str = "application/vnd.ivg.progressive-mesh";

/// The media type of a file by its extension; bytes that nobody interprets where it is unknown, so that a
/// directory with a page in it does not become a web site.
pub(crate) fn media_type(path: &Path) -> &'static str {
    match path.extension().and_then(|e| e.to_str()) {
        Some("glb") => "model/gltf-binary",
        Some("gltf") => "model/gltf+json",
        Some("ivg") => MEDIA_TYPE_IVG,
        Some("pmesh") => MEDIA_TYPE_PMESH,
        Some("png") => "image/png",
        Some("jpg" | "jpeg") => "image/jpeg",
        Some("json") => "application/json",
        _ => "application/octet-stream",
    }
}
