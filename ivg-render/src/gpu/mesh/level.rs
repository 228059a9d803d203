//! What a change of level writes: pure functions without wgpu.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::{Affine3A, DAffine3, DVec3, Mat3A, Vec3};
use pmesh_format::{Header, LevelChange, Replay};

use crate::RenderError;
use crate::scene::{area_weighted_normals, normal_matrix, placed};

/// Faces or wedges between two runs of changed ones that are written with them: a write of its own costs more than these
/// few bytes.
const GAP: u32 = 16;

/// An array on the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Array {
    /// Three f32 a wedge, in scene space \[m\].
    Positions,
    /// Three f32 a wedge, unit length or zero.
    Normals,
    /// Two f32 a wedge.
    Uvs,
    /// Three u32 a face: wedges.
    Corners,
    /// A u32 a face: the scene's material.
    Materials,
}

/// Bytes for an array.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Write {
    pub(super) array: Array,
    /// Where they go \[bytes\].
    pub(super) offset: u64,
    pub(super) bytes: Vec<u8>,
}

/// A draw of all faces of one material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Draw {
    /// Index into the scene's materials.
    pub(super) material: u32,
    /// 0 for every face, else the material plus one: faces of others are left out.
    pub(super) instance: u32,
}

/// What is on the device of a mesh.
#[derive(Debug, Clone)]
pub(super) struct Resident {
    /// The content id of the file.
    content: u64,
    origin: DVec3,
    transform: Affine3A,
    normal_matrix: Mat3A,
    /// Whether the transform turns fronts into backs, so that corners are written in the other order.
    mirrored: bool,
    bounds: (Vec3, Vec3),
    /// The scene's material for each of the file.
    materials: Vec<u32>,
    /// The scene's materials of all faces that are there.
    used: BTreeSet<u32>,
    level: u32,
    /// Wedges whose position and attributes are there.
    wedges: u32,
    /// Faces of the level.
    faces: u32,
    /// Faces whose material is there.
    face_materials: u32,
    /// The normals that are there, in mesh space, where the file has none.
    normals: Vec<Vec3>,
}

