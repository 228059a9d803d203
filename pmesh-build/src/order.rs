//! The order of collapses: always the cheapest one that is allowed.

use pmesh_format::Wedges;

use crate::attributes::Deviations;
use crate::cost::Costs;
use crate::input::index;
use crate::options::{BuildOptions, BuildReport};
use crate::pairing::pair;
use crate::queue::{Candidate, Queue};
use crate::rules::{Rules, allowed};
use crate::surface::{Ring, Surface};

/// A vertex with more faces than this around it that no collapse was allowed for is not looked at again after every
/// collapse beside it: a fan of k triangles would else cost k² steps.
const HUB_FACES: usize = 64;
/// Coincident faces are avoided while more than one vertex in this many is left (spec PMESH-LVL-03).
const COINCIDENT_SHARE: usize = 100;
/// Topology gives way from one vertex in this many on, even while collapses that keep it are left. The rims of a scan's
/// pinholes and tunnels hold vertices: at 0.2 % of the faces of the Stanford dragon keeping them doubles the mean distance.
const TOPOLOGY_SHARE: usize = 300;
/// When nothing is allowed any more the rules are relaxed, unless going over all vertices once more (what is around them
/// has changed) had freed at least one collapse for this many vertices.
const RETRY_SHARE: usize = 16;
/// What a collapse costs at least rises with the average area of vertices. A candidate is queued once more only if that
/// is more than this times what it was queued with.
const RISE: f64 = 1.1;

/// One vertex that is gone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Collapse {
    pub(crate) vertex: u32,
    pub(crate) parent: u32,
    /// Estimated distance \[m\].
    pub(crate) distance: f64,
}

/// What ordering results in.
#[derive(Debug, Default)]
pub(crate) struct Order {
    /// Collapses, in the order in which they were made.
    pub(crate) collapses: Vec<Collapse>,
    /// For each wedge of the input the wedge that it becomes; itself while its vertex is not collapsed.
    pub(crate) wedge_targets: Vec<u32>,
}

/// Collapses `surface` as far as it goes: three vertices, if it has a face.
pub(crate) fn find(
    surface: Surface,
    wedges: &Wedges,
    options: &BuildOptions,
    report: &mut BuildReport,
    progress: &mut dyn FnMut(f32),
) -> Order {
    let vertices = surface.positions.len();
    let mut ring = Ring::new(vertices);
    let mut first_wedge = vec![0; vertices + 1];
    for &v in &wedges.vertices {
        first_wedge[v as usize + 1] += 1;
    }
    for v in 0..vertices {
        first_wedge[v + 1] += first_wedge[v];
    }
    let deviations = Deviations::new(&surface, wedges, &first_wedge, &options.attributes);
    let costs = Costs::new(options.cost, &surface, deviations, &mut ring);
    let mut run = Run {
        costs,
        ring,
        queue: Queue::new(vertices),
        stale: vec![false; vertices],
        measured: vec![f64::NAN; vertices],
        gone: vec![false; vertices],
        left: vertices,
        total: vertices,
        rules: Rules::Strict,
        first_left: 0,
        first_wedge,
        targets: Vec::new(),
        neighbours: Vec::new(),
        beside: Vec::new(),
        options: Vec::new(),
        order: Order {
            collapses: Vec::with_capacity(vertices),
            wedge_targets: (0..index(wedges.len())).collect(),
        },
        surface,
        wedges,
    };
    run.all(report, progress);
    run.order
}

struct Run<'a> {
    surface: Surface,
    wedges: &'a Wedges,
    costs: Costs<'a>,
    ring: Ring,
    queue: Queue,
    /// Whether something beside a vertex has collapsed since its candidate was queued. What it costs has hardly ever
    /// fallen since then, so it is looked at again only when it comes up.
    stale: Vec<bool>,
    /// The squared distance that the candidate of each vertex costs at least \[m²\]; NaN while that is not known.
    measured: Vec<f64>,
    gone: Vec<bool>,
    left: usize,
    total: usize,
    rules: Rules,
    /// No vertex below it is left with faces.
    first_left: usize,
    /// First wedge of each vertex, and the end.
    first_wedge: Vec<u32>,
    // Scratch space, kept to spare allocations.
    targets: Vec<u32>,
    neighbours: Vec<u32>,
    beside: Vec<u32>,
    options: Vec<(f64, u32)>,
    order: Order,
}

