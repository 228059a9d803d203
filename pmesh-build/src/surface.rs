//! The mesh while it is being collapsed: faces, which faces stand around a vertex, and the edges of a vertex.

use glam::DVec3;
use pmesh_format::IndexedMesh;

use crate::input::index;

/// Up to this many faces around a vertex are gone through one by one, which costs less than looking elsewhere.
pub(crate) const FEW_FACES: usize = 16;

/// A triangle mesh that loses vertices one by one.
#[derive(Debug)]
pub(crate) struct Surface {
    /// Positions about the centre of the bounding box \[m\].
    pub(crate) positions: Vec<DVec3>,
    /// Vertices of each face; meaningless once the face is gone.
    pub(crate) faces: Vec<[u32; 3]>,
    /// Wedges of each face, corner by corner.
    pub(crate) corners: Vec<[u32; 3]>,
    /// Material of each face.
    pub(crate) materials: Vec<u16>,
    /// Faces around each vertex.
    pub(crate) around: Incidence,
    /// Faces that are still there.
    pub(crate) face_count: usize,
    /// Whether any edge can be a seam: a vertex has two wedges, or two faces differ in material.
    seams: bool,
}

impl Surface {
    /// Takes over a cleaned mesh; `positions` are its positions about its centre. Faces get an order of their own, by their
    /// first vertex: those around a vertex then lie together.
    pub(crate) fn new(mesh: &IndexedMesh, positions: Vec<DVec3>) -> Self {
        let mut order: Vec<(u32, u32)> = (0..index(mesh.triangles.len()))
            .map(|i| {
                let [a, b, c] = mesh.triangle_vertices(i as usize);
                (a.min(b).min(c), i)
            })
            .collect();
        order.sort_unstable();
        let order = || order.iter().map(|&(_, i)| i as usize);
        let faces: Vec<[u32; 3]> = order().map(|i| mesh.triangle_vertices(i)).collect();
        let materials: Vec<u16> = order().map(|i| mesh.material(i)).collect();
        Self {
            around: Incidence::new(positions.len(), &faces),
            seams: mesh.wedges.len() > positions.len() || materials.iter().any(|&m| m != materials[0]),
            positions,
            corners: order().map(|i| mesh.triangles[i]).collect(),
            materials,
            face_count: faces.len(),
            faces,
        }
    }

    /// The faces around vertex `v`.
    pub(crate) fn around(&self, v: u32) -> &[u32] {
        self.around.of(v)
    }

    /// Fills `neighbours` with the vertices that share an edge with `v`, each once.
    pub(crate) fn neighbours(&self, v: u32, neighbours: &mut Vec<u32>) {
        neighbours.clear();
        let around = self.around(v);
        for &f in around {
            for x in self.faces[f as usize] {
                if x != v && (around.len() > FEW_FACES || !neighbours.contains(&x)) {
                    neighbours.push(x);
                }
            }
        }
        if around.len() > FEW_FACES {
            neighbours.sort_unstable();
            neighbours.dedup();
        }
    }

    /// Whether `u` is a vertex of a component that is a tetrahedron.
    pub(crate) fn is_tetrahedron(&self, u: u32) -> bool {
        let around = self.around(u);
        around.len() == 3
            && around.iter().flat_map(|&f| self.faces[f as usize]).all(|x| {
                let faces = self.around(x);
                faces.len() == 3 && faces.iter().filter(|f| around.contains(f)).count() >= 2
            })
    }

    /// If the component of `v` is two faces on the same three vertices, and not all that there is: one of the others.
    pub(crate) fn lone_pair(&self, v: u32) -> Option<u32> {
        let &[f, g] = self.around(v) else { return None };
        let (f, g) = (self.faces[f as usize], self.faces[g as usize]);
        let alone = f.iter().all(|x| g.contains(x) && self.around(*x).len() == 2);
        let other = f.into_iter().filter(|&x| x != v).min();
        other.filter(|_| alone && self.face_count > 2)
    }

    /// Positions of the vertices of face `f`.
    pub(crate) fn triangle(&self, f: u32) -> [DVec3; 3] {
        self.faces[f as usize].map(|v| self.positions[v as usize])
    }

    /// Moves every corner of `u` to `v`. Faces that have both are removed and appended to `removed` with their corners
    /// as they were; `target` gives the wedge of `v` for a wedge of `u`.
    pub(crate) fn collapse(&mut self, u: u32, v: u32, target: impl Fn(u32) -> u32) {
        let mut moved = Vec::new();
        for i in 0..self.around.of(u).len() {
            let f = self.around.of(u)[i];
            let face = self.faces[f as usize];
            if face.contains(&v) {
                self.face_count -= 1;
                for x in face.into_iter().filter(|&x| x != u) {
                    self.around.remove(x, f);
                }
            } else {
                let corners = &mut self.corners[f as usize];
                for (vertex, wedge) in self.faces[f as usize].iter_mut().zip(corners) {
                    if *vertex == u {
                        *vertex = v;
                        *wedge = target(*wedge);
                    }
                }
                moved.push(f);
            }
        }
        self.around.clear(u);
        self.around.append(v, &moved);
    }
}

/// Faces around each vertex: lists in one pool, each with room to grow.
#[derive(Debug)]
pub(crate) struct Incidence {
    lists: Vec<List>,
    pool: Vec<u32>,
}

