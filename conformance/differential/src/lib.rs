//! The same bytes through our decoders and through the readers in C (`conformance/ports/c`), which were written from the specification
//! alone: verdict, error code, byte offset and every decoded value must agree. The bodies of the fuzz targets `ivg_vs_c` and
//! `pmesh_vs_c`, which a test on the stable toolchain calls too.
//!
//! `readers.rs` is the only file of ours that calls C, and the only one with unsafe code.
//!
//! ```
//! // Neither reader takes this for a file, and both say so in the same way.
//! conformance_differential::ivg_vs_c(b"no magic");
//! conformance_differential::pmesh_vs_c(b"no magic");
//! ```

mod readers;
mod transcript;

pub use readers::Mistake;
use transcript::Transcript;

/// How many of the last bytes of an input choose where it is cut.
const CUT_CHOICES: usize = 3;

/// Levels of a mesh that are compared, beside the coarsest and the finest.
const LEVELS_BETWEEN: u32 = 3;

/// Both readers of `.ivg` see the same in any bytes.
///
/// # Panics
///
/// When they do not.
pub fn ivg_vs_c(data: &[u8]) {
    ivg_vs_c_with(data, Mistake::None);
}

/// As [`ivg_vs_c`], where the reader in C makes a mistake. A fuzzer must find it; nothing else asks for it.
///
/// # Panics
///
/// When the mistake shows.
pub fn ivg_vs_c_with(data: &[u8], mistake: Mistake) {
    compare(&transcript::grid(data), &readers::grid(data, &ends(data), mistake));
}

/// Both readers of `.pmesh` see the same in any bytes, level by level.
///
/// # Panics
///
/// When they do not.
pub fn pmesh_vs_c(data: &[u8]) {
    compare(&transcript::mesh(data, LEVELS_BETWEEN), &readers::mesh(data, &ends(data), LEVELS_BETWEEN));
}

/// How many bytes have arrived each time that the reader in C is asked, ascending; ours reads all at once. The last bytes of the input
/// choose, so that its beginning stays a file.
fn ends(data: &[u8]) -> Vec<u64> {
    let choices = &data[data.len() - data.len().min(CUT_CHOICES)..];
    // A choice of 0, the likeliest byte, is no cut.
    let cuts =
        choices.iter().filter(|&&choice| choice != 0).map(|&choice| data.len() * usize::from(choice) / 256);
    let mut ends: Vec<u64> = cuts.chain([data.len()]).map(|end| end as u64).collect();
    ends.sort_unstable();
    ends
}

fn compare(ours: &Transcript, theirs: &Transcript) {
    if ours == theirs {
        return;
    }
    let differs = ours.bytes.iter().zip(&theirs.bytes).position(|(a, b)| a != b);
    let place = differs.unwrap_or(ours.bytes.len().min(theirs.bytes.len()));
    panic!(
        "our decoder: {}; the reader in C: {}; what they saw, {} and {} bytes, differs from byte {place} on",
        ours.end,
        theirs.end,
        ours.bytes.len(),
        theirs.bytes.len()
    );
}
