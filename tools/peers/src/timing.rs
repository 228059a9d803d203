//! Times on a machine that others use too: processor time of this process, which runs one thread; medians.

use std::hint::black_box;

use cpu_time::ProcessTime;

/// The median processor time of `runs` calls \[s\].
pub(crate) fn median<T>(runs: usize, mut call: impl FnMut() -> T) -> f64 {
    let mut times: Vec<f64> = (0..runs.max(1))
        .map(|_| {
            let start = ProcessTime::now();
            black_box(call());
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
