use ivg_wire::splitmix64;

use super::{FEW, MOST, Spoke, order, round, search};
use crate::coded::geometry::divide;

#[test]
fn a_few_faces_have_the_order_that_any_number_has() {
    let mut answers = 0;
    for seed in 0..20_000u64 {
        let random = |k: u64| splitmix64(seed, k);
        let count = 2 + random(0) as usize % (FEW - 1);
        // A ring of vertices whose lowest bits are often the same, its faces in any order, sometimes with a vertex changed.
        let vertex = |k: usize| (random(1 + k as u64) % 4 * 128 + k as u64 % 5) as u32;
        let (mut outs, mut backs) = ([u32::MAX; FEW], [0; FEW]);
        for k in 0..count {
            let to = (k * 5 + seed as usize) % count;
            let to = if count == 5 { (to + k) % count } else { to };
            outs[to] = vertex(k);
            backs[to] = vertex((k + 1) % count);
        }
        if random(20) % 4 == 0 {
            outs[random(21) as usize % count] = vertex(0);
        }
        let mut spokes = [Spoke::default(); MOST];
        for k in 0..count {
            spokes[k] = Spoke { place: k as u32, out: outs[k], back: backs[k] };
        }
        let is_round = order(&mut spokes, count);
        let (mut many_outs, mut many_backs) = ([u32::MAX; MOST], [0; MOST]);
        many_outs[..FEW].copy_from_slice(&outs);
        many_backs[..FEW].copy_from_slice(&backs);
        let searched = search(&many_outs, &many_backs, count);
        assert_eq!(searched.is_some(), is_round, "{outs:?} {backs:?}");
        let few = round(&outs, &backs, count);
        let many = round(&many_outs, &many_backs, count);
        assert_eq!(few, many.map(|many| core::array::from_fn(|k| many[k])), "{outs:?} {backs:?}");
        if let (Some(found), Some(searched)) = (few, searched) {
            answers += 1;
            for (k, spoke) in spokes.iter().enumerate().take(count) {
                let place = [found[k], searched[k]].map(u32::from);
                assert_eq!(place, [spoke.place; 2], "{outs:?} {backs:?}");
            }
        } else {
            assert!(few.is_none(), "{outs:?} {backs:?}");
        }
    }
    assert!(answers > 5_000, "{answers} rings");
}

#[test]
fn dividing_by_reciprocals_is_exact() {
    for m in 1..80u32 {
        for k in 0..500u32 {
            let most = (m.min(4) << 27) - 1;
            let any = (splitmix64(k.into(), m.into()) >> 35) as u32 % most;
            let multiple = any / m * m;
            for x in [any, multiple, multiple.saturating_sub(1), most - k, k] {
                assert_eq!(divide(x, m), x / m, "{x} / {m}");
            }
        }
    }
}
