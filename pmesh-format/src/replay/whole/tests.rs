use crate::encode::{EncodeOptions, encode};
use crate::tests::{header_of, replay_all, some_meshes};

#[test]
fn what_is_written_again_is_the_same_file() {
    for mesh in some_meshes() {
        let options = EncodeOptions::fixed(4);
        let file = encode(&mesh, &options).unwrap();
        let mut replay = replay_all(&file);
        let again = replay.progressive_mesh().unwrap();
        assert_eq!(replay.level(), mesh.positions.len() as u32);
        // A file has one error a packet, so that the directory is the same.
        assert_eq!(encode(&again, &options).unwrap(), file);
        let Some(levels) = replay.levels() else { continue };
        replay.set_level(*levels.start()).unwrap();
        assert_eq!(replay.progressive_mesh(), Some(again));
        assert_eq!(replay.level(), *levels.start());
        assert_eq!(
            super::Replay::new(&header_of(&file)).progressive_mesh().is_some(),
            mesh.positions.is_empty()
        );
    }
}