#[derive(Debug, Clone, Copy, Default)]
struct List {
    start: usize,
    len: u32,
    room: u32,
}

impl Incidence {
    fn new(vertices: usize, faces: &[[u32; 3]]) -> Self {
        let mut lists = vec![List::default(); vertices];
        for v in faces.iter().flatten() {
            lists[*v as usize].room += 1;
        }
        let mut start = 0;
        for list in &mut lists {
            list.start = start;
            start += list.room as usize;
        }
        let mut pool = vec![0; start];
        for (f, face) in (0u32..).zip(faces) {
            for v in face {
                let list = &mut lists[*v as usize];
                pool[list.start + list.len as usize] = f;
                list.len += 1;
            }
        }
        Self { lists, pool }
    }

    fn of(&self, v: u32) -> &[u32] {
        let list = self.lists[v as usize];
        &self.pool[list.start..list.start + list.len as usize]
    }

    /// Removes `face` from the list of `v`; the others keep their order.
    fn remove(&mut self, v: u32, face: u32) {
        let list = &mut self.lists[v as usize];
        let faces = &mut self.pool[list.start..list.start + list.len as usize];
        if let Some(at) = faces.iter().position(|&f| f == face) {
            faces.copy_within(at + 1.., at);
            list.len -= 1;
        }
    }

    fn clear(&mut self, v: u32) {
        self.lists[v as usize].len = 0;
    }

    /// Appends `faces` to the list of `v`, moving it to the end of the pool when it outgrows its room.
    fn append(&mut self, v: u32, faces: &[u32]) {
        let list = self.lists[v as usize];
        let len = list.len as usize + faces.len();
        let mut start = list.start;
        if len > list.room as usize {
            // Twice the room each time, so that a list of k faces is moved O(log k) times.
            start = self.pool.len();
            self.pool.extend_from_within(list.start..list.start + list.len as usize);
            self.pool.resize(start + 2 * len, 0);
            self.lists[v as usize].room = index(2 * len);
        }
        self.pool[start + list.len as usize..start + len].copy_from_slice(faces);
        self.lists[v as usize].start = start;
        self.lists[v as usize].len = index(len);
    }
}

/// An edge as seen from one of its vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Edge {
    /// The vertex at the other end.
    pub(crate) to: u32,
    /// How many faces have it.
    pub(crate) faces: u32,
    /// Whether two of its faces differ in a wedge at one of its ends, or in material.
    pub(crate) seam: bool,
    wedges: [u32; 2],
    material: u16,
}

impl Edge {
    /// Whether the surface is anything but one smooth sheet here.
    pub(crate) fn is_feature(&self) -> bool {
        self.faces != 2 || self.seam
    }
}

/// The edges of one vertex, with constant-time look-up by their other end. Reused for one vertex after another.
#[derive(Debug, Default)]
pub(crate) struct Ring {
    /// The edges, in the order in which the faces around the vertex name them.
    pub(crate) edges: Vec<Edge>,
    /// For each vertex of the mesh: the pass in which it was last seen, and where in `edges`.
    marks: Vec<(u32, u32)>,
    pass: u32,
    /// Whether the marks were set in this pass: few edges are gone through without them.
    marked: bool,
}

impl Ring {
    /// For a mesh with that many vertices.
    pub(crate) fn new(vertices: usize) -> Self {
        Self { edges: Vec::new(), marks: vec![(0, 0); vertices], pass: 0, marked: false }
    }

    /// Collects the edges of `v`.
    pub(crate) fn collect(&mut self, surface: &Surface, v: u32) {
        self.edges.clear();
        let around = surface.around(v);
        self.marked = around.len() > FEW_FACES;
        if self.marked {
            self.pass = self.pass.wrapping_add(1);
            if self.pass == 0 {
                self.marks.fill((0, 0));
                self.pass = 1;
            }
        }
        for &f in around {
            let face = surface.faces[f as usize];
            // Without seams there is no need to fetch what may differ at one.
            let (corners, material) = if surface.seams {
                (surface.corners[f as usize], surface.materials[f as usize])
            } else {
                (face, 0)
            };
            let at = if face[0] == v {
                0
            } else if face[1] == v {
                1
            } else {
                2
            };
            for k in [(at + 1) % 3, (at + 2) % 3] {
                let to = face[k];
                let wedges = [corners[at], corners[k]];
                if let Some(at) = self.place(to) {
                    let edge = &mut self.edges[at];
                    edge.faces += 1;
                    edge.seam |= edge.wedges != wedges || edge.material != material;
                } else {
                    if self.marked {
                        self.marks[to as usize] = (self.pass, index(self.edges.len()));
                    }
                    self.edges.push(Edge { to, faces: 1, seam: false, wedges, material });
                }
            }
        }
    }

    /// The edge to `to`, if there is one.
    pub(crate) fn edge(&self, to: u32) -> Option<&Edge> {
        self.place(to).map(|at| &self.edges[at])
    }

    fn place(&self, to: u32) -> Option<usize> {
        if !self.marked {
            return self.edges.iter().position(|edge| edge.to == to);
        }
        let (pass, at) = self.marks[to as usize];
        (pass == self.pass).then_some(at as usize)
    }
}
