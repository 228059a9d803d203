//! Packets of mode `coded`: `spec/pmesh.md`, section 8.

mod attributes;
mod cells;
mod cut;
mod symbols;

use pmesh_format::{Attributes, Header, PacketEntry};

use super::lattice::Lattice;
use super::starts::{ALONG, COUNTS, HEIGHTS, RANKS};
use super::{Fault, Tables};
use attributes::Wedged;
use cells::Cells;
use cut::{ordered, run};
pub use symbols::{Asked, LAST_STATES, payload_of};
use symbols::{Binary, Sixteen, Symbols, residual};

/// Codes of `spec/tables/errors.toml`; all are reported at byte 0 unless the text says otherwise.
const POSITION: u16 = 501;
const PARENT: u16 = 503;
const CORNER: u16 = 504;
const FACE_VERTICES: u16 = 505;
const CODED_LENGTH: u16 = 515;
const CODED_PADDING: u16 = 516;
const CODED_FACES: u16 = 517;
const CODED_WORK: u16 = 518;

fn fault<T>(code: u16) -> Result<T, Fault> {
    Err(Fault { code, at: 0 })
}

type Cell = [i64; 3];

#[derive(Debug, Clone)]
struct Models {
    parents: Vec<Binary>,
    counts: Vec<Sixteen>,
    ranks: Vec<Sixteen>,
    switches: Vec<Binary>,
    faces: Vec<Binary>,
    thirds: Vec<Binary>,
    along: Vec<Sixteen>,
    heights: Vec<Sixteen>,
}

/// PMESH-COD-05: what is known of a vertex.
#[derive(Debug, Clone)]
struct Known {
    cell: Cell,
    scale: usize,
    height: i64,
    packet: usize,
    split: bool,
}

/// What coded packets build up.
#[derive(Debug, Clone)]
pub(super) struct Coded {
    models: Models,
    packets: usize,
    known: Vec<Known>,
    corners: Vec<[usize; 3]>,
    wedged: Wedged,
}

/// What a packet brings.
#[derive(Default)]
struct Brought {
    positions: Vec<Position>,
    /// Vertices of the new faces where each comes.
    faces: Vec<[usize; 3]>,
    parents: Vec<usize>,
    /// Whether each slot of the parent switches, in descending order, vertex by vertex.
    codes: Vec<bool>,
}

/// A position as it is read.
enum Position {
    Cell(Cell),
    Exact([f32; 3]),
}

/// A face at a vertex: its slot, the two vertices that follow.
#[derive(Clone, Copy)]
struct Spoke {
    slot: usize,
    out: usize,
    back: usize,
}

fn log2(x: i64) -> i64 {
    i64::from(x.max(1).ilog2())
}

/// The class c of PMESH-COD-05.
fn class(x: i64) -> i64 {
    4 * log2(x) + ((x.max(1) << 2 >> log2(x)) & 3)
}

/// The scale for a distance.
fn scale(distance: i64) -> usize {
    if distance == 0 { 0 } else { (log2(distance) + 1).min(15) as usize }
}

fn bits(most: i64) -> u32 {
    if most == 0 { 0 } else { most.ilog2() + 1 }
}

