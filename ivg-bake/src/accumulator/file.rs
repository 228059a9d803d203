//! The bytes of an accumulator (`spec/accumulator.md`).

use ivg_format::Quantity;
use ivg_wire::{
    ByteOffset, COMMON_HEADER_BYTES, CommonHeader, ContentId, Cursor, Error, FormatId, Limits, Part, Step,
    read_end, read_record, record_len, seal_header, write_end, write_record,
};

use super::{Accumulator, Head, Shard, Vertex};
use crate::BakedLight;
use crate::accumulate::MAX_FLIGHTS;
use crate::centring::Place;
use crate::estimate::track_length::sums_of;
use crate::region::SUB_CELLS;
use crate::trace::{BOOKED_BOUNCES, Books};

/// ACC-HDR-01: the header.
const FORMAT: FormatId = FormatId {
    magic: [0x89, b'I', b'V', b'A', 0x0d, 0x0a, 0x1a, 0x0a],
    major: 0,
    minor: 1,
    header_bytes: (COMMON_HEADER_BYTES + HEAD_BYTES) as u32,
    features: 0,
};

/// Bytes of the header behind the common one.
const HEAD_BYTES: usize = 160;

/// ACC-SUM-03: numbers of a record of sums.
const SUMS_A_RECORD: usize = 1 << 20;

/// ACC-REC-05: bytes of a vertex in the record of vertices.
const VERTEX_BYTES: u64 = 14;

/// ACC-REC-04: bytes of the books, 76 sums of 16 bytes and the flights.
const BOOK_BYTES: u64 = 16 * (12 + BOOKED_BOUNCES as u64) + 8;

/// ACC-REC-02: largest length of the record of lights.
const MOST_LIGHT_BYTES: u64 = 1 << 24;

/// Why accumulators cannot be read, resumed or added.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AccumulatorError {
    /// The bytes are not an accumulator file, or damaged.
    #[error("not a usable accumulator file: {0}")]
    Bytes(#[from] Error),
    /// A field of the header, or a record, holds what none may hold.
    #[error("the accumulator's {what} is not possible")]
    Field {
        /// Which.
        what: &'static str,
    },
    /// Made by another release, or for another kind of machine.
    #[error("the accumulators were made by different releases, or for different kinds of machines")]
    Release,
    /// A field of the header differs.
    #[error("the accumulators have different {what}: {} and {}", .values[0], .values[1])]
    Differs {
        /// Which.
        what: &'static str,
        /// Both.
        values: Box<[String; 2]>,
    },
    /// Of another scene, lights file or effect plan, which the header holds as one number.
    #[error("the accumulators are of different scenes, lights or effects")]
    Scene,
    /// Of another seed.
    #[error("the accumulators have different seeds: {} and {}", .seeds[0], .seeds[1])]
    Seed {
        /// Both.
        seeds: [u64; 2],
    },
    /// A shard that there is not.
    #[error("there is no shard {index} of {count}; shards are numbered from 1")]
    Shard {
        /// Its number.
        index: u32,
        /// How many there are.
        count: u32,
    },
    /// Divided in another way.
    #[error(
        "the accumulators are of different divisions: {} photons in {} shards and {} photons in {}",
        .photons[0], .counts[0], .photons[1], .counts[1]
    )]
    Division {
        /// Photons of each.
        photons: [u64; 2],
        /// Shards of each.
        counts: [u32; 2],
    },
    /// Sums of another part of the photons than the one to go on with.
    #[error("the accumulator to resume is shard {index} of {count}, another than asked for")]
    OtherShard {
        /// Its number.
        index: u32,
        /// Of how many.
        count: u32,
    },
    /// More photons than asked for, or ended inside a piece of a shard.
    #[error("the accumulator to resume has {traced} photons already, and cannot go on to {photons}")]
    TooFar {
        /// Photons it has.
        traced: u64,
        /// Photons asked for.
        photons: u64,
    },
    /// The same shard twice.
    #[error("shard {index} of {count} is there twice")]
    Twice {
        /// Its number.
        index: u32,
        /// Of how many.
        count: u32,
    },
    /// A shard is not there.
    #[error("shard {index} of {count} is missing")]
    Missing {
        /// Its number.
        index: u32,
        /// Of how many.
        count: u32,
    },
    /// A shard whose photons have not all been traced.
    #[error("shard {index} has {traced} of {photons} photons; resume it first")]
    Incomplete {
        /// Its number.
        index: u32,
        /// Photons below this number have been traced.
        traced: u64,
        /// Photons of the bake.
        photons: u64,
    },
}

