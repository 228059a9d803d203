//! What the bytes of a .pmesh file are spent on.

use pmesh_format::{Decoder, Event, Limits, Mode};

use ivg_wire::{Error, Step};

/// Bytes by kind, without kinds that the file does not have; together they are the file.
pub(crate) type Breakdown = Vec<(&'static str, u64)>;

/// Takes apart a whole file, which is valid.
///
/// # Errors
///
/// What is wrong with the file.
pub(crate) fn of(file: &[u8]) -> Result<Breakdown, Error> {
    let mut sums: Breakdown = Vec::new();
    let mut add = |kind, bytes: usize| {
        if bytes == 0 {
            return;
        }
        match sums.iter_mut().find(|(other, _)| *other == kind) {
            Some((_, sum)) => *sum += bytes as u64,
            None => sums.push((kind, bytes as u64)),
        }
    };
    let mut decoder = Decoder::new(Limits::default());
    let mut rest = file;
    while let Step::Consumed(used, event) = decoder.push(rest)? {
        match event {
            Event::Header(header) => {
                let length = header.header_bytes as usize;
                add("header", length);
                add("directory", used - length);
            }
            Event::Packet(packet) => {
                let payload = packet.payload().len();
                if packet.header().mode == Mode::Raw {
                    let arrays = [
                        ("positions", packet.position_bytes()),
                        ("normals", packet.normal_bytes()),
                        ("texture coordinates", packet.uv_bytes()),
                        ("colours", packet.colour_bytes()),
                        ("corners of faces", packet.corner_bytes()),
                        ("parents", packet.parent_bytes()),
                        ("materials of faces", packet.material_bytes()),
                    ];
                    let all: usize = arrays.iter().map(|(_, bytes)| bytes.len()).sum();
                    arrays.into_iter().for_each(|(kind, bytes)| add(kind, bytes.len()));
                    add("wedges and switches", payload - all);
                } else {
                    add("coded packets", payload);
                }
                add("envelopes and checksums", used - payload);
            }
            Event::End => add("envelopes and checksums", used),
            _ => add("other chunks", used),
        }
        rest = &rest[used..];
    }
    Ok(sums)
}
