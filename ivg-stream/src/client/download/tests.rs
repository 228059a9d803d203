use quickcheck::quickcheck;

use super::*;

/// A toy format: a prefix `[content id, parts, vertices a part, length of a part]`, then parts
/// `[index, filling .., sum of all before]`. The last part adds no vertex, like an end record.
#[derive(Debug, Default, Clone, PartialEq)]
struct Toy {
    prefix: Option<[u8; 4]>,
    accepted: Vec<u8>,
}

impl Contents for Toy {
    fn read_prefix(&mut self, bytes: &[u8]) -> Result<Prefix, Refusal> {
        match bytes.first_chunk::<4>() {
            None => Ok(Prefix::NeedUpTo(4)),
            Some([_, _, _, 0 | 1]) => Err(Refusal::Damaged("a part needs two bytes".into())),
            Some(prefix) => {
                self.prefix = Some(*prefix);
                Ok(Prefix::Whole(4))
            }
        }
    }

    fn content_id(&self) -> Option<u64> {
        self.prefix.map(|[id, ..]| u64::from(id))
    }

    fn file_bytes(&self) -> Option<u64> {
        self.prefix.map(|[_, parts, _, length]| 4 + u64::from(parts) * u64::from(length))
    }

    fn part(&self, index: u32) -> Option<Range<u64>> {
        let [_, parts, _, length] = self.prefix?;
        let start = 4 + u64::from(index) * u64::from(length);
        (index < u32::from(parts)).then(|| start..start + u64::from(length))
    }

    fn part_vertices(&self, index: u32) -> u64 {
        self.prefix.map_or(
            0,
            |[_, parts, vertices, _]| if index + 1 < u32::from(parts) { vertices.into() } else { 0 },
        )
    }

    fn vertices(&self) -> Option<u64> {
        self.prefix.map(|[_, parts, vertices, _]| u64::from(parts.saturating_sub(1)) * u64::from(vertices))
    }

    fn accept(&mut self, index: u32, bytes: &[u8]) -> Result<(), Refusal> {
        let (sum, before) = bytes.split_last().unwrap();
        let right = before.iter().fold(0u8, |sum, &b| sum.wrapping_add(b)) == *sum;
        if !right || u32::from(before[0]) != index {
            return Err(Refusal::Damaged("wrong sum".into()));
        }
        self.accepted.push(before[0]);
        Ok(())
    }

    fn fresh(&self) -> Self {
        Self::default()
    }
}

fn file_of(parts: u8, length: u8) -> Vec<u8> {
    let mut file = vec![9, parts, 2, length];
    for index in 0..parts {
        let mut part = vec![index];
        part.extend((2..length).map(|i| i.wrapping_mul(37)));
        let sum = part.iter().fold(0u8, |sum, &b| sum.wrapping_add(b));
        part.push(sum);
        file.extend(part);
    }
    file
}

fn begin(file: &[u8]) -> Download<Toy> {
    let sha256 = Sha256::digest(file).into();
    Download::new(FileEntry { uri: "toy".into(), byte_length: file.len() as u64, sha256 }, Toy::default())
}

fn feed(download: &mut Download<Toy>, bytes: &[u8]) -> (Vec<Arrived>, Result<(), Refusal>) {
    let mut events = Vec::new();
    let outcome = download.receive(bytes, &mut |event| events.push(event));
    (events, outcome)
}

