//! File names for meshes: safe in every URI and file system, and unlike one another.

use std::collections::HashSet;

/// Longest name without the number and the extension.
const MOST_CHARACTERS: usize = 48;

/// A file name for each mesh name: ASCII letters, digits, `-` and `_`; different even where case does not count.
pub(super) fn mesh_files<'a>(mesh_names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = HashSet::new();
    mesh_names
        .map(|name| {
            let stem = stem(name);
            let candidates = (1u64..).map(|n| if n == 1 { stem.clone() } else { format!("{stem}-{n}") });
            let mut free = candidates.filter(|candidate| taken.insert(candidate.to_ascii_lowercase()));
            // The numbers do not run out.
            format!("{}.pmesh", free.next().unwrap_or(stem))
        })
        .collect()
}

/// The part of a name that is safe; `mesh` where nothing is left.
fn stem(name: &str) -> String {
    /// Names that mean devices on some systems, whatever their extension.
    const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];
    let safe = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
    let mapped: String = name.chars().map(safe).take(MOST_CHARACTERS).collect();
    let stem = mapped.trim_matches('-').to_owned();
    let lower = stem.to_ascii_lowercase();
    let is_device = DEVICES.contains(&lower.as_str())
        || (lower.len() == 4 && (lower.starts_with("com") || lower.starts_with("lpt")));
    match stem.as_str() {
        "" => "mesh".to_owned(),
        _ if is_device => format!("mesh-{stem}"),
        _ => stem,
    }
}

#[cfg(test)]
mod tests;
