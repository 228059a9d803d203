//! A small accumulator file, and its parts.

use glam::{DAffine3, DVec3, Vec3};
use ivg_bake::{Accumulator, BakeOptions, Shard, Silent, accumulate};
use ivg_format::Quantity;
use ivg_scene::{
    Effect, EffectPlan, FlatScene, Light, LightKind, Material, Mesh, Need, Node, PlannedEffect, Scene,
};
use ivg_wire::{ContentId, RECORD_OVERHEAD, record_len, seal_header, write_end, write_record};

/// A floor under two lamps.
pub(crate) fn scene() -> (Scene, FlatScene) {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::new(1.0, 0.0, 1.0)],
        triangles: vec![[0, 1, 2], [2, 1, 3]],
        triangle_materials: vec![0; 2],
        ..Mesh::default()
    };
    let lamp = |name: &str, x| Light {
        name: name.into(),
        kind: LightKind::Point { position: DVec3::new(x, 0.5, 0.5), intensity: Vec3::ONE },
    };
    let scene = Scene {
        meshes: vec![mesh],
        nodes: vec![Node { name: "floor".into(), mesh: 0, transform: DAffine3::IDENTITY }],
        materials: vec![Material::default()],
        lights: vec![lamp("left", 0.2), lamp("right", 0.8)],
        ..Scene::default()
    };
    let flat = scene.flatten();
    (scene, flat)
}

/// The file of a bake of 2 × 2 × 1 vertices.
pub(crate) fn file(quantity: Quantity) -> Vec<u8> {
    let (scene, flat) = scene();
    let diffuse = PlannedEffect {
        effect: Effect::DiffuseIndirect,
        need: Need::Needed,
        reason: String::new(),
        cost: None,
    };
    let plan = EffectPlan { effects: vec![diffuse], max_bounces: 3, energy_cutoff: 0.01 };
    let options = BakeOptions {
        dims: [2, 2, 1],
        bounds: Some((DVec3::new(0.1, 0.1, 0.4), DVec3::new(0.9, 0.9, 0.6))),
        photons: 3000,
        quantity,
        threads: Some(1),
        ..BakeOptions::default()
    };
    let sums: Accumulator =
        accumulate(&scene, &flat, &plan, &options, (Shard::ALL, None), &Silent, &mut |_| {}).unwrap();
    sums.to_bytes()
}

/// A file taken apart: the header, and the payload of each record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parts {
    pub(crate) header: Vec<u8>,
    pub(crate) records: Vec<Vec<u8>>,
}

/// Bytes of the whole header.
pub(crate) const HEADER: usize = 216;

fn number<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    bytes[at..at + N].try_into().unwrap()
}

impl Parts {
    /// Of a sound file of four vertices that fits into one record of sums.
    pub(crate) fn of(file: &[u8]) -> Self {
        let quantity = u32::from_le_bytes(number(file, 108));
        let lights = u64::from_le_bytes(number(file, HEADER + 8));
        let sums = if quantity == 0 { 72 } else { 27 };
        let mut at = HEADER;
        let mut records = Vec::new();
        for payload in [8, lights, 1224, 4 * 14, 4 * sums * 8] {
            records.push(file[at + 8..at + 8 + payload as usize].to_vec());
            at += record_len(payload).unwrap() as usize;
        }
        assert_eq!(at as u64 + RECORD_OVERHEAD + 8, file.len() as u64, "the end record is left");
        Self { header: file[..HEADER].to_vec(), records }
    }

    /// The file, with lengths and checksums that fit.
    pub(crate) fn file(&self) -> Vec<u8> {
        let content = ContentId(u64::from_le_bytes(number(&self.header, 32)));
        let mut out = self.header.clone();
        for (id, payload) in (0..).zip(&self.records) {
            write_record(&mut out, id, 0, payload, content);
        }
        let bytes = out.len() as u64 + RECORD_OVERHEAD + 8;
        write_end(&mut out, bytes, content);
        out[48..56].copy_from_slice(&bytes.to_le_bytes());
        let mut header = out[..HEADER].to_vec();
        seal_header(&mut header);
        out[..HEADER].copy_from_slice(&header);
        out
    }

    /// With bytes of the header changed.
    pub(crate) fn with_header(mut self, at: usize, bytes: &[u8]) -> Self {
        self.header[at..at + bytes.len()].copy_from_slice(bytes);
        self
    }

    /// With bytes of a record changed.
    pub(crate) fn with_record(mut self, id: usize, at: usize, bytes: &[u8]) -> Self {
        self.records[id][at..at + bytes.len()].copy_from_slice(bytes);
        self
    }
}
