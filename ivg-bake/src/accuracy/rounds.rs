//! Photons in rounds until the grid is as accurate as was asked for.
//!
//! A round is 32 batches of equal size, 16 pairs, and ends with a look at noise and bias. How many photons the next one has
//! follows from the noise that is left, at most four times as many as all before. The bounds at look k may be wrong with
//! probability α / k(k + 1), so that stopping at the first look that is good enough does not spoil the confidence.
//!
//! Then come the vertices that are noisy measured by their own brightness, which the grid as a whole does not show: a dim
//! room beside a bright one. They are gathered by path tracing; so are, stratum by stratum, the vertices with most bias,
//! as long as what is left of it is too much.

use std::collections::BTreeMap;

use ivg_grid::GridValues;

use super::noise::Noise;
use super::probes::{Bias, Probes, change};
use super::{AccuracyReport, EndedBy, Simulated, beyond};
use crate::bake::Job;
use crate::estimate::Estimate;
use crate::estimate::held::{Axes, Held, Linear, energy};
use crate::estimate::vertex_gather::{Enough, VertexGather};
use crate::tally::{PHOTONS_A_PIECE, Photons, Tally};
use crate::workers::{Workers, map, map_until};
use crate::{BakeError, BakeStage};

/// Batches of a round.
const BATCHES: u64 = 32;

/// Largest and smallest number of photons after a round, relative to that before it.
const GROWTH: (f64, f64) = (1.1, 4.0);

/// More photons than seem needed, so that chance does not make another round necessary.
const MARGIN: f64 = 1.02;

/// Vertices that the bias is measured at first, and at most.
const PROBES: (usize, usize) = (96, 768);

/// Noise at which bias is first looked at, relative to the error asked for.
const NOISE_BEFORE_PROBES: f64 = 2.0;

/// Bias that seems below this share of what is bearable is measured at more vertices before any are gathered.
const UNCERTAIN: f64 = 0.7;

/// Most paths of a vertex that is gathered to measure bias, whose variance is subtracted.
const PROBE_PATHS: u32 = 1 << 15;

/// Most paths of a vertex that is gathered into the grid.
const MOST_PATHS: u32 = 1 << 17;

/// Share of the squared error asked for that bias may take before something else than photons is tried.
const MOST_BIAS: f64 = 0.4;

/// A vertex is too noisy beyond so many times the error asked for, relative to its own brightness.
const VERTEX_NOISE: f64 = 4.0;

/// Brightness of a vertex counts as at least this share of the grid's root mean square.
const DIMMEST: f64 = 0.01;

/// The variance of a vertex that is gathered into the grid because it is too biased, relative to the mean squared error asked for:
/// where a tenth of all are, that is three tenths of the whole.
const GATHERED_NOISE: f64 = 3.0;

/// And at most this share of the squared bias that it had, which counts as half of the mean error asked for where it is less.
const GATHERED_SHARE: f64 = 0.25;

/// Share of the squared error asked for that all vertices gathered for their bias may have as noise, and the share of what is left of
/// that which the next stratum takes.
const GATHERED_IN_ALL: (f64, f64) = (0.5, 0.25);

/// Vertices that the bias is measured at anew after some have been gathered into the grid: those that are left are left because theirs
/// seemed small.
const PROBES_AFTER: usize = 48;

/// Of the time left when the first photon starts, if there is a limit: the share after which bias is looked at, however large noise
/// still is, and the share that this look may take. The rest goes to photons, and to what is found to be too biased.
const TIME_OF_PROBES: (f64, f64) = (0.4, 0.3);

