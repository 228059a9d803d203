use super::{PHOTONS_A_PIECE, Photons};

/// All photons that some pieces name.
fn listed(photons: Photons) -> Vec<u64> {
    let (first, pieces) = photons.pieces();
    (first..first + pieces).flat_map(|piece| photons.piece(piece)).collect()
}

#[test]
fn shards_and_stretches_together_are_every_photon_once() {
    let total = 5 * PHOTONS_A_PIECE + 77;
    for of in [1, 2, 3, 7] {
        for cut in [0, 1, PHOTONS_A_PIECE - 1, PHOTONS_A_PIECE, 3 * PHOTONS_A_PIECE + 5, total] {
            let mut all = Vec::new();
            for share in 0..of {
                for (first, last) in [(0, cut), (cut, total)] {
                    all.extend(listed(Photons { first, last, share, of }));
                }
            }
            all.sort_unstable();
            assert!(all.iter().copied().eq(0..total), "{of} shards cut at {cut}");
        }
    }
}

#[test]
fn shards_are_dealt_whole_pieces_in_turn() {
    let photons = Photons { first: 0, last: 4 * PHOTONS_A_PIECE, share: 1, of: 3 };
    assert!(listed(photons).into_iter().eq(PHOTONS_A_PIECE..2 * PHOTONS_A_PIECE));
}
