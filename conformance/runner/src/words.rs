//! The few words of a shell that the command line of a decoder needs, and the patterns of `--only` and of lists to skip.

/// Splits a command into words as a POSIX shell would, without expanding anything: white space separates, single quotes keep all,
/// double quotes keep all but `\"` and `\\`, a backslash keeps the next character.
///
/// # Errors
///
/// A quote that does not end, a backslash at the end, or no word at all.
pub fn split(command: &str) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut characters = command.chars();
    while let Some(next) = characters.next() {
        match next {
            '\'' => {
                let word = word.get_or_insert_default();
                loop {
                    match characters.next().ok_or("a single quote does not end")? {
                        '\'' => break,
                        other => word.push(other),
                    }
                }
            }
            '"' => {
                let word = word.get_or_insert_default();
                loop {
                    match characters.next().ok_or("a double quote does not end")? {
                        '"' => break,
                        '\\' => match characters.next().ok_or("a double quote does not end")? {
                            kept @ ('"' | '\\') => word.push(kept),
                            other => word.extend(['\\', other]),
                        },
                        other => word.push(other),
                    }
                }
            }
            '\\' => word.get_or_insert_default().push(characters.next().ok_or("a backslash at the end")?),
            space if space.is_whitespace() => words.extend(word.take()),
            other => word.get_or_insert_default().push(other),
        }
    }
    words.extend(word);
    if words.is_empty() { Err("the command is empty".to_owned()) } else { Ok(words) }
}

/// Whether an id fits a pattern: `*` stands for any characters; a pattern without one fits every id that contains it.
#[must_use]
pub fn fits(pattern: &str, id: &str) -> bool {
    let Some((first, rest)) = pattern.split_once('*') else { return id.contains(pattern) };
    let Some(mut left) = id.strip_prefix(first) else { return false };
    let mut parts: Vec<&str> = rest.split('*').collect();
    let last = parts.pop().unwrap_or("");
    for part in parts {
        let Some(at) = left.find(part) else { return false };
        left = &left[at + part.len()..];
    }
    left.ends_with(last)
}

/// The patterns in a list of tests to skip: one a line; what follows `#` is a remark.
#[must_use]
pub fn patterns(text: &str) -> Vec<String> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or("").trim());
    lines.filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests;
