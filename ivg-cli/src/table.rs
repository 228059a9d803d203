//! Plain text tables for people.

use crate::files::shown;

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
