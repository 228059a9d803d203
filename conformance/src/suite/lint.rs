//! Whether the committed suite is what it says it is: every file to refuse has one defect, and nothing else is wrong anywhere.

use super::diff::compare;
use super::shown::{grid, mesh};
use crate::vectors::Format;
use crate::vectors::both::with_changes_of;
use conformance_runner::manifest::{Op, Suite, Test, Verdict};
use conformance_runner::sha256;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// What is wrong with the suite in a folder, a line each; and the number of files to refuse that were found to have one defect.
///
/// # Errors
///
/// The manifest cannot be read.
pub fn lint(folder: &Path) -> Result<(Vec<String>, usize), String> {
    let suite = Suite::open(folder)?;
    let mut wrong = Vec::new();
    let mut ids = BTreeSet::new();
    let mut named = BTreeSet::from(["manifest.json".to_owned()]);
    let mut defects = 0;
    for test in &suite.manifest.tests {
        if !ids.insert(&test.id) {
            wrong.push(format!("{}: two tests have this id", test.id));
        }
        named.extend(test.file.iter().cloned().chain(test.out.iter().map(|out| out.file.clone())));
        wrong.extend(files(&suite, test).err().map(|why| format!("{}: {why}", test.id)));
        if test.op == Op::Decode && test.twin.is_some() {
            match defect(&suite, test) {
                Ok(()) => defects += 1,
                Err(why) => wrong.push(format!("{}: {why}", test.id)),
            }
        } else if test.op == Op::Decode && test.verdict != Verdict::Ok {
            wrong.push(format!("{}: it has no twin", test.id));
        }
    }
    tree(folder, "", &mut named, &mut wrong).map_err(|error| format!("{}: {error}", folder.display()))?;
    wrong.extend(named.into_iter().map(|file| format!("{file} is named in the manifest and is not there")));
    Ok((wrong, defects))
}

/// The files that a test names are those whose hashes it has.
fn files(suite: &Suite, test: &Test) -> Result<(), String> {
    if let (Some(file), Some(hash)) = (&test.file, &test.sha256) {
        let bytes = suite.read(file).map_err(|error| error.to_string())?;
        if sha256(&bytes) != *hash || test.bytes != Some(bytes.len() as u64) {
            return Err("the file has another hash or length".to_owned());
        }
    }
    let out = test.out.as_ref().map_or(Ok(None), |out| suite.expected(out))?;
    match (out, &test.out) {
        (Some(bytes), Some(out)) if sha256(&bytes) != out.sha256 || bytes.len() as u64 != out.bytes => {
            Err("what OUT must hold has another hash or length".to_owned())
        }
        _ => Ok(()),
    }
}

/// A file to refuse is made of its accepted twin by its recipe, and no checksum in it is wrong but one that is the defect.
fn defect(suite: &Suite, test: &Test) -> Result<(), String> {
    let (Some(recipe), Some(twin), Some(file)) = (&test.recipe, &test.twin, &test.file) else {
        return Err("it has no recipe".to_owned());
    };
    let twin = suite.test(twin).ok_or("its twin is no test")?;
    if twin.verdict != Verdict::Ok || twin.format != test.format || recipe.from != twin.id {
        return Err(format!("{} is no twin", twin.id));
    }
    let read = |file: &str| suite.read(file).map_err(|error| format!("{file}: {error}"));
    let (bytes, right) = (read(file)?, read(twin.file.as_deref().unwrap_or(""))?);
    let format = if test.format.as_deref() == Some("ivg") { Format::Ivg } else { Format::Pmesh };
    let show = |data: &[u8]| match format {
        Format::Ivg => grid(data, &[]),
        Format::Pmesh => mesh(data, &[], None),
    };
    if let Some(error) = show(&right).error {
        return Err(format!("its twin is refused: {error:?}"));
    }
    if recipe.apply(&right).as_ref() != Some(&bytes) {
        return Err("its recipe does not make it of its twin".to_owned());
    }
    let (again, unfit) = compare(format, &twin.id, &right, &bytes);
    if again != *recipe {
        return Err("its recipe is not the one that a comparison finds".to_owned());
    }
    let mut mistakes = vec![test];
    if let Some(both) = &test.both {
        let find = |id: &str| suite.test(id).ok_or(format!("{id} is no test"));
        let single = [find(&both[0])?, find(&both[1])?];
        let read = |test: &Test| read(test.file.as_deref().unwrap_or(""));
        let files = [read(single[0])?, read(single[1])?];
        if with_changes_of(format, &right, files.each_ref().map(Vec::as_slice)).as_ref() != Some(&bytes) {
            return Err("it has not the changes of its two mistakes".to_owned());
        }
        mistakes = single.to_vec();
        two_mistakes(test, single)?;
    }
    let of_checksums = |test: &&Test| test.bug_class.as_deref() == Some("checksum");
    let expected = mistakes.into_iter().filter(of_checksums).count();
    if unfit.len() != expected {
        return Err(format!("checksums that do not fit: {unfit:?}"));
    }
    let undone = recipe.edits.iter().filter(|edit| !edit.field.ends_with("crc")).count();
    if undone == 0 && expected == 0 {
        return Err("nothing but checksums differs".to_owned());
    }
    Ok(())
}

/// The two mistakes are single ones of the same twin, and the file is refused as that with the first alone.
fn two_mistakes(test: &Test, single: [&Test; 2]) -> Result<(), String> {
    if single.iter().any(|one| one.both.is_some() || one.twin != test.twin) {
        return Err("its mistakes are not single ones of its twin".to_owned());
    }
    if (single[0].verdict, single[0].code) != (test.verdict, test.code) {
        return Err("it is not refused as its first mistake is".to_owned());
    }
    Ok(())
}

/// Every file below the folder is named, has an ASCII name, and is a file.
fn tree(
    folder: &Path,
    below: &str,
    named: &mut BTreeSet<String>,
    wrong: &mut Vec<String>,
) -> std::io::Result<()> {
    for entry in fs::read_dir(folder.join(below))? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = if below.is_empty() { name.clone() } else { format!("{below}/{name}") };
        let kind = entry.file_type()?;
        if !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._".contains(&byte)) {
            wrong.push(format!("{path}: a name that not every system can have"));
        }
        if kind.is_dir() {
            tree(folder, &path, named, wrong)?;
        } else if !kind.is_file() {
            wrong.push(format!("{path} is a link"));
        } else if !named.remove(&path) {
            wrong.push(format!("{path} is not in the manifest"));
        }
    }
    Ok(())
}
