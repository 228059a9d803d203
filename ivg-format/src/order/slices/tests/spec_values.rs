//! The values printed in `spec/ivg.md` (IVG-ORD-11), computed by a program written from its text alone.

pub(super) const LATTICE_4_3_2: &[&[u64]] =
    &[&[4, 16, 1, 13, 6, 2, 19, 7], &[17, 21, 14, 22], &[5, 9, 18, 10]];
pub(super) const PERMUTATION_1000: &[u32] = &[553, 232, 215, 354, 811, 825, 500, 56];
