//! The crates that say they need no std are linked into a static library that has none: with its own panic handler and its
//! own allocator. If std came in through a dependency or a feature, there would be two panic handlers, and this would not
//! build.

#![no_std]

mod bump;

use core::panic::PanicInfo;
use ivg_wire::Error;

#[global_allocator]
static ALLOCATOR: bump::Bump = bump::Bump::new();

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

/// Pushes the bytes into the decoder of each format and returns the exit codes of the two verdicts: that of `.ivg` in the low
/// byte, that of `.pmesh` in the high byte. This pulls the whole decoders into the link.
///
/// # Safety
///
/// `bytes` must point at `length` readable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn decode(bytes: *const u8, length: usize) -> u16 {
    // SAFETY: the caller promises so.
    let input = unsafe { core::slice::from_raw_parts(bytes, length) };
    u16::from_le_bytes([ivg(input), pmesh(input)])
}

fn ivg(input: &[u8]) -> u8 {
    exit_code(ivg_format::decode_all(input, &ivg_format::Limits::new(), |_| {}))
}

fn pmesh(input: &[u8]) -> u8 {
    exit_code(pmesh_format::check(input, &pmesh_format::Limits::new()))
}

fn exit_code(result: Result<(), Error>) -> u8 {
    result.map_or_else(|error| error.verdict(), |()| ivg_wire::Verdict::Ok).exit_code()
}
