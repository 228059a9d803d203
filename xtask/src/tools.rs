//! What the suite needs beside Rust: looked for before anything slow begins, and installed when that is asked for.

use crate::invocation::Invocation;
use crate::runner::Context;
use std::path::{Path, PathBuf};

#[cfg(test)]
mod tests;

/// Where tools built from source go, relative to the workspace.
pub const FOLDER: &str = "target/tools";
/// The cargo-fuzz that the suite is known to work with.
const CARGO_FUZZ_VERSION: &str = "0.13.2";
/// Debian's packages with a software Vulkan driver and the loader that finds it.
const VULKAN_PACKAGES: &str = "mesa-vulkan-drivers libvulkan1";

/// Something that the suite needs.
struct Tool {
    name: &'static str,
    is_there: fn(&Path) -> bool,
    /// The commands that install it, one after the other.
    install: fn(&Path) -> Vec<Invocation>,
}

/// Checks for everything that the suite needs; with `install`, installs what is missing. `full` says whether readers
/// in other languages and fuzz targets will be run.
///
/// # Errors
///
/// When something is missing; the text has the line that installs it. With `install`: when that line fails, or the tool is
/// still missing after it.
pub fn ensure(context: &mut Context, install: bool, full: bool) -> Result<(), String> {
    let compiler = Tool {
        name: "a C and C++ compiler",
        is_there: |root| ["cc", "c++"].iter().all(|name| answers(root, name)),
        install: |root| apt_get(root, "g++"),
    };
    let vulkan = Tool {
        name: "a Vulkan loader and driver",
        is_there: |_| vulkan_is_there(),
        install: |root| apt_get(root, VULKAN_PACKAGES),
    };
    let cargo_fuzz = Tool {
        name: "cargo-fuzz",
        is_there: |root| {
            let binaries = Path::new(FOLDER).join("bin");
            Invocation::cargo("fuzz --version").path_front(&binaries).output(root).is_ok()
        },
        install: |_| {
            let arguments =
                format!("install --locked --root {FOLDER} cargo-fuzz --version {CARGO_FUZZ_VERSION}");
            vec![Invocation::cargo(&arguments)]
        },
    };
    let python = Tool {
        name: "Python 3",
        is_there: |root| answers(root, "python3"),
        install: |root| apt_get(root, "python3"),
    };
    let node = Tool {
        name: "node",
        is_there: |root| answers(root, "node"),
        install: |root| apt_get(root, "nodejs"),
    };
    let mut tools = vec![compiler, vulkan, python];
    if full {
        tools.extend([node, cargo_fuzz]);
    }
    provide(context, &tools, install)
}

fn provide(context: &Context, tools: &[Tool], install: bool) -> Result<(), String> {
    let root = context.root();
    let mut missing = Vec::new();
    for tool in tools {
        if (tool.is_there)(root) {
            println!("{}: found", tool.name);
            continue;
        }
        let commands = (tool.install)(root);
        if !install {
            let lines: Vec<String> = commands.iter().map(Invocation::to_string).collect();
            missing.push(format!("{} is missing; to install it: {}", tool.name, lines.join(" && ")));
            continue;
        }
        for command in &commands {
            context.run(command)?;
        }
        if !(tool.is_there)(root) {
            return Err(format!("{} is still missing after its installation", tool.name));
        }
        println!("{}: installed", tool.name);
    }
    if missing.is_empty() {
        Ok(())
    } else {
        missing.push("or let the suite do it: cargo xtask test --install".to_owned());
        Err(missing.join("\n  "))
    }
}

fn answers(root: &Path, program: &str) -> bool {
    Invocation::new(program, "--version").output(root).is_ok()
}

/// The commands that install Debian packages, as root or through sudo. The package lists come first: a bare machine has none.
fn apt_get(root: &Path, packages: &str) -> Vec<Invocation> {
    let is_root = Invocation::new("id", "-u").output(root).is_ok_and(|user| user.trim() == "0");
    let command = |arguments: &str| {
        if is_root {
            Invocation::new("apt-get", arguments).environment("DEBIAN_FRONTEND", "noninteractive")
        } else {
            Invocation::new("sudo", "DEBIAN_FRONTEND=noninteractive apt-get").arguments(arguments)
        }
    };
    vec![command("update"), command(&format!("install -y --no-install-recommends {packages}"))]
}

/// A Vulkan loader and at least one driver manifest are where the loader looks. Only asked on Linux: elsewhere the system
/// brings its own graphics interface.
fn vulkan_is_there() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    has_loader(&library_folders()) && (named_driver_exists() || has_manifest(&manifest_folders()))
}

fn has_loader(folders: &[PathBuf]) -> bool {
    folders.iter().any(|folder| folder.join("libvulkan.so.1").exists())
}

fn has_manifest(folders: &[PathBuf]) -> bool {
    folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().any(|entry| {
        entry.is_ok_and(|entry| entry.path().extension().is_some_and(|extension| extension == "json"))
    })
}

/// The folders that the dynamic linker searches: its variable, what its cache names, and the usual ones.
fn library_folders() -> Vec<PathBuf> {
    let variable = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let mut folders: Vec<PathBuf> = std::env::split_paths(&variable).collect();
    let cache = ["ldconfig", "/sbin/ldconfig"]
        .iter()
        .find_map(|program| Invocation::new(program, "-p").output(Path::new("/")).ok())
        .unwrap_or_default();
    folders.extend(cached_folders(&cache));
    folders.extend(["/usr/lib", "/usr/lib64", "/usr/local/lib", "/lib64"].map(PathBuf::from));
    folders
}

/// The folders in what `ldconfig -p` prints: lines of the form `libz.so.1 (libc6,x86-64) => /lib/x86_64-linux-gnu/libz.so.1`.
fn cached_folders(cache: &str) -> Vec<PathBuf> {
    let files = cache.lines().filter_map(|line| line.split_once(" => "));
    let mut folders: Vec<PathBuf> =
        files.filter_map(|(_, file)| Path::new(file.trim()).parent().map(Path::to_path_buf)).collect();
    folders.sort();
    folders.dedup();
    folders
}

/// The user names drivers to the loader.
fn named_driver_exists() -> bool {
    ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().any(|name| {
        std::env::var_os(name).is_some_and(|value| std::env::split_paths(&value).any(|file| file.exists()))
    })
}

/// The folders in which the loader looks for driver manifests on Linux (Vulkan loader, `LoaderDriverInterface.md`).
fn manifest_folders() -> Vec<PathBuf> {
    let mut bases: Vec<PathBuf> = vec!["/etc".into(), "/usr/local/etc".into()];
    let shared = std::env::var_os("XDG_DATA_DIRS").unwrap_or_else(|| "/usr/local/share:/usr/share".into());
    bases.extend(std::env::split_paths(&shared));
    match (std::env::var_os("XDG_DATA_HOME"), std::env::var_os("HOME")) {
        (Some(data), _) => bases.push(data.into()),
        (None, Some(home)) => bases.push(Path::new(&home).join(".local/share")),
        (None, None) => {}
    }
    bases.into_iter().map(|base| base.join("vulkan/icd.d")).collect()
}
