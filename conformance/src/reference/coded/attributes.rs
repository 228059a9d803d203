//! Attributes of coded packets: `spec/pmesh.md`, PMESH-COD-13 to -17.

use super::super::lattice::Lattice;
use super::super::starts::HEIGHTS;
use super::super::{Fault, Tables};
use super::symbols::{Binary, Sixteen, Symbols, residual};
use super::{Brought, CODED_LENGTH, CORNER, Cell, bits, class, fault, minus};
use pmesh_format::{Attributes, Header, PacketEntry};

/// Codes of `spec/tables/errors.toml`.
const ATTRIBUTE: u16 = 502;
const WEDGE_COUNT: u16 = 509;
const WEDGE_TARGET: u16 = 510;
const SWITCH: u16 = 511;

#[derive(Debug, Clone)]
struct Models {
    more: Vec<Binary>,
    targets: Vec<Binary>,
    same: Binary,
    corners: Vec<Binary>,
    materials: Vec<Binary>,
    exact: Vec<Vec<Binary>>,
    normals: Vec<Sixteen>,
    uvs: Vec<Sixteen>,
    green: Vec<Sixteen>,
    others: Vec<Sixteen>,
    alpha: Vec<Sixteen>,
}

/// What is known of wedges.
#[derive(Debug, Clone)]
pub(super) struct Wedged {
    models: Models,
    corners: Vec<[usize; 3]>,
    owners: Vec<usize>,
    targets: Vec<usize>,
    classes: Vec<[i64; 3]>,
    normals: Vec<[i64; 2]>,
    uvs: Vec<[i64; 2]>,
    colours: Vec<[i64; 4]>,
    materials: Vec<u16>,
}

/// PMESH-COD-16, PMESH-COD-17: how values are stored.
struct Plan {
    has: Attributes,
    most: i64,
    lattice: Lattice,
}

impl Wedged {
    pub(super) fn new() -> Self {
        let many = |p: i64, count: usize| vec![Binary { p, n: 0 }; count];
        let values = || HEIGHTS.iter().map(Sixteen::new).collect::<Vec<_>>();
        let more = (0..16).map(|k| if k % 4 < k / 4 { 30_000 } else { 2_768 });
        let models = Models {
            more: more.map(|p| Binary { p, n: 0 }).collect(),
            targets: many(30_000, 2),
            same: Binary { p: 30_000, n: 0 },
            corners: many(30_000, 6),
            materials: many(30_000, 2),
            exact: vec![many(1 << 14, 16); 3],
            normals: values(),
            uvs: values(),
            green: values(),
            others: values(),
            alpha: values(),
        };
        Self {
            models,
            corners: Vec::new(),
            owners: Vec::new(),
            targets: Vec::new(),
            classes: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colours: Vec::new(),
            materials: Vec::new(),
        }
    }

    /// PMESH-COD-13.
    pub(super) fn read(
        &mut self,
        symbols: &mut Symbols<'_>,
        header: &Header,
        entry: &PacketEntry,
        cells: &[Cell],
        brought: &Brought,
    ) -> Result<(), Fault> {
        let plan = Plan::new(header);
        let base = header.base_vertices as usize;
        let most = entry.wedges.end as usize;
        let mut faces = brought.faces.iter().copied().peekable();
        if (entry.vertices.start as usize) < base {
            for vertex in 0..base {
                self.number(symbols, &plan, vertex, 1, most)?;
                self.targets.resize(self.owners.len(), 0);
                if symbols.missing() {
                    return fault(CODED_LENGTH);
                }
            }
            while let Some(face) = faces.next_if(|face| face.iter().all(|&v| v < base)) {
                let mut corners = [0; 3];
                for (k, v) in face.into_iter().enumerate() {
                    let own = self.of(v);
                    let own_bits = bits(own.len() as i64 - 1);
                    let place = symbols.about("place of a wedge of the base").raw(own_bits) as usize;
                    let Some(&wedge) = own.get(place) else { return fault(CORNER) };
                    corners[k] = wedge;
                }
                if plan.has.materials {
                    self.materials.push(symbols.raw(16) as u16);
                }
                self.corners.push(corners);
                if symbols.missing() {
                    return fault(CODED_LENGTH);
                }
            }
            for _ in 0..self.owners.len() {
                self.first_values(symbols, &plan)?;
                if symbols.missing() {
                    return fault(CODED_LENGTH);
                }
            }
        }
        let mut codes = brought.codes.iter().copied();
        let first = (entry.vertices.start as usize).max(base);
        for (v, &p) in (first..).zip(&brought.parents) {
            self.split(symbols, &plan, v, p, most, &mut codes)?;
            while let Some(face) = faces.next_if(|face| face.iter().all(|&x| x <= v)) {
                self.face(symbols, &plan, v, p, face)?;
            }
            for wedge in self.of(v) {
                self.values(symbols, &plan, v, wedge, cells)?;
            }
            if symbols.missing() {
                return fault(CODED_LENGTH);
            }
        }
        if self.owners.len() != most {
            return fault(WEDGE_COUNT);
        }
        Ok(())
    }