impl Accumulator {
    /// The file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let head = self.head.to_bytes();
        let (lights, books) = (light_bytes(&self.lights), book_bytes(&self.books));
        let vertices: Vec<u8> = self.vertices.iter().flat_map(|vertex| vertex.to_bytes()).collect();
        let content = ContentId::of(&[&head, &lights, &books, &vertices]);
        // Sums differ whenever photons do, and those are in the header.
        let header_bytes = FORMAT.header_bytes;
        let mut common = CommonHeader {
            minor: FORMAT.minor,
            required_features: 0,
            optional_features: 0,
            header_bytes,
            content_id: content,
            data_offset: u64::from(header_bytes),
            file_bytes: 0,
        };
        let small = [lights.len(), books.len(), vertices.len()].map(|n| n as u64);
        common.file_bytes = file_bytes(small, self.sums.len() as u64).unwrap_or(u64::MAX);
        let mut out = common.to_bytes(&FORMAT).to_vec();
        out.extend(head);
        seal_header(&mut out);
        let mut id = 0;
        let mut record = |out: &mut Vec<u8>, payload: &[u8]| {
            write_record(out, id, 0, payload, content);
            id += 1;
        };
        record(&mut out, &(lights.len() as u64).to_le_bytes());
        [lights, books, vertices].iter().for_each(|payload| record(&mut out, payload));
        for sums in self.sums.chunks(SUMS_A_RECORD) {
            let bytes: Vec<u8> = sums.iter().flat_map(|sum| sum.to_le_bytes()).collect();
            record(&mut out, &bytes);
        }
        write_end(&mut out, common.file_bytes, content);
        out
    }

    /// Reads a file.
    ///
    /// # Errors
    ///
    /// [`AccumulatorError::Bytes`] says what is wrong at which byte, [`AccumulatorError::Field`] which number is not possible.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, AccumulatorError> {
        let common = whole(CommonHeader::read(bytes, &FORMAT, &Limits::default())?, bytes.len())?;
        let at = common.header_bytes as usize;
        let mut cursor = Cursor::new(
            bytes.get(COMMON_HEADER_BYTES..at).unwrap_or(&[]),
            ByteOffset(COMMON_HEADER_BYTES as u64),
            Part::Header,
        );
        let head = Head::read(&mut cursor)?;
        if common.data_offset != at as u64 {
            return Err(AccumulatorError::Field { what: "data offset" });
        }
        if (bytes.len() as u64) < common.file_bytes {
            return Err(Error::truncated(ByteOffset(bytes.len() as u64), Part::Header).into());
        }
        let mut records = Records { bytes, at, id: 0, content: common.content_id };
        let light_bytes = Cursor::new(records.next(8)?, ByteOffset(at as u64), Part::Record(0)).u64()?;
        if light_bytes > MOST_LIGHT_BYTES {
            return Err(AccumulatorError::Field { what: "list of lights" });
        }
        let vertices: u64 = head.dims.iter().map(|&n| u64::from(n)).product();
        let sums = sums_of(head.quantity, vertices as usize) as u64;
        let implied = file_bytes([light_bytes, BOOK_BYTES, VERTEX_BYTES * vertices], sums);
        common.expect_file_bytes(implied)?;
        let lights = read_lights(records.next(light_bytes)?)?;
        let books = read_books(records.next(BOOK_BYTES)?)?;
        let vertices = read_vertices(records.next(VERTEX_BYTES * vertices)?)?;
        // The file is as long as its length says, so that these fit into memory beside it.
        let mut all = Vec::with_capacity(sums as usize);
        while (all.len() as u64) < sums {
            let count = (sums - all.len() as u64).min(SUMS_A_RECORD as u64);
            let payload = records.next(8 * count)?;
            all.extend(payload.as_chunks::<8>().0.iter().map(|sum| i64::from_le_bytes(*sum)));
        }
        let used = whole(
            read_end(
                bytes.get(records.at..).unwrap_or(&[]),
                ByteOffset(records.at as u64),
                common.file_bytes,
                common.content_id,
            )?,
            bytes.len(),
        );
        used?;
        if bytes.len() as u64 > common.file_bytes {
            let code = ivg_wire::codes::TRAILING_BYTES;
            return Err(Error::new(code, ByteOffset(common.file_bytes), Part::Header).into());
        }
        Ok(Self { head, lights, books, vertices, sums: all })
    }
}

/// What a step read, all of whose bytes must be there.
fn whole<T>(step: Step<T>, there: usize) -> Result<T, AccumulatorError> {
    match step {
        Step::Consumed(_, read) => Ok(read),
        Step::NeedMore(_) => Err(Error::truncated(ByteOffset(there as u64), Part::Header).into()),
    }
}

