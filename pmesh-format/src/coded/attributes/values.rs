//! What wedges have: predicted from those beside them (PMESH-COD-16).

use super::*;

impl Wedged {
    /// The values of a wedge of the base, as they are.
    pub(super) fn code_first_values<C: Coder>(
        &mut self,
        step: &mut Step<'_, C>,
        wedge: usize,
    ) -> Result<(), Fault> {
        let Attributes { normals, uvs, colours, .. } = self.plan.attributes;
        let fault = (codes::ATTRIBUTE, 0);
        if normals {
            let most = self.plan.octahedral.most();
            let known = step.given.map_or([0; 2], |given| given.normals[wedge]);
            let code = known.map(|x| raw(step.coder, bits(2 * most as u32), (x + most) as u32) as i32 - most);
            if !self.plan.octahedral.contains(code) {
                return Err(fault);
            }
            self.normals.push(code);
        }
        if uvs {
            let top = self.plan.lattice.top();
            let known = step.given.map_or([0; 2], |given| given.uvs[wedge]);
            let point = [0, 1].map(|k| raw(step.coder, bits(top[k]), known[k] as u32));
            self.push_uv(point.map(i64::from))?;
        }
        if colours {
            let known = step.given.map_or([0; 4], |given| given.colours[wedge]);
            self.colours.push(known.map(|x| step.coder.raw(COLOUR_BITS, x.into()) as u8));
        }
        self.classes.push([FIRST_CLASS; 3]);
        Ok(())
    }

    fn push_uv(&mut self, point: [i64; 2]) -> Result<(), Fault> {
        let [u, v, _] = self.plan.lattice.top().map(i64::from);
        let inside = (0..=u).contains(&point[0]) && (0..=v).contains(&point[1]);
        let point = point.map(|x| x as i32);
        if !inside || !self.plan.uv(point).iter().all(|x| x.is_finite()) {
            return Err((codes::ATTRIBUTE, 0));
        }
        self.uvs.push(point);
        Ok(())
    }

    /// The values of the wedges of a vertex, whose faces are there.
    pub(super) fn code_values<C: Coder>(&mut self, step: &mut Step<'_, C>, vertex: u32) -> Result<(), Fault> {
        if !self.plan.attributes.on_wedges() {
            let end = self.vertices.len();
            self.classes.resize(end, [FIRST_CLASS; 3]);
            return Ok(());
        }
        let wedges = self.wedges_of(vertex);
        let mut around = core::mem::take(&mut self.around);
        around.clear();
        let few = if wedges.len() > 1 { usize::MAX } else { MOST / 2 };
        around.extend(self.slots.of(vertex).iter().take(few).map(|&slot| {
            let [a, b, c] = self.corners[(slot / 3) as usize];
            match slot % 3 {
                0 => [a, b, c],
                1 => [b, c, a],
                _ => [c, a, b],
            }
        }));
        if wedges.len() > 1 {
            around.sort_by_key(|&[own, ..]| own);
        }
        let mut left = &around[..];
        let coded = wedges.into_iter().try_for_each(|wedge| {
            let (own, later) = left.split_at(left.partition_point(|face| face[0] == wedge));
            left = later;
            self.code_wedge(step, vertex, wedge as usize, own)
        });
        self.around = around;
        coded
    }