/// Traces photons until the relative error is `asked` or the options' photons are spent.
pub(crate) fn run<E>(job: &Job<'_>, estimate: &E, asked: f64) -> Result<Simulated, BakeError>
where
    E: Estimate<Value: Held>,
    GridValues: From<Vec<E::Value>>,
{
    let vertices = job.ready.cells.len();
    let mut rounds = Rounds {
        job,
        asked,
        tally: Tally::new(&job.tracer, estimate, job.workers.threads),
        noise: Noise::new(vertices),
        probes: None,
        axes: Vec::new(),
        gathered: BTreeMap::new(),
        biased: 0,
        looks: 0,
        begun: job.workers.monitor.time_spent().unwrap_or(0.0),
    };
    let (ended_by, look) = rounds.until_good()?;
    rounds.finish(ended_by, look)
}

struct Rounds<'a, E> {
    job: &'a Job<'a>,
    asked: f64,
    tally: Tally<'a, E>,
    noise: Noise,
    probes: Option<Probes>,
    /// What vertices hold along the axes, for photons of unit power each.
    axes: Vec<Axes>,
    /// Vertices that are to hold gathered light.
    gathered: BTreeMap<usize, VertexGather>,
    /// How many of them would be too biased otherwise.
    biased: usize,
    looks: u32,
    /// Share of the time that had passed before the first photon.
    begun: f64,
}

/// Squares of errors and of the light itself, sums over vertices and axes \[(W/m²)²\].
#[derive(Clone, Copy, Debug)]
struct Look {
    signal: f64,
    noise: f64,
    noise_bound: f64,
    /// Of the noise, that of vertices that hold gathered light.
    gathered: f64,
    bias: f64,
    bias_bound: f64,
    /// Whether bias has been looked at, at vertices enough.
    bias_known: bool,
}

/// Why a round ends before its last batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pause {
    /// The monitor has enough.
    Enough,
    /// It is time to look at bias.
    Probes,
}

impl Look {
    fn relative(&self, squared: f64) -> f64 {
        if self.signal > 0.0 { (squared / self.signal).sqrt() } else { 0.0 }
    }

    fn reached(&self) -> f64 {
        self.relative(self.noise_bound + self.bias_bound)
    }
}

