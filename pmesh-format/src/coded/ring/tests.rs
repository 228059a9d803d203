use ivg_wire::splitmix64;

use super::{FEW, MOST, Spoke, order, round_few};
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
        let round = order(&mut spokes, count);
        if let Some(found) = round_few(&outs, &backs, count) {
            answers += 1;
            assert!(round, "{outs:?} {backs:?}");
            for (k, spoke) in spokes.iter().enumerate().take(count) {
                assert_eq!(found >> (4 * k) & 15, spoke.place, "{outs:?} {backs:?}");
            }
        }
    }
    assert!(answers > 5_000, "{answers} rings");
}

#[test]
fn dividing_by_reciprocals_is_exact() {
    for m in 1..80u32 {
        for k in 0..500u64 {
            let any = splitmix64(k, m.into()) >> 14;
            let multiple = any / u64::from(m) * u64::from(m);
            for x in [any, multiple, multiple.saturating_sub(1), (1 << 50) - 1 - k, k] {
                assert_eq!(divide(x, m), x / u64::from(m), "{x} / {m}");
            }
        }
    }
}
