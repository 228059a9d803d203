//! The grid without photons: every vertex path traced.

use std::sync::atomic::{AtomicU64, Ordering};

use ivg_grid::GridValues;

use super::{AccuracyReport, EndedBy, Simulated, beyond, student};
use crate::bake::Job;
use crate::estimate::held::Held;
use crate::estimate::vertex_gather::{Enough, FEWEST_PATHS, VertexGather};
use crate::trace::Books;
use crate::workers::map;
use crate::{BakeError, BakeStage};

/// Vertices gathered between two questions whether the time is up.
const BLOCK: usize = 1024;

/// Share of the squared error asked for that vertices may have in the mean, so that the bound stays below it.
const AIM: f64 = 0.9;

/// Gathers at every vertex that light reaches: with the options' paths, or to their accuracy.
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
    let paths = if job.options.accuracy.is_some() { FEWEST_PATHS } else { job.options.paths };
    let mut gathers = map(&job.workers, vertices.len(), |n| one(vertices[n], Enough::Paths(paths)))?;
    let mut paths: u64 = gathers.iter().map(|gather| u64::from(gather.paths)).sum();
    let mut accuracy = None;
    if let Some(asked) = job.options.accuracy {
        let signal = signal(&gathers);
        let aim = AIM * asked.powi(2) * signal / vertices.len().max(1) as f64;
        let enough = Enough::Variance { variance: aim, most: job.options.paths };
        let mut stopped = false;
        for (first, block) in vertices.chunks(BLOCK).enumerate().map(|(n, block)| (n * BLOCK, block)) {
            stopped = job.workers.monitor.enough();
            if stopped {
                break;
            }
            let finer = map(&job.workers, block.len(), |n| one(block[n], enough))?;
            paths += finer.iter().map(|gather| u64::from(gather.paths)).sum::<u64>();
            gathers[first..].iter_mut().zip(finer).for_each(|(rough, finer)| *rough = finer);
        }
        accuracy = Some(report(&gathers, asked, aim, stopped, paths));
    }
    let mut values = vec![V::default(); job.ready.cells.len()];
    for (vertex, gather) in vertices.into_iter().zip(&gathers) {
        values[vertex] = V::gathered(&gather.numbers);
    }
    Ok(Simulated { values: values.into(), books: Books::default(), photons: 0, accuracy, paths })
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
        bias: 0.0,
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
