use super::*;
use crate::reference::Reference;
use ivg_wire::splitmix64;
use pmesh_format::{Header, Limits, Step, check_level, decode_packet};

/// Code of PMESH-SWI-07.
const SWITCH_WORK: u16 = 520;

#[test]
fn invented_packets_break_no_rule() {
    let (mut levels, mut worked) = (0, 0);
    for seed in 0..200 {
        let data: Vec<u8> = (0..200).flat_map(|n| splitmix64(seed, n).to_le_bytes()).collect();
        let file = invented(&mut Choices::new(&data));
        let Ok(Step::Consumed(_, header)) = Header::read(&file, &Limits::default()) else {
            panic!("{seed}: the header is refused")
        };
        let mut reference = Reference::new(&header);
        for k in 0..header.packet_count() {
            let range = header.packet_range(k);
            let packet = decode_packet(&header, k, &file[range.start as usize..range.end as usize]);
            match reference.take(packet.unwrap().payload()) {
                Ok(()) => {}
                Err(fault) if fault.code == SWITCH_WORK => worked += 1,
                Err(fault) => panic!("{seed}: {fault:?} in packet {k}"),
            }
        }
        for level in reference.levels() {
            check_level(&reference.level(level).unwrap()).unwrap();
            levels += 1;
        }
    }
    assert!(levels > 2000 && worked < 20, "{levels} levels, {worked} packets with too much work");
}
