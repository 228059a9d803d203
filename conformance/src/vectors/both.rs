//! Files with two mistakes, each of them that of another file to refuse: which of the two is reported says the specification.

use super::edit::{HEADER_CHECKSUM, reseal, reseal_header};
use super::{Both, Format, Vector};
use crate::suite::{envelopes, fits};

/// Mistakes that a clause puts into an order, that of judgement. The twin is the same for all in a list, no two of them touch the same
/// bytes, and each two neighbours make a file.
type Order = (Format, &'static str, &'static [&'static str]);

/// All lists.
const ORDERS: &[Order] = &[
    (
        Format::Ivg,
        "COM-HDR-03",
        &[
            "x-101-signature",
            "x-201-major",
            "x-102-header-bytes",
            "x-103-header-damaged",
            "x-118-header-reserved",
            "x-202-feature",
            "x-116-data-offset",
            "x-301-no-vertices",
        ],
    ),
    (Format::Ivg, "IVG-HDR-01", &["x-303-step-zero", "x-302-last-infinite", "x-401-encoding-0"]),
    (
        Format::Ivg,
        "IVG-HDR-01",
        &[
            "x-302-origin-nan",
            "x-303-step-negative",
            "x-301-no-vertices",
            "x-402-encoding-unknown",
            "x-403-order-0",
            "x-304-exponent-high",
            "x-405-units-unknown",
            "x-305-no-share",
            "x-306-bundle-count",
            "x-307-validity-count",
            "x-118-reserved",
            "x-117-file-bytes",
            "x-105-record-checksum",
        ],
    ),
    (
        Format::Ivg,
        "COM-CHK-03",
        &[
            "x-106-chunk-length",
            "x-104-chunk-checksum",
            "x-118-chunk-flags",
            "x-107-chunk-padding",
            "x-411-metadata",
        ],
    ),
    (
        Format::Ivg,
        "COM-REC-05",
        &["x-105-record-checksum", "x-111-record-id", "x-114-end-generation", "x-114-end"],
    ),
    (Format::Ivg, "IVG-DIRE-01", &["x-309-directory-type", "x-312-directory-share"]),
    (Format::Ivg, "IVG-EXP-03", &["x-420-index-cut", "x-422-index-length"]),
    (Format::Pmesh, "COM-HDR-03", &["x-101-signature", "x-201-major", "x-102-header-bytes"]),
    (Format::Pmesh, "COM-HDR-03", &["x-103-header-checksum", "x-202-feature", "x-118-attributes"]),
    (
        Format::Pmesh,
        "PMESH-HDR-01",
        &[
            "x-118-attributes",
            "x-351-vertex-count",
            "x-351-face-count",
            "x-351-base-0",
            "x-351-packets-0",
            "x-352-mode-0",
            "x-354-positions-0",
            "x-356-origin",
            "x-357-bounds-nan",
            "x-118-header-end",
            "x-364-parameters",
            "x-358-directory-kind",
            "x-117-file-bytes",
        ],
    ),
    (Format::Pmesh, "PMESH-HDR-01", &["x-357-bounds-crossed", "x-118-parameters-reserved"]),
    (
        Format::Pmesh,
        "PMESH-DIR-01",
        &["x-104-chunk-checksum", "x-358-directory-kind", "x-359-directory-short"],
    ),
    (
        Format::Pmesh,
        "PMESH-DIR-02",
        &[
            "x-360-entry-base",
            "x-361-entry-bytes",
            "x-362-entry-error-nan",
            "x-360-entry-faces",
            "x-117-file-bytes",
        ],
    ),
    (
        Format::Pmesh,
        "COM-REC-05",
        &["x-105-record-checksum", "x-111-record-id", "x-118-record-generation", "x-501-position-nan"],
    ),
    (Format::Pmesh, "PMESH-PKT-03", &["x-501-position-nan", "x-519-slots-first"]),
    (Format::Pmesh, "PMESH-PKT-03", &["x-503-parent-later", "x-504-corner-later", "x-519-slots-many"]),
    (Format::Pmesh, "PMESH-PKT-03", &["x-502-normal-nan", "x-509-wedges-0", "x-505-face-two-wedges"]),
    (Format::Pmesh, "PMESH-PKT-03", &["x-510-wedge-target", "x-519-slots-equal"]),
];

/// The files of a format; `vectors` has those with one mistake.
pub(super) fn refused(format: Format, vectors: &[Vector]) -> Vec<Vector> {
    let find = |name: &str| {
        vectors.iter().find(|vector| vector.name == name).unwrap_or_else(|| panic!("no vector {name}"))
    };
    let lists = ORDERS.iter().filter(|(of, _, _)| *of == format);
    lists
        .flat_map(|(_, clause, names)| names.windows(2).map(move |two| (*clause, find(two[0]), find(two[1]))))
        .map(|(clause, first, second)| merged(format, clause, first, second, find))
        .collect()
}

fn merged<'a>(
    format: Format,
    clause: &'static str,
    first: &Vector,
    second: &Vector,
    find: impl Fn(&str) -> &'a Vector,
) -> Vector {
    let names = [first.name.clone(), second.name.clone()];
    let twin = first.twin.expect("a file to refuse");
    assert_eq!(second.twin, Some(twin), "{names:?}");
    let bytes = with_changes_of(format, &find(twin).bytes, [&first.bytes, &second.bytes]);
    let bytes = bytes.unwrap_or_else(|| panic!("{names:?} change the same bytes"));
    // `x-118-reserved` and `x-117-file-bytes`: `x-118-reserved-and-117-file-bytes`.
    let name = format!("{}-and-{}", first.name, second.name.trim_start_matches("x-"));
    Vector {
        name,
        bytes,
        why: "two mistakes: the one that is judged first is reported",
        both: Some(Both { names, clause }),
        ..first.clone()
    }
}

/// What two files, as long as a third, change in that. A checksum that fits in both of them fits again. `None` if both change a byte
/// that is not of a checksum, or are not as long.
pub(crate) fn with_changes_of(format: Format, right: &[u8], files: [&[u8]; 2]) -> Option<Vec<u8>> {
    if files.iter().any(|file| file.len() != right.len()) {
        return None;
    }
    let envelopes = envelopes(format, right);
    let of_checksum = |at: usize| {
        envelopes.iter().any(|envelope| match envelope.name.as_str() {
            "header" => HEADER_CHECKSUM.contains(&at),
            _ => envelope.range.end - 4 <= at && at < envelope.range.end,
        })
    };
    let mut merged = right.to_vec();
    for at in 0..right.len() {
        match files.map(|file| file[at] != right[at]) {
            [true, true] if !of_checksum(at) => return None,
            [true, _] => merged[at] = files[0][at],
            [_, true] => merged[at] = files[1][at],
            _ => {}
        }
    }
    for envelope in &envelopes {
        if files.iter().all(|file| fits(file, envelope)) {
            match envelope.name.as_str() {
                "header" => reseal_header(&mut merged),
                _ => reseal(&mut merged, envelope.range.clone()),
            }
        }
    }
    Some(merged)
}
