//! Bias, from vertices at which light is gathered without any.
//!
//! A baked vertex is the mean over its dual cell, and light beyond the last reflection followed is missing: both are the same
//! in every batch. So light is gathered at some vertices by path tracing, and of the squared difference the variance of both
//! sides is subtracted. What is left is the squared bias, whose mean over all vertices is estimated from strata: vertices
//! whose cells geometry touches and those that lie free, each in classes by how much the light changes to their
//! neighbours, so that the few vertices where much of the bias is are not missed. Of a large grid the classes are finer: what it
//! costs to gather the worst of them grows with the square of their number, since their variances add up.

use glam::Vec3;

use super::student;
use crate::BakeError;
use crate::estimate::held::{AXES, Axes, Held, energy};
use crate::estimate::vertex_gather::Enough;
use crate::sampling::rng::{Purpose, Stream};
use crate::stage::Stage;
use crate::workers::{Workers, map_until};

/// Shares of the vertices in the classes by change of light, the flattest first.
const CLASSES: [f64; 3] = [0.6, 0.3, 0.1];

/// The same where there are many vertices: with few, fine strata hold too few to tell their bias.
const FINE_CLASSES: [f64; 6] = [0.55, 0.25, 0.1, 0.06, 0.03, 0.01];

/// Vertices from which on classes are fine: a hundred in the smallest, where a quarter of all are touched.
const MANY: usize = 8192;

/// Probes of a stratum from which on those of all tell where more are needed.
const FEWEST: usize = 4;

/// Vertices of which one is to be drawn.
#[derive(Debug)]
struct Stratum {
    /// All its vertices, in a random order.
    vertices: Vec<usize>,
    /// How many of them have been gathered.
    gathered: usize,
    /// Whether its vertices hold what photons brought.
    counts: bool,
}

/// A vertex at which light has been gathered.
#[derive(Debug)]
struct Probe {
    vertex: usize,
    stratum: usize,
    axes: [f64; AXES],
    variance: f64,
    paths: u32,
}

/// The stratum with most bias.
#[derive(Debug)]
pub(crate) struct Worst {
    stratum: usize,
    /// Its vertices, in the order to gather at them: those last at which the bias is known.
    pub(crate) vertices: Vec<usize>,
    /// Mean squared bias of one of them \[(W/m²)²\].
    pub(crate) squared: f64,
    /// Mean variance of one path from one of them \[(W/m²)²\].
    pub(crate) variance_a_path: f64,
}

/// Vertices at which light has been gathered.
#[derive(Debug)]
pub(crate) struct Probes {
    strata: Vec<Stratum>,
    probes: Vec<Probe>,
    paths: u64,
}

/// Squared bias of the whole grid: the sum over vertices and axes \[(W/m²)²\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bias {
    pub(crate) squared: f64,
    standard_error: f64,
    freedom: f64,
}

impl Bias {
    /// What it exceeds with probability `beyond` at most; not below zero.
    pub(crate) fn bound(&self, beyond: f64) -> f64 {
        (self.squared + student::quantile(beyond, self.freedom) * self.standard_error).max(0.0)
    }
}

impl Probes {
    /// Strata of the vertices for which `counts`; `touched` tells which have geometry in their cells, `change` how much the light
    /// changes to their neighbours.
    pub(crate) fn new(
        vertices: impl Iterator<Item = usize>,
        seed: u64,
        touched: impl Fn(usize) -> bool,
        change: impl Fn(usize) -> f64,
    ) -> Self {
        let mut kinds = [Vec::new(), Vec::new()];
        vertices.for_each(|vertex| kinds[usize::from(touched(vertex))].push((change(vertex), vertex)));
        let many = kinds[0].len() + kinds[1].len() >= MANY;
        let classes: &[f64] = if many { &FINE_CLASSES } else { &CLASSES };
        let mut strata = Vec::with_capacity(2 * classes.len());
        for mut ranked in kinds {
            ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let (mut below, mut first) = (0.0, 0);
            for share in classes {
                below += share;
                let last = ((below * ranked.len() as f64).round() as usize).clamp(first, ranked.len());
                let mut vertices: Vec<usize> =
                    ranked[first..last].iter().map(|&(_, vertex)| vertex).collect();
                shuffle(&mut vertices, seed);
                strata.push(Stratum { vertices, gathered: 0, counts: true });
                first = last;
            }
        }
        Self { strata, probes: Vec::new(), paths: 0 }
    }

