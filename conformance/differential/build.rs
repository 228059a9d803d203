//! Compiles the readers in C: for a fuzzer as it compiles Rust, with its sanitiser, its coverage and no checksums compared.

#![forbid(unsafe_code)]

use std::env;

fn main() {
    for path in ["src/readers.c", "src/coverage.c", "../ports/c/ivg.h", "../ports/c/pmesh.h"] {
        println!("cargo::rerun-if-changed={path}");
    }
    let mut readers = cc::Build::new();
    readers.file("src/readers.c").include("../ports/c").std("c99").warnings(true).extra_warnings(true);
    if env::var_os("CARGO_CFG_FUZZING").is_some() {
        // The cost of a sanitiser without optimisation is more than a fuzzer should pay.
        readers.opt_level(2).define("IVG_FUZZING", None);
        // Both known compilers have these flags. Undefined behaviour ends the process at once: its own messages would need
        // the run-time library of the C compiler beside Rust's.
        readers.flags(["-fsanitize-coverage=trace-pc,trace-cmp", "-fno-omit-frame-pointer", "-g1"]);
        readers.flags(["-fsanitize=undefined", "-fsanitize-undefined-trap-on-error"]);
        if env::var("CARGO_CFG_SANITIZE").is_ok_and(|names| names.split(',').any(|name| name == "address")) {
            readers.flag("-fsanitize=address");
        }
        cc::Build::new().file("src/coverage.c").std("c99").opt_level(2).compile("differential_coverage");
    }
    readers.compile("differential_readers");
}
