use ivg_wire::splitmix64;

use crate::coded::geometry::divide;

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
