//! What a reader shows of a file, in the form of OUT (`PROTOCOL.md`), by our decoders.

mod grid;
mod mesh;

use ivg_wire::{Error, Verdict};

pub use grid::grid;
pub use mesh::mesh;

/// What came of reading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shown {
    /// What is wrong; that bytes are missing counts too.
    pub error: Option<Error>,
    /// Records that were read whole and accepted, without the end record.
    pub records: u32,
    /// What is known, as OUT has it.
    pub out: Vec<u8>,
}

impl Shown {
    /// What is said of the bytes.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.error.map_or(Verdict::Ok, |error| error.verdict())
    }
}

/// The u32 that says that there is nothing.
const NOTHING: u32 = 0xFFFF_FFFF;

/// Cuts data into pieces of these lengths; the last one repeats.
pub fn pieces<'a>(data: &'a [u8], sizes: &'a [usize]) -> impl Iterator<Item = &'a [u8]> + 'a {
    let last = sizes.last().copied().unwrap_or(usize::MAX);
    let mut rest = data;
    sizes.iter().copied().chain(std::iter::repeat(last)).map_while(move |size| {
        let (piece, behind) = rest.split_at(size.clamp(1, rest.len().max(1)).min(rest.len()));
        rest = behind;
        (!piece.is_empty()).then_some(piece)
    })
}

/// Numbers, little-endian, one after the other.
#[derive(Debug, Default)]
struct Out(Vec<u8>);

impl Out {
    fn word(&mut self, word: u32) {
        self.0.extend(word.to_le_bytes());
    }

    fn words(&mut self, words: &[u32]) {
        words.iter().for_each(|&word| self.word(word));
    }

    fn f32s<'a>(&mut self, numbers: impl IntoIterator<Item = &'a f32>) {
        numbers.into_iter().for_each(|number| self.0.extend(number.to_le_bytes()));
    }

    fn f64s(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|number| self.0.extend(number.to_le_bytes()));
    }

    /// A length, and so many bytes.
    fn text(&mut self, text: &[u8]) {
        self.word(text.len() as u32);
        self.0.extend(text);
    }
}