    /// How many of `more` further vertices each stratum is to get: one half of them evenly, the other in proportion to how
    /// many vertices it has and how much their biases differ (J. Neyman, "On the two different aspects of the representative
    /// method", 1934). Arguments as of [`Probes::bias`].
    pub(crate) fn divided(
        &self,
        more: usize,
        baked: impl Fn(usize) -> Axes,
        variance: impl Fn(usize) -> f64,
    ) -> Vec<usize> {
        let counting = |stratum: &Stratum| stratum.counts && stratum.gathered < stratum.vertices.len();
        let count = self.strata.iter().filter(|stratum| counting(stratum)).count().max(1);
        let spreads: Vec<f64> = (self.strata.iter().enumerate())
            .map(|(number, stratum)| {
                let squares = self.squares(number, &baked, &variance);
                if counting(stratum) { stratum.vertices.len() as f64 * spread(&squares).sqrt() } else { 0.0 }
            })
            .collect();
        let all: f64 = spreads.iter().sum();
        let known = self.strata.iter().all(|stratum| !counting(stratum) || stratum.gathered >= FEWEST);
        let evenly = if known && all > 0.0 { 0.5 } else { 1.0 };
        (self.strata.iter().zip(spreads))
            .map(|(stratum, spread)| {
                let share = evenly / count as f64 + if evenly < 1.0 { 0.5 * spread / all } else { 0.0 };
                if counting(stratum) { (more as f64 * share).ceil() as usize } else { 0 }
            })
            .collect()
    }

    /// Gathers at further vertices, so many of each stratum, as long as less than the share `late` of the time has passed. The
    /// strata take turns, so that something is known of all of them if time is short.
    #[expect(clippy::too_many_arguments, reason = "what gathering needs, and how much of it")]
    pub(crate) fn gather<V: Held>(
        &mut self,
        more: &[usize],
        stage: &Stage<'_>,
        eyes: &[Vec3],
        seed: u64,
        enough: Enough,
        late: f64,
        workers: &Workers<'_>,
    ) -> Result<(), BakeError> {
        let mut chosen = Vec::new();
        for (number, stratum) in self.strata.iter().enumerate() {
            let next = stratum.vertices.iter().skip(stratum.gathered).take(more[number]);
            chosen.extend(next.enumerate().map(|(turn, &vertex)| (turn, number, vertex)));
        }
        chosen.sort_unstable();
        let gathers = map_until(workers, late, chosen.len(), |n| {
            let (.., vertex) = chosen[n];
            stage.gather::<V>(eyes[vertex], vertex, seed, enough)
        })?;
        for ((_, stratum, vertex), gather) in chosen.into_iter().zip(gathers) {
            self.strata[stratum].gathered += 1;
            self.paths += u64::from(gather.paths);
            let (axes, variance, paths) = (gather.axes, gather.variance, gather.paths);
            self.probes.push(Probe { vertex, stratum, axes, variance, paths });
        }
        Ok(())
    }

    /// The stratum with the largest mean squared bias; `None` if none counts or shows any. Arguments as of [`Probes::bias`].
    pub(crate) fn worst(
        &self,
        baked: impl Fn(usize) -> Axes,
        variance: impl Fn(usize) -> f64,
    ) -> Option<Worst> {
        let counting =
            (0..self.strata.len()).filter(|&n| self.strata[n].counts && self.strata[n].gathered > 0);
        let mean = |number: usize| {
            let squares = self.squares(number, &baked, &variance);
            squares.iter().sum::<f64>() / squares.len() as f64
        };
        let (worst, squared) = counting.map(|n| (n, mean(n))).max_by(|a, b| a.1.total_cmp(&b.1))?;
        if squared <= 0.0 {
            return None;
        }
        let probes = || self.probes.iter().filter(|probe| probe.stratum == worst);
        let variances: f64 = probes().map(|probe| probe.variance * f64::from(probe.paths)).sum();
        let variance_a_path = variances / probes().count() as f64;
        let vertices = self.strata[worst].vertices.iter().rev().copied().collect();
        Some(Worst { stratum: worst, vertices, squared, variance_a_path })
    }