    fn of(&self, vertex: usize) -> Vec<usize> {
        (0..self.owners.len()).filter(|&w| self.owners[w] == vertex).collect()
    }

    /// The slots of a vertex, ascending.
    fn slots(&self, vertex: usize) -> Vec<usize> {
        (0..3 * self.corners.len()).filter(|s| self.owners[self.corners[s / 3][s % 3]] == vertex).collect()
    }

    /// PMESH-COD-14, 1.
    fn number(
        &mut self,
        symbols: &mut Symbols<'_>,
        plan: &Plan,
        vertex: usize,
        expected: usize,
        most: usize,
    ) -> Result<usize, Fault> {
        let expected = expected.max(1);
        for k in 1usize.. {
            if self.owners.len() == most {
                return fault(WEDGE_COUNT);
            }
            self.owners.push(vertex);
            let model = 4 * (expected.min(4) - 1) + k.min(4) - 1;
            if !plan.has.seams || !symbols.bit(&mut self.models.more[model]) {
                return Ok(k);
            }
        }
        unreachable!("there are only so many wedges")
    }

    /// PMESH-COD-14, 1 to 3.
    fn split(
        &mut self,
        symbols: &mut Symbols<'_>,
        plan: &Plan,
        v: usize,
        p: usize,
        most: usize,
        codes: &mut impl Iterator<Item = bool>,
    ) -> Result<(), Fault> {
        let slots = self.slots(p);
        let mut switches: Vec<bool> = codes.take(slots.len()).collect();
        switches.reverse();
        let parents = self.of(p);
        let had = |slot: usize| self.corners[slot / 3][slot % 3];
        let mut t: Vec<usize> = Vec::new();
        if parents.len() > 1 {
            t.extend(slots.iter().zip(&switches).filter(|(_, s)| **s).map(|(&slot, _)| had(slot)));
            t.sort_unstable();
            t.dedup();
        }
        let count = self.number(symbols, plan, v, t.len(), most)?;
        let own = self.of(v);
        for j in 0..count {
            let mut target = parents[0];
            if parents.len() > 1 {
                target = *t.get(j).or(t.last()).unwrap_or(&parents[0]);
                if !symbols.about("target").bit(&mut self.models.targets[usize::from(j >= t.len())]) {
                    let place = symbols.raw(bits(parents.len() as i64 - 1)) as usize;
                    let Some(&other) = parents.get(place) else { return fault(WEDGE_TARGET) };
                    target = other;
                }
            }
            self.targets.push(target);
        }
        let mut before = None;
        let mut chosen = Vec::new();
        for (&slot, _) in slots.iter().zip(&switches).filter(|(_, switches)| **switches) {
            let present = self.corners[slot / 3][slot % 3];
            let among: Vec<usize> =
                own.iter().copied().filter(|&w| !plan.has.seams || self.targets[w] == present).collect();
            let Some(&first) = among.first() else { return fault(SWITCH) };
            let mut wedge = first;
            if among.len() > 1 {
                wedge = before.filter(|before| among.contains(before)).unwrap_or(first);
                if !symbols.about("wedge of a slot").bit(&mut self.models.same) {
                    let place = symbols.raw(bits(among.len() as i64 - 1)) as usize;
                    let Some(&other) = among.get(place) else { return fault(SWITCH) };
                    wedge = other;
                }
                before = Some(wedge);
            }
            chosen.push((slot, wedge));
        }
        for (slot, wedge) in chosen {
            self.corners[slot / 3][slot % 3] = wedge;
        }
        Ok(())
    }