quickcheck! {
    fn any_split_gives_the_same_events_and_the_same_end(parts: u8, length: u8, cuts: Vec<usize>) -> bool {
        let file = file_of(parts.max(1), length.max(2));
        let (expected, _) = feed(&mut begin(&file), &file);
        let mut cuts: Vec<usize> = cuts.into_iter().map(|cut| cut % (file.len() + 1)).collect();
        cuts.extend([0, file.len()]);
        cuts.sort_unstable();
        let mut download = begin(&file);
        let mut events = Vec::new();
        for pair in cuts.windows(2) {
            let (more, outcome) = feed(&mut download, &file[pair[0]..pair[1]]);
            events.extend(more);
            assert_eq!((outcome, download.position()), (Ok(()), pair[1] as u64));
        }
        events == expected && events.last() == Some(&Arrived::Complete { matches: true })
    }

    /// Asking and receiving alternately reaches every goal, with requests that are never empty on the way, never
    /// larger than allowed, and that end on the end of a part wherever one ends in reach.
    fn requests_lead_to_the_goal_in_bounded_steps(parts: u8, length: u8, request: u8, share: u8) -> bool {
        let (parts, length) = (parts.max(1), length.max(2));
        let (request, share) = (u64::from(request.max(1)), f64::from(share) / 255.0);
        let file = file_of(parts, length);
        let mut download = begin(&file);
        let mut steps = 0;
        while !download.has_reached(share) {
            let range = download.next_range(share, request, 16);
            let size = range.end - range.start;
            assert!(range.start == download.position() && size > 0 && range.end <= file.len() as u64);
            if download.next_part.is_some() {
                assert!(size <= request);
                let ends_part = (range.end - 4).is_multiple_of(u64::from(length));
                let next_end = (range.start - 4) / u64::from(length) * u64::from(length) + u64::from(length) + 4;
                assert!(ends_part || next_end > range.start + request);
            }
            let (_, outcome) = feed(&mut download, &file[range.start as usize..range.end as usize]);
            assert_eq!(outcome, Ok(()));
            steps += 1;
            assert!(steps <= file.len());
        }
        let needed = (share * download.contents.vertices().unwrap_or(0) as f64).ceil() as u64;
        download.vertices() >= needed && (share < 1.0 || download.is_complete())
    }
}

#[test]
fn nothing_is_asked_for_without_a_goal() {
    let file = file_of(3, 4);
    let download = begin(&file);
    assert!(download.has_reached(0.0) && download.has_reached(f64::NAN) && !download.has_reached(1e-9));
    assert!(download.next_range(0.0, 100, 16).is_empty());
}

#[test]
fn only_the_parts_that_a_share_needs_are_asked_for() {
    let file = file_of(11, 10);
    let mut download = begin(&file);
    feed(&mut download, &file[..4]).1.unwrap();
    // 20 vertices, 2 a part: a quarter is 5, so 3 parts.
    assert_eq!(download.next_range(0.25, 1000, 16), 4..34);
    assert_eq!(download.next_range(1.0, 1000, 16), 4..114);
    assert_eq!(download.next_range(1.0, 25, 16), 4..24);
    assert_eq!(download.next_range(1.0, 7, 16), 4..11);
}

#[test]
fn a_damaged_part_is_dropped_and_asked_for_again() {
    let file = file_of(5, 10);
    for at in 14..24 {
        let mut bad = file.clone();
        bad[at] ^= 0x10;
        let mut download = begin(&file);
        let (events, outcome) = feed(&mut download, &bad[..30]);
        assert!(matches!(outcome, Err(Refusal::Damaged(_))), "{at}");
        assert_eq!(events, [Arrived::Prefix(4), Arrived::Part { index: 0, bytes: 10, vertices: 2 }]);
        assert_eq!(download.position(), 14, "the part before stays, the rest is dropped");
        assert_eq!(download.next_range(1.0, 10, 16), 14..24);
        let (events, _) = feed(&mut download, &file[14..]);
        assert_eq!(events.last(), Some(&Arrived::Complete { matches: true }));
    }
}

#[test]
fn a_file_that_is_not_the_stated_one_is_noticed() {
    let file = file_of(3, 4);
    let mut longer = begin(&file);
    longer.file.byte_length += 1;
    assert!(
        matches!(feed(&mut longer, &file).1, Err(Refusal::Damaged(reason)) if reason.contains("scene.glb"))
    );
    let mut other = begin(&file);
    other.file.sha256[0] ^= 1;
    assert_eq!(feed(&mut other, &file).0.last(), Some(&Arrived::Complete { matches: false }));
}

#[test]
fn a_restart_forgets_everything() {
    let file = file_of(3, 4);
    let mut download = begin(&file);
    download.tag = Some("\"x\"".into());
    feed(&mut download, &file).1.unwrap();
    let entry = download.file.clone();
    download.restart(entry);
    assert_eq!((download.position(), download.vertices(), download.tag.as_deref()), (0, 0, None));
    assert_eq!(download.contents, Toy::default());
    assert_eq!(feed(&mut download, &file).0.last(), Some(&Arrived::Complete { matches: true }));
}
