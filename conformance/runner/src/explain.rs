//! Everything about one test.

use crate::manifest::{Edit, Suite, Test};
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

/// The documents of the specification that have clauses.
const DOCUMENTS: [&str; 3] = ["common.md", "ivg.md", "pmesh.md"];

/// Bytes in a line of a hexadecimal dump, and lines that are shown around an edit.
const LINE: usize = 16;
const AROUND: usize = 1;
/// Edits that are shown byte by byte, and the lines shown of each.
const EDITS: usize = 6;
const LINES: usize = 8;

/// What a test does, why, the clauses that it is about, and how its file is made of its twin.
///
/// # Errors
///
/// There is no such test.
pub fn explain(suite: &Suite, id: &str) -> Result<String, String> {
    let test = suite.test(id).ok_or_else(|| format!("there is no test {id}; `list` names all"))?;
    let mut text = format!("{}\n  {}\n", test.id, test.why);
    let mut line = |name: &str, value: &str| {
        if !value.is_empty() {
            // A string takes everything.
            let _ = writeln!(text, "  {name:<10} {value}");
        }
    };
    line(
        "command",
        &format!("CMD {}", test.arguments(test.file.as_deref().unwrap_or("IN"), "OUT").join(" ")),
    );
    let also: String = test.also.iter().map(|verdict| format!(" or {}", verdict.name())).collect();
    let code = test.code.map_or(String::new(), |code| format!(" {code}"));
    line("expected", &format!("{}{code}{also} (exit status {})", test.verdict.name(), test.verdict.status()));
    if let Some(out) = &test.out {
        line("OUT", &format!("{} bytes, {:?}: {}", out.bytes, out.form, out.file).to_lowercase());
    }
    line("bug class", test.bug_class.as_deref().unwrap_or(""));
    line("twin", test.twin.as_deref().unwrap_or(""));
    line("mistakes", &test.both.as_ref().map_or(String::new(), |both| both.join(" before ")));
    let whole = test.of.as_ref().and_then(|of| suite.test(of));
    line("whole file", whole.map_or("", |whole| &whole.id));
    let recipe = test.recipe.as_ref().or(whole.and_then(|whole| whole.recipe.as_ref()));
    if let Some(recipe) = recipe {
        line("made of", &format!("{} by {} edits", recipe.from, recipe.edits.len()));
        line("checksums", &recipe.checksums.join(", "));
        text += &edits(suite, test, &recipe.from, &recipe.edits);
    }
    for clause in &test.clauses {
        text += &format!("\n{}\n", clause_text(suite, clause).unwrap_or_else(|| clause.clone()));
    }
    Ok(text)
}

/// The bytes of the twin around each edit, and what comes there.
fn edits(suite: &Suite, test: &Test, twin: &str, edits: &[Edit]) -> String {
    let twin = suite.test(twin).and_then(|twin| twin.file.as_ref()).and_then(|file| suite.read(file).ok());
    let Some(twin) = twin else { return format!("  the twin of {} cannot be read\n", test.id) };
    let mut text = String::new();
    for edit in edits.iter().take(EDITS) {
        let (at, delete) = (edit.at as usize, edit.delete as usize);
        text += &format!("\n  {}, at {at} (0x{at:X}):\n", edit.field);
        let first = (at / LINE).saturating_sub(AROUND);
        let last = ((at + delete.max(1) - 1) / LINE + AROUND).min(first + LINES - 1);
        for line in first..=last {
            let start = line * LINE;
            let Some(bytes) = twin.get(start..twin.len().min(start + LINE)).filter(|bytes| !bytes.is_empty())
            else {
                break;
            };
            text += &format!("    {start:06X} ");
            for (n, byte) in bytes.iter().enumerate() {
                let marked = (at..at + delete).contains(&(start + n));
                text += &if marked { format!("[{byte:02X}]") } else { format!(" {byte:02X} ") };
            }
            text.push('\n');
        }
        let shown: String = edit.insert.chars().take(2 * LINE * LINES).collect();
        let more = if shown.len() < edit.insert.len() { " ..." } else { "" };
        let times = edit.repeat.map_or(String::new(), |times| format!(", {times} times"));
        let becomes = if shown.is_empty() { "nothing".to_owned() } else { shown.to_uppercase() + more };
        let what = if delete == 0 { "there comes in" } else { "becomes" };
        text += &format!("    {what}: {becomes}{times}\n");
    }
    if edits.len() > EDITS {
        text += &format!("\n  and {} edits more\n", edits.len() - EDITS);
    }
    text
}

/// What the specification says of a clause, up to the next clause or heading, if it lies beside the suite.
fn clause_text(suite: &Suite, clause: &str) -> Option<String> {
    let folders = ["spec", "../spec", "../../spec"].map(|folder| suite.folder.join(folder));
    let folder: &PathBuf = folders.iter().find(|folder| folder.join("common.md").exists())?;
    let mark = format!("**{clause}**");
    DOCUMENTS.iter().find_map(|document| {
        let text = fs::read_to_string(folder.join(document)).ok()?;
        let start =
            text.match_indices(&mark).map(|(at, _)| at).find(|&at| at == 0 || text[..at].ends_with('\n'))?;
        let lines = text[start..].split('\n');
        let own = lines.enumerate().take_while(|(number, line)| *number == 0 || !begins_another(line));
        let own: Vec<&str> = own.map(|(_, line)| line).collect();
        Some(own.join("\n").trim_end().to_owned())
    })
}

/// Whether a line begins another clause or a section.
fn begins_another(line: &str) -> bool {
    let name = line.strip_prefix("**").and_then(|rest| rest.split_once("**")).map(|(name, _)| name);
    line.starts_with('#') || name.is_some_and(is_clause)
}

/// Whether it is a name such as IVG-DIR-03.
fn is_clause(name: &str) -> bool {
    let parts: Vec<&str> = name.split('-').collect();
    let of = |part: &str, kind: fn(&u8) -> bool| !part.is_empty() && part.bytes().all(|byte| kind(&byte));
    matches!(parts[..], [document, part, number] if of(document, u8::is_ascii_uppercase)
        && of(part, u8::is_ascii_uppercase)
        && of(number, u8::is_ascii_digit))
}
