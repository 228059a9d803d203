//! Bias, from vertices at which light is gathered without any.
//!
//! A baked vertex is the mean over its dual cell, and light beyond the last reflection followed is missing: both are the same
//! in every batch. So light is gathered at some vertices by path tracing, and of the squared difference the variance of both
//! sides is subtracted. What is left is the squared bias, whose mean over all vertices is estimated from strata: vertices
//! whose cells geometry touches and those that lie free, each in three classes by how much the light changes to their
//! neighbours, so that the few vertices where much of the bias is are not missed.

use glam::Vec3;

use super::student;
use crate::BakeError;
use crate::estimate::held::{AXES, Axes, Held, energy};
use crate::estimate::vertex_gather::Enough;
use crate::sampling::rng::{Purpose, Stream};
use crate::stage::Stage;
use crate::workers::{Workers, map};

/// Shares of the vertices in the classes by change of light, the flattest first.
const CLASSES: [f64; 3] = [0.6, 0.3, 0.1];

/// Strata: touched or free, times the classes.
pub(crate) const STRATA: usize = 2 * CLASSES.len();

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
        let mut strata: Vec<Stratum> =
            (0..STRATA).map(|_| Stratum { vertices: Vec::new(), gathered: 0, counts: true }).collect();
        let mut kinds = [Vec::new(), Vec::new()];
        vertices.for_each(|vertex| kinds[usize::from(touched(vertex))].push((change(vertex), vertex)));
        for (kind, mut ranked) in kinds.into_iter().enumerate() {
            ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let (mut below, mut first) = (0.0, 0);
            for (class, share) in CLASSES.into_iter().enumerate() {
                below += share;
                let last = ((below * ranked.len() as f64).round() as usize).clamp(first, ranked.len());
                let stratum = &mut strata[kind * CLASSES.len() + class].vertices;
                stratum.extend(ranked[first..last].iter().map(|&(_, vertex)| vertex));
                shuffle(stratum, seed);
                first = last;
            }
        }
        Self { strata, probes: Vec::new(), paths: 0 }
    }

    /// Gathers at `more` further vertices, divided evenly among the strata.
    pub(crate) fn gather<V: Held>(
        &mut self,
        more: usize,
        stage: &Stage<'_>,
        eyes: &[Vec3],
        seed: u64,
        enough: Enough,
        workers: &Workers<'_>,
    ) -> Result<(), BakeError> {
        let mut chosen = Vec::new();
        for (number, stratum) in self.strata.iter_mut().enumerate().filter(|(_, s)| s.counts) {
            let last = (stratum.gathered + more.div_ceil(STRATA)).min(stratum.vertices.len());
            chosen.extend(stratum.vertices[stratum.gathered..last].iter().map(|&vertex| (vertex, number)));
            stratum.gathered = last;
        }
        let gathers = map(workers, chosen.len(), |n| {
            let (vertex, _) = chosen[n];
            stage.gather::<V>(eyes[vertex], vertex, seed, enough)
        })?;
        for ((vertex, stratum), gather) in chosen.into_iter().zip(gathers) {
            self.paths += u64::from(gather.paths);
            let (axes, variance) = (gather.axes, gather.variance);
            self.probes.push(Probe { vertex, stratum, axes, variance });
        }
        Ok(())
    }

    /// The vertices of the stratum with the largest mean squared bias, which no longer counts from now on; `None` if none
    /// counts. Arguments as of [`Probes::bias`].
    pub(crate) fn take_worst(
        &mut self,
        baked: impl Fn(usize) -> Axes,
        variance: impl Fn(usize) -> f64,
    ) -> Option<Vec<usize>> {
        let counting = (0..STRATA).filter(|&n| self.strata[n].counts && self.strata[n].gathered > 0);
        let mean = |number: usize| {
            let squares = self.squares(number, &baked, &variance);
            squares.iter().sum::<f64>() / squares.len() as f64
        };
        let (worst, _) = counting.map(|n| (n, mean(n))).max_by(|a, b| a.1.total_cmp(&b.1))?;
        let stratum = &mut self.strata[worst];
        stratum.counts = false;
        Some(stratum.vertices.clone())
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
                let spread = squares.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
                bias.standard_error += all * all * spread / count * (1.0 - count / all);
                bias.freedom += count - 1.0;
            }
        }
        bias.standard_error = bias.standard_error.sqrt();
        bias.freedom = bias.freedom.max(1.0);
        bias
    }
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