    /// PMESH-COD-14, 4 and 5.
    fn face(
        &mut self,
        symbols: &mut Symbols<'_>,
        plan: &Plan,
        v: usize,
        p: usize,
        face: [usize; 3],
    ) -> Result<(), Fault> {
        let x = if face[1] == v { face[2] } else { face[1] };
        let on = |face: usize, vertex: usize| {
            self.corners[face].iter().copied().find(|&w| self.owners[w] == vertex)
        };
        let beside = [p, v].map(|q| {
            let faces = self.slots(q).into_iter().take(32).map(|slot| slot / 3);
            faces.into_iter().find(|&face| on(face, x).is_some())
        });
        let mut wedges = [0; 3];
        let mut other = false;
        for (k, vertex) in [p, v, x].into_iter().enumerate() {
            let own = self.of(vertex);
            wedges[k] = own[0];
            if own.len() == 1 {
                continue;
            }
            let from = match k {
                0 => beside[0],
                1 => beside[1],
                _ if other => beside[1].or(beside[0]),
                _ => beside[0].or(beside[1]),
            };
            let guess =
                from.and_then(|face| self.corners[face].iter().copied().find(|&w| self.owners[w] == vertex));
            wedges[k] = guess.unwrap_or(own[0]);
            if !symbols.about("corner").bit(&mut self.models.corners[2 * k + usize::from(from.is_some())]) {
                let place = symbols.raw(bits(own.len() as i64 - 1)) as usize;
                let Some(&wedge) = own.get(place) else { return fault(CORNER) };
                wedges[k] = wedge;
                other |= k == 0;
            }
        }
        if plan.has.materials {
            let [first, second] = beside.map(|face| face.map(|face| self.materials[face]));
            let guess = first.or(second).or(self.materials.last().copied()).unwrap_or(0);
            let material = if symbols.bit(&mut self.models.materials[0]) {
                guess
            } else {
                match second {
                    Some(second) if second != guess && symbols.bit(&mut self.models.materials[1]) => second,
                    _ => symbols.raw(16) as u16,
                }
            };
            self.materials.push(material);
        }
        let place = |vertex: usize| [p, v, x].iter().position(|&q| q == vertex).unwrap_or(0);
        self.corners.push(face.map(|vertex| wedges[place(vertex)]));
        if symbols.missing() { fault(CODED_LENGTH) } else { Ok(()) }
    }

    /// The values of a wedge of the base.
    fn first_values(&mut self, symbols: &mut Symbols<'_>, plan: &Plan) -> Result<(), Fault> {
        if plan.has.normals {
            let code =
                [0; 2].map(|_: i64| symbols.about("normal of the base").raw(bits(2 * plan.most)) - plan.most);
            self.normals.push(plan.normal(code)?);
        }
        if plan.has.uvs {
            let point = [0, 1].map(|k| symbols.raw(bits(plan.lattice.most[k])));
            self.uvs.push(plan.uv(point)?);
        }
        if plan.has.colours {
            self.colours.push([0; 4].map(|_: i64| symbols.raw(8)));
        }
        self.classes.push([12; 3]);
        Ok(())
    }

