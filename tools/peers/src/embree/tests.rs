use super::{RayFile, differ};

fn file() -> Vec<u8> {
    let mut bytes: Vec<u8> = [1u32, 2].into_iter().flat_map(u32::to_le_bytes).collect();
    bytes.extend((0..9 + 12).flat_map(|n| (n as f32).to_le_bytes()));
    for (triangle, distance) in [(0u32, 2.5f32), (u32::MAX, 0.0)] {
        bytes.extend(triangle.to_le_bytes());
        bytes.extend(distance.to_le_bytes());
    }
    bytes
}

#[test]
fn triangles_rays_and_hits_are_read() {
    let read = RayFile::parse(&file()).unwrap();
    assert_eq!(read.triangles, [[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]]);
    assert_eq!(read.rays[1], [15.0, 16.0, 17.0, 18.0, 19.0, 20.0]);
    assert_eq!(read.hits, [Some(2.5), None]);
    let bytes = file();
    assert!(RayFile::parse(&bytes[..bytes.len() - 4]).is_none());
    assert!(RayFile::parse(&bytes[..bytes.len() - 1]).is_none());
    assert!(RayFile::parse(&[]).is_none());
}

#[test]
fn hits_differ_by_more_than_rounding() {
    assert!(!differ(Some(1.0), Some(1.000_05), 1.0) && !differ(None, None, 1.0));
    assert!(differ(Some(1.0), Some(1.001), 1.0) && differ(Some(1.0), None, 1.0));
    assert!(!differ(Some(1.0), Some(1.001), 200.0));
}
