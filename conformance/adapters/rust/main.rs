//! The adapter of the decoders of this repository, as `conformance/PROTOCOL.md` has it; to copy for any other in Rust. What it writes
//! is made in `conformance/src/suite/shown/`.

#![forbid(unsafe_code)]

use conformance::suite::shown::{Shown, grid, mesh};
use conformance::suite::tables::table;
use ivg_wire::Verdict;
use std::fs::File;
use std::io::BufWriter;
use std::process::ExitCode;
use std::{env, fs, io};

const CAPABILITIES: &str = "name ivg-format and pmesh-format
ivg decode prefix prefixes chunks
pmesh decode prefix prefixes chunks lod
numeric rgb9e5 oct24 xyz24 f16
codes";

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match answer(&arguments) {
        Ok(Some(status)) => ExitCode::from(status),
        Ok(None) => {
            eprintln!("usage: see conformance/PROTOCOL.md");
            ExitCode::from(2)
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(1)
        }
    }
}

/// The exit status; `None` for what is no command.
fn answer(arguments: &[&str]) -> io::Result<Option<u8>> {
    let number = |text: &str| text.parse::<usize>().ok();
    match *arguments {
        ["capabilities"] => {
            println!("{CAPABILITIES}");
            Ok(Some(0))
        }
        ["numeric", name, out] => {
            let Some(table) = table(name) else { return Ok(None) };
            table.write(BufWriter::with_capacity(1 << 20, File::create(out)?))?;
            Ok(Some(0))
        }
        [command, format, input, out, ref rest @ ..] => {
            let data = fs::read(input)?;
            let read = |data: &[u8], sizes: &[usize], level| match format {
                "ivg" => Some(grid(data, sizes)),
                "pmesh" => Some(mesh(data, sizes, level)),
                _ => None,
            };
            let shown = match (command, rest) {
                ("decode", []) => read(&data, &[], None),
                ("prefix", [n]) => number(n).and_then(|n| read(&data[..n.min(data.len())], &[], None)),
                ("chunks", [sizes]) => {
                    let sizes: Option<Vec<usize>> = sizes.split(',').map(number).collect();
                    sizes.and_then(|sizes| read(&data, &sizes, None))
                }
                ("lod", [level]) if format == "pmesh" => {
                    level.parse().ok().and_then(|level| read(&data, &[], Some(level)))
                }
                ("prefixes", []) => {
                    let rows = (0..=data.len()).map(|n| read(&data[..n], &[], None));
                    let Some(rows) = rows.collect::<Option<Vec<Shown>>>() else { return Ok(None) };
                    let words =
                        rows.iter().flat_map(|row| [u32::from(row.verdict().exit_code()), row.records]);
                    fs::write(out, words.flat_map(u32::to_le_bytes).collect::<Vec<u8>>())?;
                    return Ok(Some(0));
                }
                _ => None,
            };
            shown.map(|shown| say(&shown, out)).transpose()
        }
        _ => Ok(None),
    }
}

/// Writes OUT or prints the code.
fn say(shown: &Shown, out: &str) -> io::Result<u8> {
    match (shown.verdict(), shown.error) {
        (Verdict::Ok | Verdict::NeedMore, _) => fs::write(out, &shown.out)?,
        (_, Some(error)) => println!("{} {}", error.code(), error.offset().0),
        (_, None) => {}
    }
    Ok(shown.verdict().exit_code())
}