    /// PMESH-COD-15 to PMESH-COD-17.
    fn values(
        &mut self,
        symbols: &mut Symbols<'_>,
        plan: &Plan,
        v: usize,
        wedge: usize,
        cells: &[Cell],
    ) -> Result<(), Fault> {
        let own = self.slots(v).into_iter().filter(|s| self.corners[s / 3][s % 3] == wedge);
        let mut around = Vec::new();
        let mut n = [0i64; 3];
        for slot in own.take(16) {
            let face = self.corners[slot / 3];
            let ends = [face[(slot + 1) % 3], face[(slot + 2) % 3]];
            let [a, b] = ends.map(|w| minus(cells[self.owners[w]], cells[v]));
            for (axis, n) in n.iter_mut().enumerate() {
                let (u, w) = ((axis + 1) % 3, (axis + 2) % 3);
                *n += a[u] * b[w] - a[w] * b[u];
            }
            around.extend(ends);
        }
        let target = self.targets[wedge];
        if around.is_empty() {
            around.push(target);
        }
        let places: Vec<Cell> = around.iter().map(|&w| cells[self.owners[w]]).collect();
        let weights = weights(&places, cells[v], n);
        let k = around.len() as i64;
        let mean_class = |kind: usize| around.iter().map(|&w| self.classes[w][kind]).sum::<i64>() / k;
        let classes = [0, 1, 2].map(mean_class);
        let mut sums = [0; 3];
        let model = |kind: usize, alike: bool| 2 * (classes[kind] / 4).min(7) as usize + usize::from(alike);
        let wrap = |x: i64| i64::from(x as i32);
        if plan.has.normals {
            let all: Vec<[i64; 2]> = around.iter().map(|&w| self.normals[w]).collect();
            let points: Vec<[i64; 3]> = all.iter().map(|&code| plan.point(code).map(|x| 16 * x)).collect();
            let expected = plan.projected(expected(&weights, &points)).unwrap_or(self.normals[target]);
            let below = expected[0].abs() + expected[1].abs() > plan.most;
            let turned = |code| if below { plan.turned(code) } else { code };
            let mut code = turned(expected);
            let alike = all.iter().all(|&other| other == all[0]);
            if !symbols.about("normal").bit(&mut self.models.exact[0][model(0, alike)]) {
                for x in &mut code {
                    let r = residual(symbols, &mut self.models.normals, classes[0]);
                    sums[0] += r.abs();
                    *x = wrap(*x + r);
                }
            }
            self.normals.push(turned(plan.normal(code)?));
        }
        if plan.has.uvs {
            let all: Vec<[i64; 2]> = around.iter().map(|&w| self.uvs[w]).collect();
            let [u, v] = expected(&weights, &all);
            let mut point = [u.clamp(0, plan.lattice.most[0]), v.clamp(0, plan.lattice.most[1])];
            let alike = all.iter().all(|&other| other == all[0]);
            if !symbols.about("texture coordinates").bit(&mut self.models.exact[1][model(1, alike)]) {
                for x in &mut point {
                    let r = residual(symbols, &mut self.models.uvs, classes[1]);
                    sums[1] += r.abs();
                    *x = wrap(*x + r);
                }
            }
            self.uvs.push(plan.uv(point)?);
        }
        if plan.has.colours {
            let all: Vec<[i64; 4]> = around.iter().map(|&w| self.colours[w]).collect();
            let mut colour = expected(&weights, &all).map(|x| x.clamp(0, 255));
            let alike = all.iter().all(|&other| other == all[0]);
            if !symbols.about("colour").bit(&mut self.models.exact[2][model(2, alike)]) {
                let g = residual(symbols, &mut self.models.green, classes[2]);
                let r = residual(symbols, &mut self.models.others, classes[2]);
                let b = residual(symbols, &mut self.models.others, classes[2]);
                let a = residual(symbols, &mut self.models.alpha, classes[2]);
                sums[2] = g.abs() + r.abs() + b.abs() + a.abs();
                for (x, r) in colour.iter_mut().zip([wrap(r + g), g, wrap(b + g), a]) {
                    *x = wrap(*x + r);
                }
            }
            if colour.iter().any(|x| !(0..=255).contains(x)) {
                return fault(ATTRIBUTE);
            }
            self.colours.push(colour);
        }
        let h = sums.map(|sum| class(1 + sum) % 256);
        self.classes.push(h);
        for (kind, class) in self.classes[target].iter_mut().enumerate() {
            *class = (h[kind] + *class) / 2;
        }
        Ok(())
    }

    /// What there is after a packet, as raw packets leave it.
    pub(super) fn hand_over(&self, tables: &mut Tables, header: &Header) {
        let plan = Plan::new(header);
        tables.owners.clone_from(&self.owners);
        tables.corners.clone_from(&self.corners);
        tables.materials.clone_from(&self.materials);
        let above = |&wedge: &usize| self.owners[wedge] >= header.base_vertices as usize;
        tables.targets = (0..self.owners.len()).filter(above).map(|w| (w, self.targets[w])).collect();
        if plan.has.normals {
            tables.normals = self.normals.iter().map(|&code| plan.direction(code)).collect();
        }
        if plan.has.uvs {
            let uv = |&[u, v]: &[i64; 2]| {
                let [u, v, _] = plan.lattice.position([u, v, 0]);
                [u, v]
            };
            tables.uvs = self.uvs.iter().map(uv).collect();
        }
        if plan.has.colours {
            tables.colours = self.colours.iter().map(|colour| colour.map(|x| x as u8)).collect();
        }
    }
}