impl<E> Rounds<'_, E>
where
    E: Estimate<Value: Held>,
    GridValues: From<Vec<E::Value>>,
{
    fn until_good(&mut self) -> Result<(EndedBy, Look), BakeError> {
        let most = self.job.photons;
        if most < BATCHES {
            return Err(BakeError::FewPhotons { photons: most, least: BATCHES });
        }
        let vertices = self.job.ready.cells.len() as u64;
        // Reading the grid after each batch takes the time of about a photon for four vertices.
        let smallest = PHOTONS_A_PIECE.max(vertices.next_multiple_of(PHOTONS_A_PIECE));
        let mut next = BATCHES * smallest;
        loop {
            let pause = self.trace(next)?;
            let stopped = pause == Some(Pause::Enough);
            let spent = most - self.tally.photons() < BATCHES;
            let last = stopped || spent;
            let mut look = self.look()?;
            if self.probes.is_none()
                && (pause.is_some() || last || look.relative(look.noise) <= NOISE_BEFORE_PROBES * self.asked)
            {
                self.probe(PROBES.0, &look, self.share_of_time(TIME_OF_PROBES.0 + TIME_OF_PROBES.1))?;
                look = self.look_again()?;
            }
            let allowed = self.asked.powi(2) * look.signal;
            // What the noise of gathered vertices leaves: no photon makes that smaller.
            let bearable = |look: &Look| MOST_BIAS * (allowed - look.gathered).max(0.0);
            let monitor = self.job.workers.monitor;
            let in_time = || !last && !monitor.enough();
            let too_much = |look: &Look| look.bias_bound > bearable(look) || !look.bias_known;
            while self.probes.is_some() && too_much(&look) && in_time() {
                let uncertain = look.bias < UNCERTAIN * bearable(&look) || !look.bias_known;
                if uncertain && self.probes.as_ref().is_some_and(|p| p.can_grow() && p.len() < PROBES.1) {
                    let more = self.probes.as_ref().map_or(0, Probes::len);
                    self.probe(more.max(PROBES_AFTER), &look, 1.0)?;
                } else if !self.gather_worst(&look)? {
                    break;
                } else {
                    self.probe(PROBES_AFTER, &look, 1.0)?;
                }
                look = self.look_again()?;
            }
            let good = look.bias_known && look.noise_bound + look.bias_bound <= allowed;
            let ended = match (good, stopped, spent) {
                (true, ..) => Some(EndedBy::Accuracy),
                (_, true, _) => Some(EndedBy::Monitor),
                (_, _, true) => Some(EndedBy::Photons),
                _ => None,
            };
            if let Some(ended) = ended {
                return Ok((ended, look));
            }
            next = self.next(&look, allowed);
        }
    }

    /// Photons after the next round.
    fn next(&self, look: &Look, allowed: f64) -> u64 {
        let wanted = if self.probes.is_some() {
            (allowed - look.bias_bound).max(0.1 * allowed)
        } else {
            NOISE_BEFORE_PROBES.powi(2) * allowed * 0.5
        };
        let factor = (MARGIN * look.noise_bound / wanted).clamp(GROWTH.0, GROWTH.1);
        (self.tally.photons() as f64 * factor) as u64
    }

    /// The share of all time that has passed after a share of that which was left for photons.
    fn share_of_time(&self, share: f64) -> f64 {
        self.begun + share * (1.0 - self.begun).max(0.0)
    }

    /// Traces a round up to about `next` photons, and says why it ended before.
    fn trace(&mut self, next: u64) -> Result<Option<Pause>, BakeError> {
        self.job.workers.monitor.stage(BakeStage::Photons);
        let first = self.tally.photons();
        let next = next.min(self.job.photons);
        let batch = (next - first) / BATCHES;
        // Whole pieces keep the threads busy; the last of the photons allowed are spent as they are.
        let whole = batch / PHOTONS_A_PIECE * PHOTONS_A_PIECE;
        let batch = if whole > 0 && next < self.job.photons { whole } else { batch };
        let workers = Workers { total_photons: first + BATCHES * batch, ..self.job.workers };
        for pair in 0..BATCHES / 2 {
            for half in 0..2 {
                let from = first + (2 * pair + half) * batch;
                self.tally.trace(Photons::all(from, from + batch), &workers)?;
                self.read()?;
                if half == 0 {
                    self.noise.note_first(&self.axes, &workers)?;
                    // Half a pair tells no noise; its light is there.
                    if self.noise.pairs() > 1 && workers.monitor.enough() {
                        return Ok(Some(Pause::Enough));
                    }
                } else {
                    self.noise.note_second(&self.axes, batch, &workers)?;
                }
            }
            // Noise can be told from two samples.
            if self.noise.pairs() > 1 && workers.monitor.enough() {
                return Ok(Some(Pause::Enough));
            }
            let late = self.share_of_time(TIME_OF_PROBES.0);
            let is_late = || workers.monitor.time_spent().is_some_and(|spent| spent >= late);
            if self.noise.pairs() > 1 && self.probes.is_none() && is_late() {
                return Ok(Some(Pause::Probes));
            }
        }
        Ok(None)
    }

    /// Reads what vertices hold of the photons traced so far.
    fn read(&mut self) -> Result<(), BakeError> {
        let estimate = self.tally.estimate;
        let total = self.tally.total();
        let vertices = self.job.ready.cells.len();
        self.axes = map(&self.job.workers, vertices, |vertex| estimate.value(&total, vertex, 1.0).axes())?;
        self.job.carry(&mut self.axes)
    }

    /// Light along the axes of a vertex \[W/m²\].
    fn axes_of(&self) -> impl Fn(usize) -> Axes {
        let power = (self.job.power() / self.tally.photons() as f64) as f32;
        move |vertex| self.axes[vertex].map(|x| x * power)
    }

    /// A new look at noise and bias.
    fn look(&mut self) -> Result<Look, BakeError> {
        self.looks += 1;
        self.look_again()
    }

    /// Square of what a photon of unit power stands for \[W²/m⁴\], for all photons traced.
    fn unit(&self) -> f64 {
        (self.job.power() / self.tally.photons() as f64).powi(2)
    }

    /// The same look, after something has been gathered.
    fn look_again(&mut self) -> Result<Look, BakeError> {
        let photons = self.tally.photons() as f64;
        let unit = self.unit();
        let power = self.job.power() / photons;
        let energies = self.axes.iter().map(|axes| power * power * energy(axes));
        // Vertices that hold gathered light have its noise instead of that of photons.
        let all: f64 = (0..self.axes.len()).map(|vertex| self.noise.of_vertex(vertex)).sum();
        let replaced: f64 = self.gathered.keys().map(|&vertex| self.noise.of_vertex(vertex)).sum();
        let kept = if all > 0.0 { 1.0 - replaced / all } else { 1.0 };
        let of_gathered: f64 = self.gathered.values().map(|gather| gather.variance).sum();
        let factor = unit * photons * kept;
        let noise = self.noise.variance() * factor + of_gathered;
        let noise_bound = self.noise.bound(0.5 * beyond(self.looks)) * factor + of_gathered;
        let signal = (energies.sum::<f64>() - self.noise.variance() * unit * photons).max(0.0);
        let bias = self.bias();
        let bias_known = self.probes.as_ref().is_some_and(Probes::tell);
        Ok(Look {
            signal,
            noise,
            noise_bound,
            gathered: of_gathered,
            bias: bias.map_or(0.0, |bias| bias.squared.max(0.0)),
            bias_bound: bias.map_or(0.0, |bias| bias.bound(0.5 * beyond(self.looks))),
            bias_known,
        })
    }

    /// How well a vertex is to be gathered if the variances of all together may be `squared`.
    fn tolerance(&self, squared: f64) -> Enough {
        let counted = self.job.counted().count().max(1) as f64;
        Enough::Variance { variance: squared / counted, most: PROBE_PATHS }
    }

    /// Gathers light at `more` vertices to tell the bias, until the share `late` of the time has passed.
    fn probe(&mut self, more: usize, look: &Look, late: f64) -> Result<(), BakeError> {
        let job = self.job;
        job.workers.monitor.stage(BakeStage::Gathering);
        let enough = self.tolerance(self.asked.powi(2) * look.signal);
        let mut probes = match self.probes.take() {
            Some(probes) => probes,
            None => self.strata()?,
        };
        let (photons, unit) = (self.tally.photons() as f64, self.unit());
        let more =
            probes.divided(more, self.axes_of(), |vertex| self.noise.of_vertex(vertex) * unit * photons);
        let (stage, eyes) = (&job.ready.stage, &job.surroundings.eyes);
        probes.gather::<E::Value>(&more, stage, eyes, job.seed(), enough, late, &job.workers)?;
        self.probes = Some(probes);
        Ok(())
    }

    fn strata(&mut self) -> Result<Probes, BakeError> {
        let job = self.job;
        let (cells, surroundings) = (&job.ready.cells, job.surroundings);
        let axes = self.axes_of();
        let changes = map(&job.workers, cells.len(), |vertex| {
            let neighbours = surroundings.open_neighbours(cells, vertex);
            change(&axes(vertex), neighbours.map(&axes))
        })?;
        let touched = |vertex| surroundings.is_touched(vertex);
        Ok(Probes::new(job.counted(), job.seed(), touched, |vertex| changes[vertex]))
    }

    /// Gathers at the vertices where averaging over cells is most biased; says whether there were any.
    fn gather_worst(&mut self, look: &Look) -> Result<bool, BakeError> {
        let photons = self.tally.photons() as f64;
        let unit = self.unit();
        let worst = self.probes.as_ref().and_then(|probes| {
            probes.worst(self.axes_of(), |vertex| self.noise.of_vertex(vertex) * unit * photons)
        });
        let Some(worst) = worst else { return Ok(false) };
        let allowed = self.asked.powi(2) * look.signal;
        let mean = allowed / self.job.counted().count().max(1) as f64;
        let left = (GATHERED_IN_ALL.0 * allowed - look.gathered).max(0.0);
        let variance = (GATHERED_NOISE * mean)
            .min(GATHERED_SHARE * worst.squared.max(0.5 * mean))
            .min(GATHERED_IN_ALL.1 * left / worst.vertices.len() as f64);
        // In darkness nothing is divided by nothing.
        let paths = (worst.variance_a_path / variance).min(f64::from(MOST_PATHS)).max(0.0) as u32;
        let wanted: Vec<_> = worst.vertices.iter().map(|&vertex| (vertex, Enough::Roughly(paths))).collect();
        let done = self.gather(&wanted)?;
        self.biased += done;
        if let Some(probes) = &mut self.probes {
            probes.take(&worst, done);
        }
        Ok(done == wanted.len())
    }

    /// Gathers light at vertices into the grid until there are no more of them or the monitor has enough; says how many.
    fn gather(&mut self, vertices: &[(usize, Enough)]) -> Result<usize, BakeError> {
        let job = self.job;
        job.workers.monitor.stage(BakeStage::Gathering);
        let gathers = map_until(&job.workers, 1.0, vertices.len(), |n| {
            let (vertex, enough) = vertices[n];
            job.ready.stage.gather::<E::Value>(job.surroundings.eyes[vertex], vertex, job.seed(), enough)
        })?;
        let done = gathers.len();
        self.gathered.extend(vertices.iter().map(|(vertex, _)| *vertex).zip(gathers));
        Ok(done)
    }

    /// Vertices too noisy for their own brightness, and how well they are to be gathered.
    fn noisy(&mut self, look: &Look) -> Result<Vec<(usize, Enough)>, BakeError> {
        let photons = self.tally.photons() as f64;
        let (unit, axes) = (self.unit(), self.axes_of());
        let dimmest = DIMMEST.powi(2) * look.signal / self.job.counted().count().max(1) as f64;
        let most = (VERTEX_NOISE * self.asked).powi(2);
        let (noise, gathered) = (&self.noise, &self.gathered);
        let vertices: Vec<usize> = self.job.counted().filter(|v| !gathered.contains_key(v)).collect();
        let found = map(&self.job.workers, vertices.len(), |n| {
            let vertex = vertices[n];
            let square = energy(&axes(vertex));
            let variance = noise.of_vertex(vertex) * unit * photons;
            let allowed = most * (square - variance).max(dimmest);
            // No photon at all says nothing about how dark it is.
            (variance > allowed || square == 0.0 && look.signal > 0.0)
                .then_some((vertex, Enough::Variance { variance: allowed, most: MOST_PATHS }))
        })?;
        Ok(found.into_iter().flatten().collect())
    }

    /// Gathers what is too noisy, and makes the grid and the report.
    fn finish(mut self, ended_by: EndedBy, look: Look) -> Result<Simulated, BakeError> {
        let noisy = self.noisy(&look)?;
        let converged = ended_by == EndedBy::Accuracy;
        let gathered_noisy = if converged && !noisy.is_empty() { self.gather(&noisy)? } else { 0 };
        let look = self.look_again()?;
        let probes = self.probes.as_ref();
        let into_grid: u64 = self.gathered.values().map(|gather| u64::from(gather.paths)).sum();
        let report = AccuracyReport {
            asked: self.asked,
            reached: look.reached(),
            noise: look.relative(look.noise),
            bias: look.bias_known.then(|| look.relative(look.bias)),
            ended_by,
            batches: 2 * self.noise.pairs(),
            looks: self.looks,
            vertices: self.job.counted().count(),
            probes: probes.map_or(0, Probes::len),
            gathered_biased: self.biased,
            gathered_noisy,
            noisy: noisy.len() - gathered_noisy,
            paths: into_grid + probes.map_or(0, Probes::paths),
        };
        drop((self.noise, self.axes));
        let estimate = self.tally.estimate;
        let traced = self.tally.finish();
        let power = self.job.power() / traced.photons as f64;
        let mut values = estimate.values(traced.sums, self.job.ready.cells.len(), power);
        self.job.carry(&mut values)?;
        for (vertex, gather) in &self.gathered {
            values[*vertex] = E::Value::gathered(&gather.numbers);
        }
        Ok(Simulated {
            values: values.into(),
            books: traced.books,
            photons: traced.photons,
            paths: report.paths,
            accuracy: Some(report),
            rough: 0,
        })
    }

    fn bias(&mut self) -> Option<Bias> {
        let probes = self.probes.as_ref()?;
        let photons = self.tally.photons() as f64;
        let unit = self.unit();
        Some(probes.bias(self.axes_of(), |vertex| self.noise.of_vertex(vertex) * unit * photons))
    }
}
