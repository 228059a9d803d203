//! Plain text tables for people.

use crate::files::shown;

/// The narrowest that a last column becomes.
const NARROWEST: usize = 24;

/// As [`layout`], in lines of at most `line` characters if the other columns leave room: the last column goes on in lines of its own.
pub(crate) fn layout_within(rows: &[Vec<String>], numbers: &[usize], line: usize) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter()
            .filter_map(|row| row.get(column))
            .map(|cell| shown(cell).chars().count())
            .max()
            .unwrap_or(0)
    };
    let others: usize = (0..columns.saturating_sub(1)).map(|column| width(column) + 2).sum();
    let most = line.saturating_sub(others).max(NARROWEST);
    let mut wrapped: Vec<Vec<String>> = Vec::new();
    for row in rows {
        let (Some(last), others) = (row.last(), &row[..row.len().saturating_sub(1)]) else {
            wrapped.push(Vec::new());
            continue;
        };
        for (number, part) in parts(&shown(last), most).into_iter().enumerate() {
            let cell = |cell: &String| if number == 0 { cell.clone() } else { String::new() };
            wrapped.push(others.iter().map(cell).chain([part]).collect());
        }
    }
    layout(&wrapped, numbers)
}

/// Cuts a text at spaces into parts of at most `most` characters; longer words stay whole. At least one part.
fn parts(text: &str, most: usize) -> Vec<String> {
    let mut parts = vec![String::new()];
    for word in text.split(' ') {
        let part = parts.len() - 1;
        let length = parts[part].chars().count();
        if length > 0 && length + 1 + word.chars().count() > most {
            parts.push(word.to_owned());
        } else {
            if length > 0 {
                parts[part].push(' ');
            }
            parts[part].push_str(word);
        }
    }
    parts
}

/// Lays out rows in columns; the first row is the heading. The columns named in `numbers` are set flush right below it.
pub(crate) fn layout(rows: &[Vec<String>], numbers: &[usize]) -> String {
    let rows: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| shown(cell)).collect()).collect();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for (number, row) in rows.iter().enumerate() {
        for (column, cell) in row.iter().enumerate() {
            let gap = widths[column] - cell.chars().count();
            let right = number > 0 && numbers.contains(&column);
            if column > 0 {
                text.push_str("  ");
            }
            if right {
                text.extend(std::iter::repeat_n(' ', gap));
            }
            text.push_str(cell);
            if !right && column + 1 < row.len() {
                text.extend(std::iter::repeat_n(' ', gap));
            }
        }
        text.push('\n');
        if number == 0 {
            let rule: usize = widths.iter().sum::<usize>() + 2 * columns.saturating_sub(1);
            text.extend(std::iter::repeat_n('-', rule));
            text.push('\n');
        }
    }
    text
}

/// Bytes with a unit a person reads at a glance (decimal units).
pub(crate) fn bytes(count: u64) -> String {
    const UNITS: [&str; 4] = ["kB", "MB", "GB", "TB"];
    if count < 1000 {
        return format!("{count} B");
    }
    let mut value = count as f64 / 1000.0;
    let mut unit = 0;
    while value >= 1000.0 && unit + 1 < UNITS.len() {
        value /= 1000.0;
        unit += 1;
    }
    format!("{value:.1} {}", UNITS[unit])
}

#[cfg(test)]
mod tests {
    use super::layout_within;

    #[test]
    fn long_last_cells_go_on_below_themselves() {
        let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let rows = [row(["what", "why"]), row(["x", "one two three four five six seven"]), row(["y", ""])];
        let expected = "what  why\n------------------------------\nx     one two three four five\n      six seven\ny     \n";
        let text = layout_within(&rows, &[], 30);
        assert_eq!(text.replace(&"-".repeat(29), &"-".repeat(30)), expected, "{text}");
        assert!(layout_within(&rows, &[], 200).contains("five six seven\n"));
    }
}
