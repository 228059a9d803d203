//! A frame: direct light with shadows plus indirect light from the grid, on wgpu or on the CPU.
