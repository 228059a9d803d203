//! What every reader of our formats must do, as files and as functions.
//!
//! - [`vectors`] makes small files, right and wrong, with the verdict and the error code that a reader must give for each.
//!   `cargo run -p conformance --bin generate` writes them to `conformance/vectors/`, with a manifest for readers in other
//!   languages, and the seeds of the fuzz targets to `fuzz/corpus/`.
//! - [`suite`] makes the tests of them that `conformance/PROTOCOL.md` describes, and checks that each shows one thing.
//! - [`oracles`] says what must hold for any bytes whatever: the bodies of the fuzz targets, which the tests here call with
//!   all vectors and seeds.
//! - [`mod@reference`] is a second reader of `.pmesh` packets, written from the specification alone, with which the first is compared.
//! - [`bounds`] asserts how much a reader may allocate; [`choices`] turns bytes into things to encode, [`surfaces`] grows
//!   meshes, and [`mod@invented`] makes packets that no writer would.
//!
//! ```
//! use conformance::vectors::vectors;
//!
//! let refused = vectors().into_iter().find(|vector| vector.name == "x-115-trailing").expect("in the list");
//! let error = ivg_format::decode_all(&refused.bytes, &ivg_format::Limits::default(), |_| {}).unwrap_err();
//! assert_eq!((error.verdict(), Some(error.code())), (refused.verdict, refused.code));
//! ```

#![forbid(unsafe_code)]

pub mod bounds;
pub mod choices;
pub mod invented;
pub mod oracles;
pub mod reference;
pub mod suite;
pub mod surfaces;
pub mod vectors;
