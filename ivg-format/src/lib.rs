//! The .ivg format: irradiance vector grids as bundles that can be streamed in any order.
//!
//! A grid describes indirect light: what reaches a point after at least one reflection. At each vertex of a regular lattice it
//! holds one of two quantities, for red, green and blue (linear, Rec. 709):
//!
//! - *irradiance vectors* ([`HemisphereVectors`]): for each of the six hemispheres around +x −x +y −y +z −z, in this order, the
//!   sum of all light that arrives from it, each ray as a vector *towards where it comes from*, as long as it is bright
//!   \[W/m²\]. A surface that faces +x receives the x component of the first: its irradiance. How other normals combine three
//!   vectors is in the crate `ivg-grid`; the idea is that of Pacanowski et al., Web3D 2008.
//! - *radiance harmonics* ([`RadianceHarmonics`]): nine coefficients of spherical harmonics \[W/(m² sr)\], which give
//!   the irradiance of any normal more accurately in fewer bytes.
//!
//! [`Encoding`] says how they are stored, and has a table of what each costs: `packed-oct24`, the default, for drawing;
//! `sh2-28` for accuracy; `vectors-f32` to lose nothing. [`Order`] says which vertices come together in a *bundle*.
//! Authority: `spec/common.md` and `spec/ivg.md`, which define every byte, every rounding and every error; clause ids such
//! as `IVG-DIR-03` are theirs.
//!
//! ```text
//! header 144 ─ chunks: DIRE, LITE, META ─ corners ─ validity blocks (optional) ─ bundle 1 … bundle B ─ end 20
//! ```
//!
//! A file of 32³ vertices in `packed-oct24` (42 bytes a vertex) takes 1.4 MB; with 64 vertices per slice it
//! comes in 16 bundles of 86 KB, each of which can be fetched and verified alone, and each of which is spread
//! over the whole volume.
//!
//! Writing a grid, and reading all of it as it arrives:
//!
//! ```
//! use ivg_format::{EncodeOptions, Event, GridSource, Lattice, Limits, decode_all, encode};
//!
//! let lattice = Lattice::new([4, 3, 2], [0.0; 3], [3.0, 2.0, 1.0])?;
//! // Light from above: the +y hemisphere of every vertex holds a vector along +y.
//! let mut vertex = [[[0.0; 3]; 3]; 6];
//! vertex[2] = [[0.0, 1.5, 0.0]; 3];
//! let vectors = vec![vertex; 24];
//! let file = encode(&GridSource::new(lattice, &vectors), &EncodeOptions::default())?;
//!
//! let mut received = 0;
//! decode_all(&file, &Limits::default(), |event| {
//!     if let Event::Corners(bundle) | Event::Bundle(bundle) = event {
//!         for n in 0..bundle.len() {
//!             assert_eq!(bundle.vectors(n)[2][0], [0.0, 1.5, 0.0]);
//!             received += 1;
//!         }
//!     }
//! })?;
//! assert_eq!(received, 24);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading by records, in any order, as a client does that fetches ranges of the file; here the last bundle alone, its
//! vertices some at a time, which is several times as fast as one by one:
//!
//! ```
//! # use ivg_format::{EncodeOptions, Event, GridSource, Header, HemisphereVectors, Lattice, Limits, RecordId, Step};
//! # let lattice = Lattice::new([4, 3, 2], [0.0; 3], [3.0, 2.0, 1.0])?;
//! # let file = ivg_format::encode(&GridSource::new(lattice, &vec![HemisphereVectors::default(); 24]), &EncodeOptions::default())?;
//! let Step::Consumed(_, header) = Header::read(&file, &Limits::default())? else {
//!     return Err("more bytes are needed".into());
//! };
//! let id = RecordId::Bundle(header.bundle_count);
//! let range = header.record_range(id);
//! let bytes = &file[range.start as usize..range.end as usize];
//! if let Event::Bundle(bundle) = ivg_format::decode_record(&header, id, bytes)? {
//!     let vertices: Vec<u64> = bundle.vertices().collect();
//!     let mut values = [HemisphereVectors::default(); 32];
//!     for (place, vertices) in vertices.chunks(32).enumerate() {
//!         let values = &mut values[..vertices.len()];
//!         bundle.read_vectors(place * 32, values);
//!         // values[n] belongs to the vertex with linear index vertices[n].
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A server may refine its light: a record that is written again with a higher generation replaces the one in its place,
//! and readers that hold both keep the newer, in whatever order they came ([`Generations`]; `ivg_grid` asks it):
//!
//! ```
//! use ivg_format::{
//!     Arrival, EncodeOptions, Generations, GridSource, Header, Lattice, Limits, RecordId, Step, encode, encode_record,
//!     replace_record,
//! };
//!
//! let lattice = Lattice::new([3, 3, 3], [0.0; 3], [1.0; 3])?;
//! let light = |brightness: f32| vec![[[[brightness; 3]; 3]; 6]; 27];
//! let (first, refined) = (light(1.0), light(2.5));
//! // The scale of the numbers stays as it is first written: leave room for light that is up to four times as bright.
//! let options = EncodeOptions { headroom: 2, ..EncodeOptions::default() };
//! let mut file = encode(&GridSource::new(lattice, &first), &options)?;
//!
//! let Step::Consumed(_, header) = Header::read(&file, &Limits::default())? else { unreachable!("a whole file") };
//! let record = encode_record(&GridSource::new(lattice, &refined), &header, RecordId::Bundle(1), 1)?;
//! assert_eq!(replace_record(&mut file, &record, &Limits::default())?, Arrival::Newer);
//!
//! let mut held = Generations::new();
//! assert_eq!(held.admit(header.content_id, RecordId::Bundle(1), 1), Arrival::New);
//! assert_eq!(held.admit(header.content_id, RecordId::Bundle(1), 0), Arrival::Stale);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Guarantees: reading never panics, whatever the bytes; [`Decoder`] allocates nothing, [`BufferedDecoder`]
//! nothing but the bytes of the record it waits for; any split of the bytes gives the same events and the same
//! error. [`decode_record`] reads one record by its range, [`Header::record_range`] says where it lies.
//!
//! Features: `std` (default) is only passed on to dependencies; it never changes bytes or results.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

mod bundle;
mod code;
mod codec;
mod decode;
mod directory;
mod encode;
mod encoding;
mod header;
mod lattice;
mod limits;
mod metadata;
mod order;
pub mod quant;
mod update;
mod validity;
mod values;
mod wire;

pub use bundle::{Bundle, Vertices};
pub use code::codes;
pub use decode::{BufferedDecoder, Decoder, Event, Ivg, decode_all, decode_record};
pub use directory::DIRECTORY;
pub use encode::{EncodeError, EncodeOptions, GridSource, encode, encode_record};
pub use encoding::{Encoding, Order, Units};
pub use header::{Header, RecordId, VALIDITY_BLOCK};
pub use ivg_wire::{
    Answer, ByteOffset, Chunk, ChunkKind, Code, ContentId, Error, ErrorKind, Limits as WireLimits, Part,
    Step, Verdict,
};
pub use lattice::{Lattice, LatticeError};
pub use limits::Limits;
pub use metadata::{BakedLight, LIGHTS, METADATA, lights, metadata};
pub use order::BundleVertices;
pub use update::{Arrival, Generations, UpdateError, replace_record};
pub use validity::ValidityBlock;
pub use values::{HemisphereVectors, Quantity, RadianceHarmonics, Values, VertexValues};
pub use wire::{HEADER_BYTES, MAJOR};