    /// Takes the first `done` vertices of a stratum out of what counts: they hold gathered light now.
    pub(crate) fn take(&mut self, worst: &Worst, done: usize) {
        let stratum = &mut self.strata[worst.stratum];
        let left = stratum.vertices.len() - done;
        if left == 0 {
            stratum.counts = false;
            return;
        }
        stratum.vertices.truncate(left);
        stratum.gathered = stratum.gathered.min(left);
        let gone = &worst.vertices[..done];
        self.probes.retain(|probe| probe.stratum != worst.stratum || !gone.contains(&probe.vertex));
    }

    /// Squared biases at the probes of a stratum.
    fn squares(
        &self,
        stratum: usize,
        baked: &impl Fn(usize) -> Axes,
        variance: &impl Fn(usize) -> f64,
    ) -> Vec<f64> {
        let probes = self.probes.iter().filter(|probe| probe.stratum == stratum);
        let square = |probe: &Probe| {
            let axes = baked(probe.vertex).map(f64::from);
            let difference: f64 = axes.iter().zip(&probe.axes).map(|(a, b)| (a - b).powi(2)).sum();
            difference - probe.variance - variance(probe.vertex)
        };
        probes.map(square).collect()
    }

    /// Vertices gathered at.
    pub(crate) fn len(&self) -> usize {
        self.probes.len()
    }

    /// Paths traced.
    pub(crate) fn paths(&self) -> u64 {
        self.paths
    }

    /// Whether the bias can be told: of each stratum at least two vertices are known, or all.
    pub(crate) fn tell(&self) -> bool {
        self.strata.iter().all(|s| !s.counts || s.gathered >= s.vertices.len().min(2))
    }

    /// Whether there are vertices left to gather at.
    pub(crate) fn can_grow(&self) -> bool {
        self.strata.iter().any(|s| s.counts && s.gathered < s.vertices.len())
    }

    /// The squared bias: `baked` is what a vertex holds along the axes \[W/m²\], `variance` the sum of its variances.
    pub(crate) fn bias(&self, baked: impl Fn(usize) -> Axes, variance: impl Fn(usize) -> f64) -> Bias {
        let mut bias = Bias { squared: 0.0, standard_error: 0.0, freedom: 0.0 };
        for (number, stratum) in self.strata.iter().enumerate() {
            if !stratum.counts || stratum.gathered == 0 {
                continue;
            }
            let squares = self.squares(number, &baked, &variance);
            let (all, count) = (stratum.vertices.len() as f64, squares.len() as f64);
            let mean = squares.iter().sum::<f64>() / count;
            bias.squared += all * mean;
            if squares.len() > 1 {
                bias.standard_error += all * all * spread(&squares) / count * (1.0 - count / all);
                bias.freedom += count - 1.0;
            }
        }
        bias.standard_error = bias.standard_error.sqrt();
        bias.freedom = bias.freedom.max(1.0);
        bias
    }
}

/// The variance of numbers, estimated from some of them; 0 of less than two.
fn spread(numbers: &[f64]) -> f64 {
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    if count > 1.0 { numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0) } else { 0.0 }
}

/// The sum of squared changes from a vertex to its neighbours `next`.
pub(crate) fn change(axes: &Axes, next: impl Iterator<Item = Axes>) -> f64 {
    next.map(|next| energy(&core::array::from_fn(|n| next[n] - axes[n]))).sum()
}

/// A random order (R. Durstenfeld, "Algorithm 235: random permutation", 1964).
fn shuffle(vertices: &mut [usize], seed: u64) {
    for last in (1..vertices.len()).rev() {
        let [word, ..] = Stream::new(seed, last as u64).words(0, Purpose::Probe);
        let other = (u64::from(word) * (last as u64 + 1)) >> 32;
        vertices.swap(last, other as usize);
    }
}

#[cfg(test)]
mod tests;
