//! Entity tags, RFC 9110 sections 8.8.3 and 13.1.

/// Whether `tag` is a strong entity tag: quoted, without the weak mark.
pub(crate) fn is_strong(tag: &str) -> bool {
    tag.len() >= 2 && tag.starts_with('"') && tag.ends_with('"')
}

/// Whether the list of an `If-Match` field names `tag` (strong comparison).
pub(crate) fn any_strong_match(list: &str, tag: &str) -> bool {
    list.trim() == "*" || members(list).any(|member| is_strong(member) && member == tag)
}

/// Whether the list of an `If-None-Match` field names `tag` (weak comparison).
pub(crate) fn any_weak_match(list: &str, tag: &str) -> bool {
    let opaque = |tag: &str| tag.strip_prefix("W/").unwrap_or(tag).to_owned();
    list.trim() == "*" || members(list).any(|member| opaque(member) == opaque(tag))
}

/// The tags of a list. Tags with a comma inside their quotes fall apart here; ours have none, so that they
/// could not match anyway.
fn members(list: &str) -> impl Iterator<Item = &str> {
    list.split(',').map(str::trim).filter(|member| !member.is_empty())
}

#[cfg(test)]
mod tests;