fn minus(a: Cell, b: Cell) -> Cell {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn distance(a: Cell, b: Cell) -> i64 {
    minus(a, b).iter().map(|x| x.abs()).sum()
}

impl Coded {
    pub(super) fn new() -> Self {
        let many = |p: i64, count: usize| vec![Binary { p, n: 0 }; count];
        let models = Models {
            parents: many(1 << 13, 8 * 9 * 16),
            counts: COUNTS.iter().flat_map(|starts| vec![Sixteen::new(starts); 4]).collect(),
            ranks: RANKS
                .chunks(4)
                .flat_map(|of_run| of_run.iter().map(Sixteen::new).cycle().take(36))
                .collect(),
            switches: many(1 << 14, 3),
            faces: [1 << 14, 24_000, 4_000, 4_000, 4_000, 4_000, 4_000, 4_000]
                .repeat(2)
                .into_iter()
                .map(|p| Binary { p, n: 0 })
                .collect(),
            thirds: many(30_000, 2),
            along: ALONG.iter().map(Sixteen::new).collect(),
            heights: HEIGHTS.iter().map(Sixteen::new).collect(),
        };
        Self { models, packets: 0, known: Vec::new(), corners: Vec::new(), wedged: Wedged::new() }
    }

    /// Takes a packet.
    pub(super) fn take(
        &mut self,
        tables: &mut Tables,
        header: &Header,
        entry: &PacketEntry,
        payload: &[u8],
    ) -> Result<(), Fault> {
        let Some(mut symbols) = Symbols::new(payload) else { return fault(CODED_LENGTH) };
        let mut brought = Brought::default();
        let looked_at = self.read(&mut symbols, &mut brought, header, entry)?;
        if !symbols.at_end() {
            return fault(CODED_LENGTH);
        }
        let (start, faces) = (entry.vertices.start as usize, (entry.faces.end - entry.faces.start) as usize);
        let wedges = (entry.wedges.end - entry.wedges.start) as usize;
        let demanded = (8 + (wedges + faces) / 4 + start / 64).max(looked_at.div_ceil(64));
        let left = symbols.at;
        let raw_at = symbols.raw_at() as usize;
        if left < raw_at && payload.len() > demanded {
            return Err(Fault { code: CODED_LENGTH, at: left });
        }
        if payload[left..raw_at].iter().any(|&byte| byte != 0) || symbols.rest() != 0 {
            return Err(Fault { code: CODED_PADDING, at: left });
        }
        self.packets += 1;
        self.hand_over(tables, header, &brought)
    }

    /// What reading a packet asks, and the answers: those of its payload, or `answers` and 0 behind them; and what was wrong with
    /// them, what stands behind the symbols not looked at.
    pub(super) fn asked(
        mut self,
        header: &Header,
        entry: &PacketEntry,
        payload: &[u8],
        answers: Option<Vec<i64>>,
    ) -> (Vec<Asked>, Option<Fault>) {
        let mut symbols = Symbols::new(payload).expect("two states");
        symbols.note(answers);
        let result = self.read(&mut symbols, &mut Brought::default(), header, entry);
        (symbols.asked(), result.err())
    }

    /// All symbols of a packet; how many faces of parents were looked at.
    fn read(
        &mut self,
        symbols: &mut Symbols<'_>,
        brought: &mut Brought,
        header: &Header,
        entry: &PacketEntry,
    ) -> Result<usize, Fault> {
        let cells = Cells::new(header);
        let (start, end) = (entry.vertices.start as usize, entry.vertices.end as usize);
        let base = header.base_vertices as usize;
        if start < base {
            self.base(symbols, brought, &cells, base, entry.faces.end as usize)?;
        }
        let (mut parent, mut times, mut looked_at) = (0, 0, 0);
        let mut vertex = start.max(base);
        while vertex < end {
            let mut parents = Vec::new();
            while parents.len() < 64.min(end - vertex) && parent < vertex {
                let model = self.parent_model(parent, times);
                if symbols.bit(&mut self.models.parents[model]) {
                    parents.push(parent);
                    times += 1;
                } else {
                    parent += 1;
                    times = 0;
                }
            }
            if parents.is_empty() {
                return fault(PARENT);
            }
            for parent in parents {
                looked_at += self.spokes(parent).len();
                if looked_at > 64 * entry.payload_bytes as usize {
                    return fault(CODED_WORK);
                }
                self.split(symbols, brought, &cells, vertex, parent, entry.faces.end as usize)?;
                if symbols.missing() {
                    return fault(CODED_LENGTH);
                }
                vertex += 1;
            }
        }
        if self.corners.len() != entry.faces.end as usize {
            return fault(CODED_FACES);
        }
        if header.attributes != Attributes::default() {
            let cells: Vec<Cell> = self.known.iter().map(|known| known.cell).collect();
            self.wedged.read(symbols, header, entry, &cells, brought)?;
        }
        Ok(looked_at)
    }

    /// What there is after the packet, with corners at its end, as raw packets leave it.
    fn hand_over(&self, tables: &mut Tables, header: &Header, brought: &Brought) -> Result<(), Fault> {
        let lattice = Lattice::new(header.bounds, header.positions.bits().unwrap_or(1));
        for position in &brought.positions {
            let position = match position {
                Position::Cell(cell) => lattice.position(*cell),
                Position::Exact(position) => *position,
            };
            if !position.iter().all(|x| x.is_finite()) {
                return fault(POSITION);
            }
            tables.positions.push(position);
        }
        let first = tables.positions.len() - brought.parents.len();
        tables.parents.extend((first..).zip(brought.parents.iter().copied()));
        if header.attributes == Attributes::default() {
            tables.owners = (0..tables.positions.len()).collect();
            tables.targets = tables.parents.clone();
            tables.corners = self.corners.clone();
        } else {
            self.wedged.hand_over(tables, header);
        }
        Ok(())
    }

    /// PMESH-COD-07: which model tells whether a vertex is split (once more).
    fn parent_model(&self, parent: usize, times: usize) -> usize {
        let known = &self.known[parent];
        let ago = self.packets - known.packet;
        let h = match times {
            0 if !known.split => ago.min(3),
            0 => {
                if ago > 1 {
                    5
                } else {
                    4
                }
            }
            1 => 6,
            _ => 7,
        };
        (9 * h + self.spokes(parent).len().clamp(3, 11) - 3) * 16 + known.scale
    }

    /// PMESH-COD-06.
    fn base(
        &mut self,
        symbols: &mut Symbols<'_>,
        brought: &mut Brought,
        cells: &Cells,
        base: usize,
        most_faces: usize,
    ) -> Result<(), Fault> {
        for _ in 0..base {
            let cell = cells.most.map(|most| symbols.about("cell of the base").raw(bits(most)));
            if (0..3).any(|k| cell[k] > cells.most[k]) {
                return fault(POSITION);
            }
            brought.positions.push(cells.position(symbols, cell)?);
            self.known.push(Known { cell, scale: 0, height: 0, packet: self.packets, split: false });
            if symbols.missing() {
                return fault(CODED_LENGTH);
            }
        }
        let count = symbols.about("faces of the base").raw(32) as usize;
        if count > most_faces {
            return fault(CODED_FACES);
        }
        for _ in 0..count {
            let face = [0; 3].map(|_: usize| symbols.raw(bits(base as i64 - 1)) as usize);
            if symbols.missing() {
                return fault(CODED_LENGTH);
            }
            if face.iter().any(|&corner| corner >= base) {
                return fault(CORNER);
            }
            if face[0] == face[1] || face[1] == face[2] || face[2] == face[0] {
                return fault(FACE_VERTICES);
            }
            self.corners.push(face);
            brought.faces.push(face);
        }
        Ok(())
    }

    /// The faces at a vertex, in ascending order of slots.
    fn spokes(&self, vertex: usize) -> Vec<Spoke> {
        let slots = (0..3 * self.corners.len()).filter(|slot| self.corners[slot / 3][slot % 3] == vertex);
        slots
            .map(|slot| {
                let face = self.corners[slot / 3];
                Spoke { slot, out: face[(slot + 1) % 3], back: face[(slot + 2) % 3] }
            })
            .collect()
    }

    /// PMESH-COD-09, PMESH-COD-10, and what is remembered afterwards.
    fn split(
        &mut self,
        symbols: &mut Symbols<'_>,
        brought: &mut Brought,
        cells: &Cells,
        vertex: usize,
        parent: usize,
        most_faces: usize,
    ) -> Result<(), Fault> {
        let ascending = self.spokes(parent);
        let (spokes, round) = ordered(&ascending);
        let m = spokes.len();
        let here = self.known[parent].cell;
        let edges: Vec<i64> = spokes.iter().map(|spoke| distance(self.known[spoke.out].cell, here)).collect();
        let mut switches = vec![false; m];
        let mut thirds: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
        let mut inside = Vec::new();
        let mut neighbours = vec![(parent, here)];
        let regular = if round { run(symbols, &mut self.models, &edges)? } else { None };
        if let Some((first, count)) = regular {
            if self.corners.len() + 2 > most_faces {
                return fault(CODED_FACES);
            }
            let places: Vec<usize> = (0..count).map(|k| (first + k) % m).collect();
            for &k in &places {
                switches[k] = true;
                neighbours.push((spokes[k].out, self.known[spokes[k].out].cell));
            }
            let last = spokes[places[count - 1]].back;
            neighbours.push((last, self.known[last].cell));
            inside = places[1..].to_vec();
            thirds = [vec![spokes[first].out], vec![last]];
        } else {
            let mut before = 0;
            for k in 0..m {
                switches[k] = symbols.bit(&mut self.models.switches[before]);
                before = 1 + usize::from(switches[k]);
                if switches[k] {
                    for neighbour in [spokes[k].out, spokes[k].back] {
                        let cell = self.known[neighbour].cell;
                        if neighbours.len() < 34 && neighbours.iter().all(|&(_, there)| there != cell) {
                            neighbours.push((neighbour, cell));
                        }
                    }
                }
            }
            self.escape(symbols, &spokes, &switches, &mut thirds, vertex, parent, most_faces)?;
        }
        let (cell, height, reach) = self.cell(symbols, &spokes, &switches, &neighbours, parent);
        if (0..3).any(|k| cell[k] < 0 || cell[k] > cells.most[k]) {
            return fault(POSITION);
        }
        brought.positions.push(cells.position(symbols, cell)?);
        // The mesh of level v + 1.
        for spoke in ascending.iter().rev() {
            let switch = spokes.iter().zip(&switches).any(|(s, &switch)| s.slot == spoke.slot && switch);
            brought.codes.push(switch);
            if switch {
                self.corners[spoke.slot / 3][spoke.slot % 3] = vertex;
            }
        }
        let starts = thirds[0].iter().map(|&x| [parent, x, vertex]);
        let new: Vec<[usize; 3]> = starts.chain(thirds[1].iter().map(|&x| [parent, vertex, x])).collect();
        self.corners.extend(&new);
        brought.faces.extend(new);
        brought.parents.push(parent);
        // What is remembered.
        let all: i64 = edges.iter().take(32).sum();
        let inner: i64 = inside.iter().map(|&k| edges[k]).sum();
        let apart = distance(cell, here);
        let old = &mut self.known[parent];
        old.scale = scale((all + apart - inner) / (m as i64 + 1 - inside.len() as i64));
        old.height = (height + old.height) / 2;
        old.packet = self.packets;
        old.split = true;
        self.known.push(Known { cell, scale: scale(reach), height, packet: self.packets, split: false });
        Ok(())
    }

    /// New faces where a split is not regular: the third vertices of those of either side.
    #[expect(clippy::too_many_arguments, reason = "all of the split")]
    fn escape(
        &mut self,
        symbols: &mut Symbols<'_>,
        spokes: &[Spoke],
        switches: &[bool],
        thirds: &mut [Vec<usize>; 2],
        vertex: usize,
        parent: usize,
        most_faces: usize,
    ) -> Result<(), Fault> {
        let m = spokes.len();
        let starts = (1..m).find(|&k| switches[k] && !switches[k - 1]).map(|k| spokes[k].out);
        let stops = (1..m).find(|&k| !switches[k] && switches[k - 1]).map(|k| spokes[k - 1].back);
        let without = [spokes.first().map_or(0, |s| s.out), spokes.last().map_or(0, |s| s.back)];
        for (side, expected) in [starts, stops].into_iter().enumerate() {
            loop {
                let model = 2 * (4 * side + thirds[side].len().min(3)) + usize::from(expected.is_some());
                if !symbols.about("more faces").bit(&mut self.models.faces[model]) {
                    break;
                }
                let x = if symbols.bit(&mut self.models.thirds[0]) {
                    expected.unwrap_or(without[side])
                } else if symbols.bit(&mut self.models.thirds[1]) {
                    let place = symbols.raw(bits(m as i64)) as usize;
                    let Some(spoke) = spokes.get(place) else { return fault(CORNER) };
                    if symbols.raw(1) == 1 { spoke.back } else { spoke.out }
                } else {
                    symbols.raw(bits(vertex as i64)) as usize
                };
                if x >= vertex {
                    return fault(CORNER);
                }
                if x == parent {
                    return fault(FACE_VERTICES);
                }
                thirds[side].push(x);
                if symbols.missing() {
                    return fault(CODED_LENGTH);
                }
                if self.corners.len() + thirds[0].len() + thirds[1].len() > most_faces {
                    return fault(CODED_FACES);
                }
            }
        }
        Ok(())
    }

    /// PMESH-COD-10: the cell of the new vertex, its height class, and the distance of its scale.
    fn cell(
        &mut self,
        symbols: &mut Symbols<'_>,
        spokes: &[Spoke],
        switches: &[bool],
        neighbours: &[(usize, Cell)],
        parent: usize,
    ) -> (Cell, i64, i64) {
        let here = self.known[parent].cell;
        let k = neighbours.len() as i64;
        let sum = |f: &dyn Fn(Cell) -> i64| neighbours.iter().map(|&(_, cell)| f(cell)).sum::<i64>();
        let mean =
            [0, 1, 2].map(|axis| (2 * (sum(&|cell| cell[axis]) + here[axis]) + k + 1).div_euclid(2 * k + 2));
        let spread = [0, 1, 2].map(|axis| class(8 * sum(&|cell| (cell[axis] - mean[axis]).abs()) / k + 1));
        let mut n = [0i64; 3];
        for (spoke, _) in spokes.iter().zip(switches).filter(|(_, switch)| **switch) {
            let [a, b] = [spoke.out, spoke.back].map(|v| minus(self.known[v].cell, here));
            for (axis, n) in n.iter_mut().enumerate() {
                let (u, w) = ((axis + 1) % 3, (axis + 2) % 3);
                *n += a[u] * b[w] - a[w] * b[u];
            }
        }
        // By the bits of the greatest component without its sign.
        let widest = n.iter().fold(0, |all, x| all | x.unsigned_abs()).max(1).ilog2() + 1;
        let n = n.map(|x| x >> widest.saturating_sub(24));
        let main = (0..3).fold(0, |best, axis| if n[axis].abs() > n[best].abs() { axis } else { best });
        let (first, second) = ((main + 1) % 3, (main + 2) % 3);
        let wrap = |x: i64| i64::from(x as i32);
        let mut cell = [0; 3];
        for axis in [first, second] {
            cell[axis] = wrap(mean[axis] + residual(symbols, &mut self.models.along, spread[axis]));
        }
        let expected = if n[main] == 0 {
            mean[main]
        } else {
            let along = |axis: usize| n[axis] * (cell[axis] - here[axis]);
            let (over, under) = (-along(first) - along(second), n[main]);
            let (over, under) = if under < 0 { (-over, -under) } else { (over, under) };
            wrap(here[main] + wrap((2 * over + under).div_euclid(2 * under)))
        };
        let heights: i64 = neighbours.iter().map(|&(v, _)| self.known[v].height).sum();
        let height = residual(symbols, &mut self.models.heights, heights / k);
        cell[main] = wrap(expected + height);
        let reach = sum(&|there| distance(there, mean)) / k + distance(cell, mean);
        (cell, class(2 * height.abs() + 1) % 256, reach)
    }
}