/// Length of a file with the records before the sums, whose payloads have these lengths; `None` if beyond 64 bits.
fn file_bytes(payloads: [u64; 3], sums: u64) -> Option<u64> {
    let full = sums / SUMS_A_RECORD as u64;
    let rest = sums % SUMS_A_RECORD as u64;
    let mut total = u64::from(FORMAT.header_bytes);
    for payload in [8].into_iter().chain(payloads) {
        total = total.checked_add(record_len(payload)?)?;
    }
    total = total.checked_add(full.checked_mul(record_len(8 * SUMS_A_RECORD as u64)?)?)?;
    if rest > 0 {
        total = total.checked_add(record_len(8 * rest)?)?;
    }
    total.checked_add(record_len(ivg_wire::END_PAYLOAD)?)
}

/// Records one after the other.
struct Records<'a> {
    bytes: &'a [u8],
    at: usize,
    id: u32,
    content: ContentId,
}

impl<'a> Records<'a> {
    fn next(&mut self, payload: u64) -> Result<&'a [u8], AccumulatorError> {
        let rest = self.bytes.get(self.at..).unwrap_or(&[]);
        match read_record(rest, ByteOffset(self.at as u64), self.id, payload, self.content)? {
            Step::Consumed(used, record) => {
                self.at += used;
                self.id += 1;
                Ok(record.payload)
            }
            Step::NeedMore(_) => {
                let end = ByteOffset(self.bytes.len() as u64);
                Err(Error::truncated(end, Part::Record(self.id)).into())
            }
        }
    }
}

impl Head {
    fn to_bytes(self) -> Vec<u8> {
        let mut out = Vec::with_capacity(HEAD_BYTES);
        for number in [self.release, self.scene, self.seed, self.photons, self.traced] {
            out.extend(number.to_le_bytes());
        }
        for number in [self.shard.index, self.shard.count, self.max_bounces] {
            out.extend(number.to_le_bytes());
        }
        out.extend(u32::from(self.quantity == Quantity::Radiance).to_le_bytes());
        self.dims.iter().chain(&[0]).for_each(|n| out.extend(n.to_le_bytes()));
        let scales = [self.power, self.per_area, self.quantum, self.volume];
        for number in self.first.into_iter().chain(self.last).chain(scales) {
            out.extend(number.to_le_bytes());
        }
        out.resize(HEAD_BYTES, 0);
        out
    }

    fn read(cursor: &mut Cursor<'_>) -> Result<Self, AccumulatorError> {
        let mut words = [0; 5];
        for word in &mut words {
            *word = cursor.u64()?;
        }
        let [release, scene, seed, photons, traced] = words;
        let shard = Shard { index: cursor.u32()?, count: cursor.u32()? };
        let (max_bounces, quantity) = (cursor.u32()?, cursor.u32()?);
        let mut dims = [0; 3];
        for n in &mut dims {
            *n = cursor.u16()?;
        }
        let reserved = cursor.u16()?;
        let mut numbers = [0.0; 10];
        for number in &mut numbers {
            *number = f64::from_bits(cursor.u64()?);
        }
        let spare: [u8; 16] = cursor.array()?;
        let [x0, y0, z0, x1, y1, z1, power, per_area, quantum, volume] = numbers;
        let vertices: u64 = dims.iter().map(|&n| u64::from(n)).product();
        let flights = u64::from(max_bounces) + 1;
        // ACC-HDR-03 to -09.
        let checks = [
            ("number of photons", photons > 0 && photons <= MAX_FLIGHTS / flights && traced <= photons),
            ("shard", shard.index > 0 && shard.index <= shard.count),
            ("quantity", quantity <= 1),
            ("number of vertices", vertices > 0 && vertices <= ivg_grid::DEFAULT_MAX_VERTICES),
            ("reserved field", reserved == 0 && spare == [0; 16]),
            ("bounds", numbers[..6].iter().all(|x| x.is_finite())),
            ("scale", numbers[6..].iter().all(|x| x.is_finite() && *x > 0.0)),
        ];
        if let Some((what, _)) = checks.into_iter().find(|(_, good)| !good) {
            return Err(AccumulatorError::Field { what });
        }
        let quantity = if quantity == 1 { Quantity::Radiance } else { Quantity::Vectors };
        let (first, last) = ([x0, y0, z0], [x1, y1, z1]);
        Ok(Self {
            release,
            scene,
            seed,
            photons,
            traced,
            shard,
            max_bounces,
            quantity,
            dims,
            first,
            last,
            power,
            per_area,
            quantum,
            volume,
        })
    }
}

fn light_bytes(lights: &[BakedLight]) -> Vec<u8> {
    let mut out = Vec::new();
    for light in lights {
        out.push(u8::from(light.direct));
        out.extend((light.name.len() as u32).to_le_bytes());
        out.extend(light.name.as_bytes());
    }
    out
}

