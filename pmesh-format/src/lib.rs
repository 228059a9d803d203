//! The .pmesh format: Melax progressive meshes as packets, every vertex count a level.