/// PMESH-COD-15: the weights of neighbours in these cells.
fn weights(around: &[Cell], here: Cell, n: [i64; 3]) -> Vec<i64> {
    let k = around.len() as i64;
    let mean = [0, 1, 2].map(|axis| {
        let sum: i64 = around.iter().map(|cell| cell[axis]).sum();
        (2 * sum + k).div_euclid(2 * k)
    });
    let main = (0..3).fold(0, |best, axis| if n[axis].abs() > n[best].abs() { axis } else { best });
    let axes = [(main + 1) % 3, (main + 2) % 3];
    let flat = |cell: &Cell| axes.map(|axis| cell[axis] - mean[axis]);
    let greatest = around.iter().chain([&here]).flat_map(flat).map(i64::abs).max().unwrap_or(0);
    let shift = bits(greatest).saturating_sub(8);
    let places: Vec<[i64; 2]> = around.iter().map(|cell| flat(cell).map(|x| x >> shift)).collect();
    let [x0, y0] = flat(&here).map(|x| x >> shift);
    let sum = |f: &dyn Fn([i64; 2]) -> i64| places.iter().map(|&place| f(place)).sum::<i64>();
    let (a, b, c) = (sum(&|[x, _]| x * x), sum(&|[x, y]| x * y), sum(&|[_, y]| y * y));
    let d = a * c - b * b;
    if d == 0 {
        return vec![0; around.len()];
    }
    let weight = |[x, y]: [i64; 2]| (1024 * (x * (c * x0 - b * y0) + y * (a * y0 - b * x0))).div_euclid(d);
    let weights: Vec<i64> = places.into_iter().map(weight).collect();
    if weights.iter().map(|h| h.abs()).sum::<i64>() > 2048 { vec![0; around.len()] } else { weights }
}

/// PMESH-COD-15: the numbers expected from those of the neighbours.
fn expected<const N: usize>(weights: &[i64], numbers: &[[i64; N]]) -> [i64; N] {
    let k = numbers.len() as i64;
    std::array::from_fn(|n| {
        let m = (2 * numbers.iter().map(|z| z[n]).sum::<i64>() + k).div_euclid(2 * k);
        let more: i64 = weights.iter().zip(numbers).map(|(h, z)| h * (z[n] - m)).sum();
        m + (more + 512).div_euclid(1024)
    })
}

impl Plan {
    fn new(header: &Header) -> Self {
        let [low, high] = header.uv_bounds.map(|[u, v]| [u, v, 0.0]);
        Self {
            has: header.attributes,
            most: (1 << header.normal_bits >> 1) - 1,
            lattice: Lattice::new([low, high], header.uv_bits.max(1)),
        }
    }

    /// The normal of a code.
    fn direction(&self, code: [i64; 2]) -> [f32; 3] {
        let point = self.point(code).map(|x| x as f64);
        let root = point.iter().map(|x| x * x).sum::<f64>().sqrt();
        point.map(|x| (x / root) as f32)
    }

    fn turned(&self, [u, v]: [i64; 2]) -> [i64; 2] {
        let s = |t: i64| if t < 0 { -1 } else { 1 };
        [s(u) * (self.most - v.abs()), s(v) * (self.most - u.abs())]
    }

    fn point(&self, code: [i64; 2]) -> [i64; 3] {
        let z = self.most - code[0].abs() - code[1].abs();
        let [x, y] = if z < 0 { self.turned(code) } else { code };
        [x, y, z]
    }

    fn projected(&self, [x, y, z]: [i64; 3]) -> Option<[i64; 2]> {
        let s = x.abs() + y.abs() + z.abs();
        if s == 0 {
            return None;
        }
        let code = [x, y].map(|c| (2 * c * self.most + s).div_euclid(2 * s));
        Some(if z < 0 { self.turned(code) } else { code })
    }

    fn normal(&self, code: [i64; 2]) -> Result<[i64; 2], Fault> {
        if code.iter().any(|x| x.abs() > self.most) { fault(ATTRIBUTE) } else { Ok(code) }
    }

    fn uv(&self, point: [i64; 2]) -> Result<[i64; 2], Fault> {
        let inside = (0..2).all(|k| (0..=self.lattice.most[k]).contains(&point[k]));
        let [u, v] = point;
        let finite = inside && self.lattice.position([u, v, 0]).iter().all(|x| x.is_finite());
        if finite { Ok(point) } else { fault(ATTRIBUTE) }
    }
}
