//! What an accumulator file makes a reader allocate: nothing for what it only declares (ACC-READ-02).

use std::alloc::System;

use ivg_bake::Accumulator;
use ivg_format::Quantity;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[allow(dead_code, reason = "shared with the other tests, which use other parts")]
mod sample;

use sample::{HEADER, Parts, file};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Bytes that `Accumulator::from_bytes` allocates, and whether it accepts.
fn read(bytes: &[u8]) -> (usize, bool) {
    let region = Region::new(ALLOCATOR);
    let accepted = Accumulator::from_bytes(bytes).is_ok();
    (region.change().bytes_allocated, accepted)
}

/// One test: the allocator counts for the whole process.
#[test]
fn counts_that_lie_allocate_nothing() {
    let bytes = file(Quantity::Vectors);
    let whole = Parts::of(&bytes);
    let (allocated, accepted) = read(&bytes);
    assert!(accepted && allocated >= 4 * 72 * 8, "the sums: {allocated}");
    assert!(allocated < 4 * bytes.len(), "{allocated} for a file of {}", bytes.len());

    // 16,777,216 vertices, whose sums would be 9.7 GB; lights of 16 MiB; a name of 4 GiB.
    let vertices = whole.clone().with_header(112, &[0, 1, 0, 1, 0, 1]);
    let lights = whole.clone().with_record(0, 0, &(1u64 << 24).to_le_bytes());
    let name = whole.clone().with_record(1, 1, &u32::MAX.to_le_bytes());
    let both = vertices.clone().with_record(0, 0, &(1u64 << 24).to_le_bytes());
    for (what, parts) in [("vertices", &vertices), ("lights", &lights), ("name", &name), ("both", &both)] {
        let lying = parts.file();
        // As it is, and declaring the length that its counts ask for.
        for length in [lying.len() as u64, 1 << 34, u64::MAX] {
            let mut lying = lying.clone();
            lying[48..56].copy_from_slice(&length.to_le_bytes());
            let mut header = lying[..HEADER].to_vec();
            ivg_wire::seal_header(&mut header);
            lying[..HEADER].copy_from_slice(&header);
            let (allocated, accepted) = read(&lying);
            assert!(!accepted, "{what}");
            assert!(allocated < 1000, "{what}: {allocated} bytes allocated");
        }
    }
}
