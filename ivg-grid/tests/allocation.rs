//! What a file makes a reader allocate: nothing for what it only declares.

use std::alloc::System;

use ivg_format::{EncodeOptions, GridSource, Lattice, Limits, encode};
use ivg_grid::{GridError, IrradianceGrid};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// One test: the allocator counts for the whole process.
#[test]
fn allocation_follows_the_bytes_there_are_not_those_declared() {
    let lattice = Lattice::new([24; 3], [0.0; 3], [1.0; 3]).expect("a box");
    let vectors = vec![[[[0.0; 3]; 3]; 6]; 24 * 24 * 24];
    let bytes = encode(&GridSource::new(lattice, &vectors), &EncodeOptions::default()).expect("a sound grid");

    let region = Region::new(ALLOCATOR);
    let truncated = IrradianceGrid::from_file(&bytes[..bytes.len() - 1], &Limits::default());
    assert!(matches!(truncated, Err(GridError::Format(_))));
    let allocated = region.change().bytes_allocated;
    assert!(allocated < 1_000, "{allocated} bytes for a file that ends early");

    let region = Region::new(ALLOCATOR);
    let (grid, _) = IrradianceGrid::from_file(&bytes, &Limits::default()).expect("a whole file");
    let allocated = region.change().bytes_allocated;
    assert!(allocated >= 216 * grid.vertex_count(), "the grid itself");
    assert!(allocated < 6 * bytes.len(), "{allocated} bytes for a file of {}", bytes.len());
}
