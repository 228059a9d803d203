use std::collections::BTreeMap;

use quickcheck::quickcheck;

use super::{Candidate, Queue};

quickcheck! {
    /// Against a map that is searched from end to end: the same candidates come out in the same order.
    fn comes_out_in_order_of_cost_then_vertex(steps: Vec<(u8, u8, u8)>) -> bool {
        let mut queue = Queue::new(32);
        let mut map: BTreeMap<u32, (f64, u32)> = BTreeMap::new();
        let pop = |queue: &mut Queue, map: &mut BTreeMap<u32, (f64, u32)>| {
            let expected = map
                .iter()
                .min_by(|a, b| a.1.0.total_cmp(&b.1.0).then(a.0.cmp(b.0)))
                .map(|(&u, &(cost, v))| Candidate { cost, u, v });
            expected.inspect(|c| { map.remove(&c.u); });
            queue.pop() == expected
        };
        for (action, u, cost) in steps {
            let u = u32::from(u % 32);
            match action % 4 {
                0 => if !pop(&mut queue, &mut map) { return false; },
                1 => { queue.remove(u); map.remove(&u); }
                _ => {
                    // Few different costs, so that ties are common.
                    let candidate = Candidate { cost: f64::from(cost % 8), u, v: u32::from(cost) };
                    queue.set(candidate);
                    map.insert(u, (candidate.cost, candidate.v));
                }
            }
        }
        (0..33).all(|_| pop(&mut queue, &mut map))
    }
}