impl Resident {
    /// Nothing yet of the file with this header.
    pub(super) fn new(
        header: &Header,
        materials: &[u32],
        transform: &DAffine3,
        origin: DVec3,
    ) -> Result<Self, RenderError> {
        let transform = placed(transform, DVec3::from(header.origin), origin);
        if !transform.is_finite() {
            return Err(RenderError::NotFinite { what: "the place of a progressive mesh".into() });
        }
        let mirrored = transform.matrix3.determinant() < 0.0;
        let [low, high] = header.bounds.map(Vec3::from);
        let corner = |k: u32| {
            let pick = Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2 & 1) as f32);
            // Each coordinate is that of one corner, without rounding.
            transform.transform_point3(Vec3::select(pick.cmpgt(Vec3::ZERO), high, low))
        };
        let bounds = (1..8).map(corner).fold((corner(0), corner(0)), |(a, b), p| (a.min(p), b.max(p)));
        Ok(Self {
            content: header.content_id.0,
            origin,
            transform,
            normal_matrix: normal_matrix(&transform) * if mirrored { -1.0 } else { 1.0 },
            mirrored,
            bounds,
            materials: materials.to_vec(),
            used: BTreeSet::new(),
            level: 0,
            wedges: 0,
            faces: 0,
            face_materials: 0,
            normals: Vec::new(),
        })
    }

    pub(super) fn level(&self) -> u32 {
        self.level
    }

    pub(super) fn faces(&self) -> u32 {
        self.faces
    }

    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// Nothing is there any more, as far as is known.
    pub(super) fn forget(&mut self) {
        (self.level, self.wedges, self.faces, self.face_materials) = (0, 0, 0, 0);
        self.normals.clear();
    }

    /// Goes to the level of `replay`; what must be written for it. See [`GpuMesh::upload`](super::GpuMesh::upload).
    pub(super) fn advance(
        &mut self,
        replay: &Replay,
        change: &LevelChange,
    ) -> Result<Vec<Write>, RenderError> {
        if replay.header().content_id.0 != self.content {
            return Err(RenderError::Progressive { problem: "was given the levels of another file" });
        }
        let faces = replay.face_count();
        let known = self.level > 0 && change.from == self.level && change.to == replay.level();
        let all = 0..faces;
        let changed = if known { change.changed.as_slice() } else { std::slice::from_ref(&all) };
        let mut writes = Vec::new();
        self.append_wedges(replay, &mut writes);
        self.renew_normals(replay, &mut writes);
        for range in joined(changed.iter().cloned(), GAP) {
            let corners = &replay.indices()[range.start as usize..range.end as usize];
            let turned = |&[a, b, c]: &[u32; 3]| if self.mirrored { [a, c, b] } else { [a, b, c] };
            let corners: Vec<[u32; 3]> = corners.iter().map(turned).collect();
            push(&mut writes, Array::Corners, range.start, &corners);
        }
        self.append_materials(replay, &mut writes)?;
        (self.level, self.faces) = (replay.level(), faces);
        Ok(writes)
    }

    /// Positions, texture coordinates and the file's own normals of the wedges that are not there.
    fn append_wedges(&mut self, replay: &Replay, writes: &mut Vec<Write>) {
        let new = self.wedges..replay.wedge_count();
        if new.is_empty() {
            return;
        }
        let part = new.start as usize..new.end as usize;
        let position = |wedge: u32| {
            let position = replay.positions()[replay.wedge_vertex(wedge) as usize];
            self.transform.transform_point3(position.into()).to_array()
        };
        push(writes, Array::Positions, new.start, &new.clone().map(position).collect::<Vec<_>>());
        if !replay.uvs().is_empty() {
            push(writes, Array::Uvs, new.start, &replay.uvs()[part.clone()]);
        }
        if !replay.normals().is_empty() {
            let normals = replay.normals()[part].iter().map(|&normal| self.placed_normal(normal.into()));
            push(writes, Array::Normals, new.start, &normals.collect::<Vec<_>>());
        }
        self.wedges = new.end;
    }

    /// Normals of the level where the file has none: those that are others than before.
    fn renew_normals(&mut self, replay: &Replay, writes: &mut Vec<Write>) {
        if !replay.normals().is_empty() {
            return;
        }
        let vertex_of = |wedge: u32| replay.wedge_vertex(wedge);
        let triangles: Vec<[u32; 3]> = replay.indices().iter().map(|t| t.map(vertex_of)).collect();
        let positions: Vec<Vec3> = replay.positions().iter().copied().map(Vec3::from).collect();
        let of_vertices = area_weighted_normals(&positions, &triangles);
        let of_wedge = |wedge: u32| of_vertices[vertex_of(wedge) as usize];
        let is_other = |wedge: &u32| self.normals.get(*wedge as usize) != Some(&of_wedge(*wedge));
        let others = (0..replay.wedge_count()).filter(is_other).map(|wedge| wedge..wedge + 1);
        for range in joined(others, GAP) {
            let new: Vec<Vec3> = range.clone().map(of_wedge).collect();
            let bytes: Vec<[f32; 3]> = new.iter().map(|&normal| self.placed_normal(normal)).collect();
            push(writes, Array::Normals, range.start, &bytes);
            let end = self.normals.len().max(range.end as usize);
            self.normals.resize(end, Vec3::ZERO);
            self.normals[range.start as usize..range.end as usize].copy_from_slice(&new);
        }
    }

    /// Materials of the faces that are not there; a file whose faces all have the first one has none.
    fn append_materials(&mut self, replay: &Replay, writes: &mut Vec<Write>) -> Result<(), RenderError> {
        let unknown = RenderError::Progressive { problem: "names a material that the scene does not have" };
        let of_scene = |number: u16| self.materials.get(usize::from(number)).copied();
        if replay.face_materials().is_empty() {
            self.used.extend((replay.face_count() > 0).then(|| of_scene(0).ok_or(unknown)).transpose()?);
            return Ok(());
        }
        let first = self.face_materials;
        let new = replay.face_materials().get(first as usize..).unwrap_or_default();
        let materials: Option<Vec<u32>> = new.iter().map(|&number| of_scene(number)).collect();
        let materials = materials.ok_or(unknown)?;
        self.used.extend(&materials);
        self.face_materials += materials.len() as u32;
        push(writes, Array::Materials, first, &materials);
        Ok(())
    }

    fn placed_normal(&self, normal: Vec3) -> [f32; 3] {
        (self.normal_matrix * normal).normalize_or_zero().to_array()
    }

    /// What is drawn: all faces at once where they have one material, else all of them for each material.
    pub(super) fn draws(&self) -> Vec<Draw> {
        let several = self.used.len() > 1;
        let draw = |&material: &u32| Draw { material, instance: if several { material + 1 } else { 0 } };
        self.used.iter().map(draw).collect()
    }

    /// See [`GpuMesh::check`](super::GpuMesh::check).
    pub(super) fn check(&self, origin: DVec3, emissive: &[bool]) -> Result<(), RenderError> {
        if origin != self.origin {
            return Err(RenderError::Progressive { problem: "was placed for another origin of the scene" });
        }
        for &material in &self.used {
            let problem = match emissive.get(material as usize) {
                None => "names a material that the scene does not have",
                Some(true) => "has a material that emits light; area lights are meshes of the scene",
                Some(false) => continue,
            };
            return Err(RenderError::Progressive { problem });
        }
        Ok(())
    }
}

fn push<T: bytemuck::Pod>(writes: &mut Vec<Write>, array: Array, first: u32, values: &[T]) {
    if !values.is_empty() {
        let offset = u64::from(first) * size_of::<T>() as u64;
        writes.push(Write { array, offset, bytes: bytemuck::cast_slice(values).to_vec() });
    }
}

/// Ascending ranges, those with at most `gap` between them as one.
fn joined(ranges: impl Iterator<Item = Range<u32>>, gap: u32) -> Vec<Range<u32>> {
    let mut joined: Vec<Range<u32>> = Vec::new();
    for range in ranges.filter(|range| !range.is_empty()) {
        match joined.last_mut() {
            Some(last) if range.start.saturating_sub(last.end) <= gap => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    joined
}

#[cfg(test)]
mod tests;