fn read_lights(bytes: &[u8]) -> Result<Vec<BakedLight>, AccumulatorError> {
    let mut cursor = Cursor::new(bytes, ByteOffset(0), Part::Record(1));
    let mut lights = Vec::new();
    while !cursor.rest().is_empty() {
        let direct = cursor.u8()?;
        let length = cursor.u32()? as usize;
        let name = core::str::from_utf8(cursor.take(length)?);
        let (Ok(name), true) = (name, direct <= 1) else {
            return Err(AccumulatorError::Field { what: "list of lights" });
        };
        lights.push(BakedLight { name: name.to_owned(), direct: direct == 1 });
    }
    Ok(lights)
}

fn book_bytes(books: &Books) -> Vec<u8> {
    let Books { emitted, absorbed, escaped, cut, after_bounces, flights } = books;
    let sums = [emitted, absorbed, escaped, cut].into_iter().flatten().chain(after_bounces);
    sums.flat_map(|sum| sum.to_le_bytes()).chain(flights.to_le_bytes()).collect()
}

fn read_books(bytes: &[u8]) -> Result<Books, AccumulatorError> {
    let mut cursor = Cursor::new(bytes, ByteOffset(0), Part::Record(2));
    let mut books = Books::default();
    let Books { emitted, absorbed, escaped, cut, after_bounces, flights } = &mut books;
    for sum in [emitted, absorbed, escaped, cut].into_iter().flatten().chain(after_bounces) {
        *sum = i128::from_le_bytes(cursor.array()?);
        // So far below the largest that those of all shards can be added.
        if sum.unsigned_abs() >> 96 != 0 {
            return Err(AccumulatorError::Field { what: "energy" });
        }
    }
    *flights = cursor.u64()?;
    if *flights > MAX_FLIGHTS {
        return Err(AccumulatorError::Field { what: "number of flights" });
    }
    Ok(books)
}

/// Bits of a vertex' neighbours that it sees; above them two a coordinate of where it looks from.
const NEIGHBOUR_BITS: u32 = 26;

impl Vertex {
    fn to_bytes(self) -> [u8; VERTEX_BYTES as usize] {
        let Self { place: Place { cells, moments, aside, open }, validity, blocked_edges } = self;
        let aside = (0..3).fold(0, |bits, a| bits | ((aside[a] + 1) as u32) << (2 * a));
        let mut out = [0; VERTEX_BYTES as usize];
        out[..2].copy_from_slice(&cells.to_le_bytes());
        (out[2], out[3]) = (validity, blocked_edges);
        for (place, moment) in out[4..10].as_chunks_mut::<2>().0.iter_mut().zip(moments) {
            *place = moment.to_le_bytes();
        }
        out[10..].copy_from_slice(&(open | aside << NEIGHBOUR_BITS).to_le_bytes());
        out
    }

    /// `None` for numbers that none has.
    fn read(bytes: &[u8; VERTEX_BYTES as usize]) -> Option<Self> {
        let &[c0, c1, validity, blocked_edges, x0, x1, y0, y1, z0, z1, o0, o1, o2, o3] = bytes;
        let cells = u16::from_le_bytes([c0, c1]);
        let moments = [[x0, x1], [y0, y1], [z0, z1]].map(i16::from_le_bytes);
        let bits = u32::from_le_bytes([o0, o1, o2, o3]);
        let sides: [u32; 3] = core::array::from_fn(|a| bits >> (NEIGHBOUR_BITS as usize + 2 * a) & 3);
        // The middle of a sub-cell is at most seven half sub-cells from that of the cell.
        let most = 7 * i32::from(cells);
        let good = u32::from(cells) <= SUB_CELLS
            && blocked_edges <= 7
            && moments.iter().all(|&moment| i32::from(moment).abs() <= most)
            && sides.iter().all(|&side| side <= 2);
        let place = Place {
            cells,
            moments,
            aside: sides.map(|side| side as i8 - 1),
            open: bits & ((1 << NEIGHBOUR_BITS) - 1),
        };
        good.then_some(Self { place, validity, blocked_edges })
    }
}

fn read_vertices(bytes: &[u8]) -> Result<Vec<Vertex>, AccumulatorError> {
    let vertices = bytes.as_chunks::<{ VERTEX_BYTES as usize }>().0.iter().map(Vertex::read);
    vertices.collect::<Option<_>>().ok_or(AccumulatorError::Field { what: "list of vertices" })
}

/// For fuzzing: bytes that are read are written as they were, and merging and finishing what they say ends in a grid or an error.
#[cfg(any(test, feature = "fuzz"))]
pub fn fuzz_accumulator(bytes: &[u8]) {
    let Ok(accumulator) = Accumulator::from_bytes(bytes) else { return };
    assert!(accumulator.to_bytes().len() == bytes.len(), "written with another length");
    let again = Accumulator::from_bytes(&accumulator.to_bytes());
    // A number that is none is not equal to itself; no field that is read holds one.
    assert!(again.as_ref() == Ok(&accumulator), "written and read again");
    let _ = accumulator.finish();
}