impl Run<'_> {
    fn all(&mut self, report: &mut BuildReport, progress: &mut dyn FnMut(f32)) {
        let step = (self.total / 100).max(1);
        self.refill();
        let mut made = 0;
        let mut coincident = self.coincident();
        loop {
            if coincident != self.coincident() {
                coincident = true;
                self.refill();
            }
            if self.rules == Rules::Strict && self.left * TOPOLOGY_SHARE <= self.total {
                self.rules = Rules::Topology;
                self.refill();
            }
            let Some(Candidate { u, v, cost }) = self.queue.pop() else {
                if made * RETRY_SHARE <= self.left {
                    self.rules = match self.rules {
                        Rules::Strict => Rules::Topology,
                        Rules::Topology => Rules::Any,
                        Rules::Any if made > 0 => Rules::Any,
                        Rules::Any => return,
                    };
                }
                made = 0;
                self.refill();
                continue;
            };
            if self.gone[v as usize] || self.stale[u as usize] {
                self.look(u);
                continue;
            }
            self.ring.collect(&self.surface, u);
            if !self.allowed(u, v) || self.has_risen(u, v, cost) {
                self.look_closely(u);
                continue;
            }
            let before = self.left;
            match self.rules {
                Rules::Strict => {}
                Rules::Topology => report.relaxed_collapses += 1,
                Rules::Any => report.forced_collapses += 1,
            }
            if self.rules > Rules::Strict && report.relaxed_from == 0 {
                report.relaxed_from = self.left;
            }
            self.collapse(u, v, report);
            made += 1;
            if before / step != self.left / step {
                progress((self.total - self.left) as f32 / self.total as f32);
            }
        }
    }

    /// Looks at every vertex that is left.
    fn refill(&mut self) {
        for u in 0..index(self.total) {
            if !self.gone[u as usize] {
                self.look(u);
            }
        }
    }

    fn coincident(&self) -> bool {
        self.rules == Rules::Any || self.left * COINCIDENT_SHARE <= self.total
    }

    /// Whether `u`, whose edges are in `ring`, may move onto `v`.
    fn allowed(&mut self, u: u32, v: u32) -> bool {
        let coincident = self.coincident();
        allowed(&self.surface, u, v, self.rules, coincident, &self.ring)
    }

    /// Queues the cheapest collapse of `u`, allowed or not: most never come up, so that is found out later. Leaves the
    /// neighbours of `u` in `neighbours`.
    fn look(&mut self, u: u32) {
        self.stale[u as usize] = false;
        self.measured[u as usize] = f64::NAN;
        self.surface.neighbours(u, &mut self.neighbours);
        let mut best: Option<Candidate> = None;
        for &v in &self.neighbours {
            let cost = self.costs.of(&self.surface, u, v);
            if best.is_none_or(|b| cost.total_cmp(&b.cost).then(v.cmp(&b.v)).is_lt()) {
                best = Some(Candidate { cost, u, v });
            }
        }
        match best {
            Some(candidate) => self.queue.set(candidate),
            None => self.queue.remove(u),
        }
    }

    /// Queues the cheapest allowed collapse of `u`, whose edges are in `ring`, if there is one.
    fn look_closely(&mut self, u: u32) {
        let mut options = std::mem::take(&mut self.options);
        options.clear();
        options.extend(self.ring.edges.iter().map(|e| (self.costs.of(&self.surface, u, e.to), e.to)));
        options.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let unit = self.costs.average_area(self.left);
        let mut best: Option<Candidate> = None;
        for &(cost, v) in &options {
            let most = best.map_or(f64::INFINITY, |b| b.cost);
            if most <= cost {
                break;
            }
            if self.allowed(u, v) {
                let squared = self.squared_distance(u, v, cost / unit, most / unit);
                let cost = cost.max(squared * unit);
                if cost < most {
                    best = Some(Candidate { cost, u, v });
                    self.measured[u as usize] = squared;
                }
            }
        }
        if let Some(candidate) = best {
            self.queue.set(candidate);
        }
        if !self.costs.measures(self.left) {
            self.measured[u as usize] = f64::NAN;
        }
        self.options = options;
    }

    /// Whether moving `u` onto `v`, its candidate, costs more than it was queued with.
    fn has_risen(&mut self, u: u32, v: u32, cost: f64) -> bool {
        let limit = RISE * cost / self.costs.average_area(self.left);
        let known = self.measured[u as usize];
        let squared = if known.is_nan() { self.squared_distance(u, v, limit, limit) } else { known };
        squared > limit
    }

    /// See [`Costs::squared_distance`]. Where nothing else is allowed any more, everything may go.
    fn squared_distance(&mut self, u: u32, v: u32, enough: f64, limit: f64) -> f64 {
        if self.rules > Rules::Topology {
            return 0.0;
        }
        self.costs.squared_distance(&self.surface, &self.ring, (u, v), self.left, (enough, limit))
    }

    /// Moves `u` onto `v`, removes vertices that lose their last face, and looks at what is around again.
    fn collapse(&mut self, u: u32, v: u32, report: &mut BuildReport) {
        let distance = self.costs.distance(&self.surface, u, v);
        self.record(u, v, distance);
        // The ring holds the edges of `u`: the vertices that may have lost their last face.
        let mut beside = std::mem::take(&mut self.beside);
        beside.clear();
        beside.extend(self.ring.edges.iter().map(|e| e.to));
        let targets = &self.order.wedge_targets;
        self.surface.collapse(u, v, |w| targets[w as usize]);
        let wedges = self.first_wedge[u as usize] as usize..self.first_wedge[u as usize + 1] as usize;
        self.costs.collapsed(&self.surface, u, v, &targets[wedges]);
        beside.sort_unstable();
        for &x in &beside {
            if self.surface.around(x).is_empty() {
                let parent = self.any_left();
                self.record(x, parent, 0.0);
                report.isolated_vertices += 1;
            }
        }
        if let Some(x) = self.surface.lone_pair(v) {
            // What is left of a component is flat and has no outside: it goes at once.
            self.beside = beside;
            self.ring.collect(&self.surface, v);
            self.collapse(v, x, report);
            return;
        }
        if !self.gone[v as usize] {
            self.look(v);
            beside.clone_from(&self.neighbours);
            for &x in &beside {
                self.stale[x as usize] = true;
                if !self.queue.contains(x) && self.surface.around(x).len() <= HUB_FACES {
                    self.look(x);
                }
            }
        }
        self.beside = beside;
    }

    /// Writes down that `u` is gone and what its wedges become.
    fn record(&mut self, u: u32, parent: u32, distance: f64) {
        let range = |v: u32| self.first_wedge[v as usize]..self.first_wedge[v as usize + 1];
        let wedges = range(u);
        let mut targets = std::mem::take(&mut self.targets);
        pair(&self.surface, self.wedges, (u, wedges.clone()), (parent, range(parent)), &mut targets);
        self.order.wedge_targets[wedges.start as usize..wedges.end as usize].copy_from_slice(&targets);
        self.targets = targets;
        self.order.collapses.push(Collapse { vertex: u, parent, distance });
        self.gone[u as usize] = true;
        self.queue.remove(u);
        self.left -= 1;
    }

    /// The first vertex that is left and has faces.
    fn any_left(&mut self) -> u32 {
        while self.gone[self.first_left] || self.surface.around(index(self.first_left)).is_empty() {
            self.first_left += 1;
        }
        index(self.first_left)
    }
}
