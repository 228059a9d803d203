//! The smallest allocator that works: hands out one arena from front to back and takes nothing back.

use core::alloc::{GlobalAlloc, Layout};
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicUsize, Ordering};

/// Bytes in the arena; enough for the small files of a link test.
const ARENA: usize = 1 << 20;

/// A bump allocator over a static arena.
#[repr(align(4096))]
pub struct Bump {
    arena: UnsafeCell<[u8; ARENA]>,
    used: AtomicUsize,
}

impl Bump {
    /// Nothing handed out yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { arena: UnsafeCell::new([0; ARENA]), used: AtomicUsize::new(0) }
    }
}

// SAFETY: the arena is only touched through the ranges handed out, and `used` makes these disjoint.
unsafe impl Sync for Bump {}

// SAFETY: every range handed out lies inside the arena, is aligned (the arena is, to 4096 bytes; larger alignments are
// refused) and is never handed out again.
unsafe impl GlobalAlloc for Bump {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.align() > align_of::<Self>() {
            return core::ptr::null_mut();
        }
        let claim = |used: usize| {
            let start = used.checked_next_multiple_of(layout.align())?;
            start.checked_add(layout.size()).filter(|end| *end <= ARENA)
        };
        match self.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, claim) {
            // SAFETY: start + size <= ARENA, as `claim` checked.
            Ok(used) => unsafe { self.arena.get().cast::<u8>().add(used.next_multiple_of(layout.align())) },
            Err(_) => core::ptr::null_mut(),
        }
    }

    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
}
