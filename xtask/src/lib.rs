//! Commands of the workspace: runs other programs and looks at source files, and knows none of the other crates.
//!
//! ```text
//! cargo xtask test --install     everything that CI runs
//! cargo xtask tidy               file lengths, left-over markers, README and CI agree
//! cargo xtask conformance-zip    the conformance suite as one file, for people without this repository
//! cargo xtask peers mesh --meshes FOLDER     progressive meshes beside meshoptimizer and Draco
//! cargo xtask peers bake --meshes FOLDER     baked light beside Mitsuba 3 and Embree
//! ```
//!
//! [`steps`] is the list of what the suite does, in order; [`runner`] runs such a list and stops at the first failure;
//! [`archive`] packs the conformance suite, [`readers`] runs it on the readers in other languages; [`tools`] finds, or with
//! `--install` fetches, what the machine lacks; [`tidy`] looks at the sources; [`peers`] builds and calls the comparisons in
//! `tools/peers`.

#![forbid(unsafe_code)]

pub mod archive;
pub mod fuzz;
pub mod invocation;
pub mod peers;
pub mod readers;
pub mod runner;
pub mod steps;
pub mod tidy;
pub mod tools;

use std::path::PathBuf;

/// The folder of the workspace, with the root `Cargo.toml`.
///
/// # Panics
///
/// When this crate's folder has no parent, which cannot be in a checkout.
#[must_use]
pub fn workspace_root() -> PathBuf {
    // The value at run time, so that a moved checkout with its old target folder is not confused with the first one.
    let manifest =
        std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    PathBuf::from(manifest).parent().expect("xtask lies inside the workspace").to_path_buf()
}
