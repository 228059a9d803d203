//! A small server of files in memory that fails as it is told to.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use super::http::PATIENCE;

pub(crate) type Files = HashMap<String, Vec<u8>>;

/// A request as the server sees it.
#[derive(Debug, Clone)]
pub(crate) struct Ask {
    /// How many requests came before it.
    pub(crate) number: usize,
    pub(crate) file: String,
    pub(crate) range: Option<Range<u64>>,
    pub(crate) if_range: Option<String>,
}

/// What is wrong with one answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Fault {
    None,
    /// The connection breaks after so many bytes of the body.
    DropAfter(usize),
    /// The byte at this offset of the file is wrong.
    Flip(u64),
    /// The whole file comes, whatever was asked.
    IgnoreRange,
    /// No content.
    Status(u16),
    /// Only so many bytes of the range come, and the answer says so.
    Shorten(u64),
    /// `Content-Range` and body begin a byte later than asked.
    Shift,
    /// Another entity tag, or none.
    Tag(Option<&'static str>),
    /// A content coding is stated.
    Coding,
    /// The stated length of the whole file is wrong.
    OtherTotal,
    /// `If-Range` is ignored: the range comes from whatever is there.
    IgnoreIfRange,
}

type Plan = Box<dyn FnMut(&Ask, &mut Files) -> Fault + Send>;

struct State {
    files: Files,
    asked: Vec<Ask>,
    plan: Plan,
}

pub(crate) struct Faulty {
    addr: SocketAddr,
    state: Arc<Mutex<State>>,
    stop: Arc<AtomicBool>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Faulty {
    /// Serves `files`; `plan` decides the fault of each request and may change the files before it is answered.
    pub(crate) fn start(files: Files, plan: impl FnMut(&Ask, &mut Files) -> Fault + Send + 'static) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let addr = listener.local_addr().expect("an address");
        let state = Arc::new(Mutex::new(State { files, asked: Vec::new(), plan: Box::new(plan) }));
        let stop = Arc::new(AtomicBool::new(false));
        let (shared, stopping) = (Arc::clone(&state), Arc::clone(&stop));
        let thread = std::thread::spawn(move || {
            let mut connections = Vec::new();
            while let Ok((stream, _)) = listener.accept() {
                if stopping.load(Ordering::SeqCst) {
                    break;
                }
                let shared = Arc::clone(&shared);
                connections.push(std::thread::spawn(move || converse(stream, &shared)));
            }
        });
        Self { addr, state, stop, thread: Some(thread) }
    }

    pub(crate) fn url(&self) -> String {
        format!("http://{}/", self.addr)
    }

    /// All requests so far.
    pub(crate) fn asked(&self) -> Vec<Ask> {
        self.state.lock().expect("no panic in the server").asked.clone()
    }
}

impl Drop for Faulty {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        // Wakes the thread that accepts.
        drop(TcpStream::connect(self.addr));
        if let Some(thread) = self.thread.take() {
            thread.join().expect("no panic in the server");
        }
    }
}

/// Strong tag of a content.
fn tag_of(content: &[u8]) -> String {
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    format!("\"{:016x}\"", hasher.finish())
}

fn converse(mut stream: TcpStream, state: &Mutex<State>) {
    stream.set_read_timeout(Some(PATIENCE)).expect("setting a time limit");
    // Head and body are written apart; waiting for an acknowledgement between them would take 40 ms each time.
    stream.set_nodelay(true).expect("setting an option");
    while let Some((file, fields)) = read_head(&mut stream) {
        let field = |name: &str| fields.iter().find(|(n, _)| n == name).map(|(_, value)| value.clone());
        let mut state = state.lock().expect("no panic in the server");
        let ask = Ask {
            number: state.asked.len(),
            file,
            range: field("range").as_deref().and_then(parse_range),
            if_range: field("if-range"),
        };
        state.asked.push(ask.clone());
        let State { files, plan, .. } = &mut *state;
        let fault = plan(&ask, files);
        let content = files.get(&ask.file).cloned();
        drop(state);
        if !answer(&mut stream, &ask, content, &fault) {
            return;
        }
    }
}

/// Whether the connection may be used again.
fn answer(stream: &mut TcpStream, ask: &Ask, content: Option<Vec<u8>>, fault: &Fault) -> bool {
    let (Some(mut content), false) = (content, matches!(fault, Fault::Status(_))) else {
        let status = if let Fault::Status(status) = fault { *status } else { 404 };
        return stream
            .write_all(format!("HTTP/1.1 {status} X\r\nContent-Length: 0\r\n\r\n").as_bytes())
            .is_ok();
    };
    let length = content.len() as u64;
    let shown_tag = match fault {
        Fault::Tag(tag) => tag.map(str::to_owned),
        _ => Some(tag_of(&content)),
    };
    let unchanged = ask.if_range.is_none() || ask.if_range == shown_tag || *fault == Fault::IgnoreIfRange;
    let range = ask.range.clone().filter(|_| unchanged && *fault != Fault::IgnoreRange);
    if let Fault::Flip(at) = *fault {
        content[at as usize] ^= 0x40;
    }
    let mut head = shown_tag.map_or(String::new(), |tag| format!("ETag: {tag}\r\n"));
    if *fault == Fault::Coding {
        head.push_str("Content-Encoding: gzip\r\n");
    }
    let (status, mut body) = match range {
        None => (200, 0..length),
        Some(range) if range.start >= length => {
            return stream.write_all(b"HTTP/1.1 416 X\r\nContent-Length: 0\r\n\r\n").is_ok();
        }
        Some(range) => (206, range.start..range.end.min(length)),
    };
    if status == 206 {
        match fault {
            Fault::Shorten(bytes) => body.end = body.end.min(body.start + bytes),
            Fault::Shift => body.start = (body.start + 1).min(body.end - 1),
            _ => {}
        }
        let total = if *fault == Fault::OtherTotal { length + 1 } else { length };
        head.push_str(&format!("Content-Range: bytes {}-{}/{total}\r\n", body.start, body.end - 1));
    }
    let body = &content[body.start as usize..body.end as usize];
    let head = format!("HTTP/1.1 {status} X\r\nContent-Length: {}\r\n{head}\r\n", body.len());
    let cut = if let Fault::DropAfter(bytes) = fault { body.len().min(*bytes) } else { body.len() };
    stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(&body[..cut])).is_ok()
        && cut == body.len()
}

fn read_head(stream: &mut TcpStream) -> Option<(String, Vec<(String, String)>)> {
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte).ok()?;
        head.push(byte[0]);
    }
    let head = String::from_utf8(head).ok()?;
    let file = head.split(' ').nth(1)?.trim_start_matches('/').to_owned();
    let field = |line: &str| line.split_once(": ").map(|(n, v)| (n.to_ascii_lowercase(), v.to_owned()));
    Some((file, head.lines().skip(1).filter_map(field).collect()))
}

fn parse_range(field: &str) -> Option<Range<u64>> {
    let (start, end) = field.strip_prefix("bytes=")?.split_once('-')?;
    let end = if end.is_empty() { u64::MAX } else { end.parse::<u64>().ok()? + 1 };
    Some(start.parse().ok()?..end)
}