    /// The values of a wedge from what is around it.
    fn code_wedge<C: Coder>(
        &mut self,
        step: &mut Step<'_, C>,
        vertex: u32,
        wedge: usize,
        faces: &[[u32; 3]],
    ) -> Result<(), Fault> {
        let here = step.state.cell(vertex);
        let cell = |wedge: u32| step.state.cell(self.vertices[wedge as usize]);
        let mut neighbours = [0u32; MOST];
        let mut cells = [[0; 3]; MOST];
        let mut known = 0;
        let mut normal = [0i64; 3];
        for &[_, out, back] in faces.iter().take(MOST / 2) {
            let ends = [out, back].map(cell);
            let area = cross(difference(ends[0], here), difference(ends[1], here));
            normal.iter_mut().zip(area).for_each(|(sum, x)| *sum += x);
            neighbours[known..known + 2].copy_from_slice(&[out, back]);
            cells[known..known + 2].copy_from_slice(&ends);
            known += 2;
        }
        let target = self.targets[wedge];
        if known == 0 {
            neighbours[0] = target;
            cells[0] = cell(target);
            known = 1;
        }
        let neighbours = &neighbours[..known];
        let weights = Weights::new(&cells[..known], here, normal);
        let classes: [u32; 3] = core::array::from_fn(|k| {
            neighbours.iter().map(|&w| u32::from(self.classes[w as usize][k])).sum::<u32>() / known as u32
        });
        let mut sizes = [0u64; 3];
        let Attributes { normals, uvs, colours, .. } = self.plan.attributes;
        if normals {
            let map = self.plan.octahedral;
            let point =
                |place: usize| map.point(self.normals[neighbours[place] as usize]).map(|x| x << NORMAL_SHIFT);
            let expected = map.project(weights.expected(point));
            let expected = expected.unwrap_or(self.normals[target as usize]);
            let given = step.given.map_or([0; 2], |given| given.normals[wedge]);
            let below = map.is_below(expected);
            let turn = |code: Code| if below { map.turned(code) } else { code };
            let (from, to) = (turn(expected), turn(given));
            let mut found = from;
            let model = exact(classes[0], alike(neighbours, |w| self.normals[w]));
            if !step.coder.bit(&mut self.models.exact[0][model], from == to) {
                for k in 0..2 {
                    let apart = to[k].wrapping_sub(from[k]);
                    let apart = residual(step.coder, &mut self.models.normals, classes[0], apart);
                    sizes[0] += u64::from(apart.unsigned_abs());
                    found[k] = from[k].wrapping_add(apart);
                }
            }
            if !map.contains(found) {
                return Err((codes::ATTRIBUTE, 0));
            }
            self.normals.push(turn(found));
        }
        if uvs {
            let expected = weights.expected(|place| self.uvs[neighbours[place] as usize]);
            let given = step.given.map_or([0; 2], |given| given.uvs[wedge]);
            let [u, v, _] = self.plan.lattice.top().map(i64::from);
            let mut found = [expected[0].clamp(0, u), expected[1].clamp(0, v)];
            let same = found == given.map(i64::from);
            let model = exact(classes[1], alike(neighbours, |w| self.uvs[w]));
            if !step.coder.bit(&mut self.models.exact[1][model], same) {
                for (found, given) in found.iter_mut().zip(given) {
                    let apart = given.wrapping_sub(*found as i32);
                    let apart = residual(step.coder, &mut self.models.uvs, classes[1], apart);
                    sizes[1] += u64::from(apart.unsigned_abs());
                    *found += i64::from(apart);
                }
            }
            self.push_uv(found)?;
        }
        if colours {
            let expected = weights.expected(|place| self.colours[neighbours[place] as usize].map(i32::from));
            let expected = expected.map(|x| x.clamp(0, 255) as i32);
            let given = step.given.map_or([0; 4], |given| given.colours[wedge]).map(i32::from);
            let mut found = expected.map(i64::from);
            let model = exact(classes[2], alike(neighbours, |w| self.colours[w]));
            if !step.coder.bit(&mut self.models.exact[2][model], given == expected) {
                let [green, others, alpha] = &mut self.models.colours;
                let apart = |k: usize| given[k] - expected[k];
                let g = residual(step.coder, green, classes[2], apart(1));
                let r = residual(step.coder, others, classes[2], apart(0).wrapping_sub(g));
                let b = residual(step.coder, others, classes[2], apart(2).wrapping_sub(g));
                let a = residual(step.coder, alpha, classes[2], apart(3));
                sizes[2] = [g, r, b, a].iter().map(|x| u64::from(x.unsigned_abs())).sum();
                let apart = [r.wrapping_add(g), g, b.wrapping_add(g), a];
                found = core::array::from_fn(|k| found[k] + i64::from(apart[k]));
            }
            if !found.iter().all(|x| (0..=255).contains(x)) {
                return Err((codes::ATTRIBUTE, 0));
            }
            self.colours.push(found.map(|x| x as u8));
        }
        let own = sizes.map(|size| class(size + 1) as u8);
        self.classes.push(own);
        let theirs = self.classes[target as usize];
        step.brought.classes.push((target, theirs));
        self.classes[target as usize] =
            core::array::from_fn(|k| ((u32::from(own[k]) + u32::from(theirs[k])) / 2) as u8);
        Ok(())
    }
}

/// Whether all neighbours have the same value.
fn alike<T: PartialEq>(neighbours: &[u32], value: impl Fn(usize) -> T) -> bool {
    let mut values = neighbours.iter().map(|&wedge| value(wedge as usize));
    let first = values.next();
    values.all(|value| Some(value) == first)
}

/// Which model says whether a value is as expected.
fn exact(class: u32, alike: bool) -> usize {
    2 * (class as usize / 4).min(EXACT / 2 - 1) + usize::from(alike)
}
