//! The grid without photons: every vertex path traced.

use std::sync::atomic::{AtomicU64, Ordering};

use ivg_grid::GridValues;

use super::{AccuracyReport, EndedBy, Simulated, beyond, student};
use crate::bake::Job;
use crate::estimate::held::Held;
use crate::estimate::vertex_gather::{Enough, FEWEST_PATHS, VertexGather};
use crate::trace::Books;
use crate::workers::{map, map_until};
use crate::{BakeError, BakeStage};

/// Paths of each vertex before anything else if there is little time: the fewest that tell their variance.
const FIRST_PATHS: u32 = 128;

/// Share of the squared error asked for that vertices may have in the mean, so that the bound stays below it.
const AIM: f64 = 0.9;

/// With little time, vertices have one in so many of their paths first.
const PARTS: [u32; 3] = [16, 4, 1];

/// Gathers at every vertex that light reaches: with the options' paths, or to their accuracy. If there is a limit to the time, every
/// vertex has a few paths first, and as many as it is to have afterwards.
pub(crate) fn run<V: Held + Default>(job: &Job<'_>) -> Result<Simulated, BakeError>
where
    GridValues: From<Vec<V>>,
{
    job.workers.monitor.stage(BakeStage::Gathering);
    let vertices: Vec<usize> = job.counted().collect();
    let done = AtomicU64::new(0);
    let one = |vertex: usize, enough: Enough| {
        let gather = job.ready.stage.gather::<V>(job.surroundings.eyes[vertex], vertex, job.seed(), enough);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        job.workers.monitor.progress(done.min(vertices.len() as u64), vertices.len() as u64);
        gather
    };
    let first = match (job.options.accuracy, job.workers.monitor.time_spent()) {
        (_, Some(_)) => Enough::Roughly(FIRST_PATHS),
        (Some(_), None) => Enough::Paths(FEWEST_PATHS),
        (None, None) => Enough::Paths(job.options.paths),
    };
    let mut gathers = map(&job.workers, vertices.len(), |n| one(vertices[n], first))?;
    let mut paths: u64 = gathers.iter().map(|gather| u64::from(gather.paths)).sum();
    let aim = job
        .options
        .accuracy
        .map(|asked| AIM * asked.powi(2) * signal(&gathers) / vertices.len().max(1) as f64);
    let most = job.options.paths;
    // With little time all vertices have a part of their paths before any has all: these are traced anew, a third more.
    let timed = job.workers.monitor.time_spent().is_some();
    let parts: &[u32] = if timed { &PARTS } else { &[1] };
    let step = |&part: &u32| match aim {
        Some(aim) => Some(Enough::Variance { variance: aim * f64::from(part), most }),
        None => (part == 1 || most / part >= FEWEST_PATHS).then_some(Enough::Paths(most / part)),
    };
    // Those left rough if the time is up are not all in one place.
    let order = scattered(vertices.len());
    let mut rough = 0;
    for wanted in parts.iter().filter_map(step).filter(|wanted| *wanted != first) {
        done.store(0, Ordering::Relaxed);
        let finer = map_until(&job.workers, 1.0, order.len(), |n| one(vertices[order[n]], wanted))?;
        paths += finer.iter().map(|gather| u64::from(gather.paths)).sum::<u64>();
        // Only the last step gives a vertex all its paths.
        let finished = if wanted == last_step(aim, most) { finer.len() } else { 0 };
        rough = order.len() - finished;
        let stopped = finer.len() < order.len();
        order.iter().zip(finer).for_each(|(&n, finer)| gathers[n] = finer);
        if stopped {
            break;
        }
    }
    let accuracy = job.options.accuracy.zip(aim);
    let accuracy = accuracy.map(|(asked, aim)| report(&gathers, asked, aim, rough > 0, paths));
    let mut values = vec![V::default(); job.ready.cells.len()];
    for (vertex, gather) in vertices.into_iter().zip(&gathers) {
        values[vertex] = V::gathered(&gather.numbers);
    }
    Ok(Simulated { values: values.into(), books: Books::default(), photons: 0, accuracy, paths, rough })
}

/// How well vertices are to be gathered in the end.
fn last_step(aim: Option<f64>, most: u32) -> Enough {
    aim.map_or(Enough::Paths(most), |variance| Enough::Variance { variance, most })
}

/// The numbers below `count`, each once, neighbours far from each other: steps of the golden section.
fn scattered(count: usize) -> Vec<usize> {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let mut order: Vec<usize> = (0..count).collect();
    let place = |n: usize| (n as f64 * GOLDEN).fract();
    order.sort_by(|&a, &b| place(a).total_cmp(&place(b)));
    order
}

/// Sum of the squares of the light, without that of its noise.
fn signal(gathers: &[VertexGather]) -> f64 {
    let squares: f64 = gathers.iter().flat_map(|gather| gather.axes).map(|x| x * x).sum();
    (squares - gathers.iter().map(|gather| gather.variance).sum::<f64>()).max(0.0)
}

fn report(gathers: &[VertexGather], asked: f64, aim: f64, stopped: bool, paths: u64) -> AccuracyReport {
    let signal = signal(gathers);
    let noise: f64 = gathers.iter().map(|gather| gather.variance).sum();
    // Vertices are independent. The squared error of one, over 18 numbers that have few degrees of freedom, and the estimate
    // of its variance spread by less than themselves.
    let spread = gathers.iter().map(|gather| gather.variance.powi(2)).sum::<f64>().sqrt();
    let bound = noise + student::quantile(beyond(1), gathers.len().max(2) as f64 - 1.0) * spread;
    let relative = |square: f64| if signal > 0.0 { (square / signal).sqrt() } else { 0.0 };
    let rough = gathers.iter().filter(|gather| gather.variance > aim).count();
    let reached = relative(bound);
    AccuracyReport {
        asked,
        reached,
        noise: relative(noise),
        bias: Some(0.0),
        ended_by: match (stopped, reached <= asked) {
            (true, _) => EndedBy::Monitor,
            (_, true) => EndedBy::Accuracy,
            (_, false) => EndedBy::Photons,
        },
        batches: 0,
        looks: 1,
        vertices: gathers.len(),
        probes: 0,
        gathered_biased: 0,
        gathered_noisy: 0,
        noisy: rough,
        paths,
    }
}
