//! The readers in C, called.
//!
//! `readers.c` allocates what it returns; it is copied and given back here, so that no pointer leaves this file.
#![expect(unsafe_code, reason = "C is called; each call says why it is sound")]

use crate::transcript::{End, Transcript};

/// A mistake that the reader in C can make on demand, which proves that the fuzzer finds such mistakes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mistake {
    /// None: the reader as it is.
    None,
    /// After a record of a generation above 2, the byte behind the end record is looked at, as if this were the last one.
    ReadsBehindTheEnd,
    /// The scale exponent is left out where bundles are dequantised.
    ForgetsTheScale,
}

/// `transcript` in `readers.c`.
#[repr(C)]
struct Seen {
    bytes: *mut u8,
    length: u64,
    capacity: u64,
}

/// `frame_result` in `frame` of the ports.
#[repr(C)]
struct FrameResult {
    verdict: i32,
    code: i32,
    offset: u64,
}

// SAFETY: the declarations are those of `readers.c`.
unsafe extern "C" {
    fn differential_ivg(
        file: *const u8,
        ends: *const u64,
        pieces: u64,
        mistake: i32,
        seen: *mut Seen,
        result: *mut FrameResult,
    );
    fn differential_pmesh(
        file: *const u8,
        ends: *const u64,
        pieces: u64,
        between: u32,
        seen: *mut Seen,
        result: *mut FrameResult,
    );
    fn differential_free(bytes: *mut u8);
}

/// What the reader of `.ivg` sees.
pub(crate) fn grid(data: &[u8], ends: &[u64], mistake: Mistake) -> Transcript {
    called(data, ends, |ends, seen, result| {
        // SAFETY: `ends` has the given length and no element greater than the length of `data`, as `called` checks; `data`, `ends`,
        // `seen` and `result` are valid during the call, which keeps none of them.
        unsafe {
            differential_ivg(data.as_ptr(), ends.as_ptr(), ends.len() as u64, mistake as i32, seen, result);
        }
    })
}

/// What the reader of `.pmesh` sees, with so many levels between the coarsest and the finest.
pub(crate) fn mesh(data: &[u8], ends: &[u64], between: u32) -> Transcript {
    called(data, ends, |ends, seen, result| {
        // SAFETY: as in `grid`.
        unsafe {
            differential_pmesh(data.as_ptr(), ends.as_ptr(), ends.len() as u64, between, seen, result);
        }
    })
}

fn called(data: &[u8], ends: &[u64], call: impl FnOnce(&[u64], &mut Seen, &mut FrameResult)) -> Transcript {
    assert!(ends.is_sorted() && ends.iter().all(|&end| end <= data.len() as u64), "cuts outside the file");
    let mut seen = Seen { bytes: std::ptr::null_mut(), length: 0, capacity: 0 };
    let mut result = FrameResult { verdict: 0, code: 0, offset: 0 };
    call(ends, &mut seen, &mut result);
    let mut bytes = Vec::new();
    if !seen.bytes.is_null() {
        // SAFETY: `readers.c` has allocated and filled in so many bytes, and nothing else holds them.
        unsafe {
            bytes.extend_from_slice(std::slice::from_raw_parts(seen.bytes, seen.length as usize));
            differential_free(seen.bytes);
        }
    }
    Transcript { bytes, end: End { verdict: result.verdict, code: result.code, offset: result.offset } }
}
