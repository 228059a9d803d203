use glam::*;
use ivg_scene::*;
use crate::stage::*;
use crate::sampling::rng::*;
use crate::sampling::hemisphere;
#[test]
fn dbg() {
    let mut mesh = Mesh::default();
    let mut add = |low: [f32; 3], high: [f32; 3], materials: [u32; 6]| {
        let (low, high) = (Vec3::from(low), Vec3::from(high));
        for (face, material) in materials.into_iter().enumerate() {
            let (axis, side) = (face / 2, face % 2);
            let (mut u, mut v) = (Vec3::ZERO, Vec3::ZERO);
            u[(axis + 1) % 3] = (high - low)[(axis + 1) % 3];
            v[(axis + 2) % 3] = (high - low)[(axis + 2) % 3];
            let mut corner = low;
            corner[axis] = if side == 0 { low[axis] } else { high[axis] };
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([corner, corner + u, corner + u + v, corner + v]);
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            mesh.triangle_materials.extend([material; 2]);
        }
    };
    add([0.0; 3], [2.0; 3], [0; 6]);
    add([0.3, 0.0, 0.4], [0.9, 1.2, 1.0], [0; 6]);
    add([0.7, 1.95, 0.7], [1.3, 1.95, 1.3], [1; 6]);
    let scene = Scene { meshes: vec![mesh], nodes: vec![Node { name: "box".into(), mesh: 0, transform: glam::DAffine3::IDENTITY }],
        materials: vec![Material::default(), Material { emission: Vec3::ONE, two_sided: false, ..Material::default() }], ..Scene::default() };
    let flat = scene.flatten();
    let stage = Stage::new(&scene, &flat, Effects { textures: false, sky: false }, None).unwrap();
    for path in 0..20000 {
        let stream = Stream::new(3, path);
        let mut origin = stage.space.to_bake(DVec3::new(0.6, 0.6, 0.7));
        let u = stream.uniforms(0, Purpose::Gather);
        let mut d = hemisphere::sphere([u[0], u[1]]);
        for bounce in 1..20 {
            let Some(hit) = stage.accel.closest_hit(origin, d, f32::MAX) else { panic!("escaped") };
            let point = stage.surfaces.point(hit.triangle, hit.weights);
            if path == 3 { println!("{bounce} {hit:?} o {origin} d {d} n {}", point.normal); }
            let w = stage.space.to_world(point.position);
            let inside = w.x > 0.2999 && w.x < 0.9001 && w.y < 1.2001 && w.z > 0.3999 && w.z < 1.0001;
            assert!(inside, "path {path} bounce {bounce} {hit:?} {w} from {} {d}", stage.space.to_world(origin));
            let side = point.facing(-d);
            origin = point.origin(side);
            let u = stream.uniforms(bounce, Purpose::Reflection);
            d = hemisphere::cosine(side, [u[0], u[1]]);
        }
    }
}
