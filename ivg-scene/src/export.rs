//! Writing scenes as GLB, and single meshes as OBJ and PLY. The output depends on the input alone, byte for byte.

mod glb;
mod obj;
mod ply;

pub use glb::{GlbOptions, write_glb};
pub use obj::{write_obj, write_obj_joined};
pub use ply::write_ply;

#[cfg(test)]
mod tests;
