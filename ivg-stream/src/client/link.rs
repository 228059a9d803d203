//! Requests of one session: repeated when they fail, checked, and handed to the download they are for.

use std::ops::Range;
use std::time::Duration;

use hyper::StatusCode;
use tokio::time::Instant;

use super::download::{Arrived, Contents, Download, Prefix, Refusal};
use super::error::FetchError;
use super::options::{Event, EventKind, FetchOptions, Observer};
use super::transport::{Broken, Reply, Transport};
use super::url::{SCENE_FILE, SceneUrl};

/// The connection of a session with its options and clock.
#[derive(Debug)]
pub(super) struct Link {
    transport: Transport,
    pub(super) options: FetchOptions,
    started: Instant,
}

/// How asking for bytes of a file ended, other than by an error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The bytes are in.
    Done,
    /// The file on the server is not the one that `scene.glb` stated.
    Changed(String),
    /// The file is whole, but its SHA-256 is not the stated one.
    Mismatch,
}

/// How one attempt failed.
enum Trouble {
    Broken(Broken),
    Damaged(String),
    OtherTag,
    Changed(String),
    Error(FetchError),
}

impl From<Broken> for Trouble {
    fn from(broken: Broken) -> Self {
        Self::Broken(broken)
    }
}

impl Link {
    pub(super) fn new(url: SceneUrl, options: FetchOptions) -> Self {
        let transport = Transport::new(url, options.connect_timeout, options.stall_timeout);
        Self { transport, options, started: Instant::now() }
    }

    pub(super) fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    pub(super) fn tell(&self, observer: &mut Observer<'_>, file: &str, what: EventKind) {
        observer(&Event { elapsed: self.elapsed(), file: file.to_owned(), what });
    }

    /// Waits before attempt `failures + 1`, or gives up.
    async fn after_failure(
        &self,
        file: &str,
        failures: u32,
        broken: &Broken,
        observer: &mut Observer<'_>,
    ) -> Result<(), FetchError> {
        let reason = broken.to_string();
        if failures > self.options.retries {
            return Err(FetchError::Connection { file: file.to_owned(), attempts: failures, reason });
        }
        self.tell(observer, file, EventKind::Broken { failures, reason });
        tokio::time::sleep(self.options.backoff_after(failures)).await;
        Ok(())
    }

    /// Fetches `scene.glb` whole (STR-CLI-01); the bytes, and how many were received for it.
    pub(super) async fn scene(&mut self, observer: &mut Observer<'_>) -> Result<(Vec<u8>, u64), FetchError> {
        let (mut bytes, mut tag, mut received, mut failures) = (Vec::new(), None, 0, 0);
        loop {
            let before = bytes.len();
            let attempt = self.scene_attempt(&mut bytes, &mut tag, &mut received).await;
            if attempt.is_err() {
                self.transport.close();
            }
            match attempt {
                Ok(()) => {
                    let length = bytes.len() as u64;
                    self.tell(observer, SCENE_FILE, EventKind::Scene { bytes: length });
                    return Ok((bytes, received));
                }
                Err(Trouble::Broken(broken)) => {
                    failures = if bytes.len() > before { 1 } else { failures + 1 };
                    self.after_failure(SCENE_FILE, failures, &broken, observer).await?;
                }
                Err(Trouble::Error(error)) => return Err(error),
                Err(Trouble::Damaged(what) | Trouble::Changed(what)) => {
                    return Err(FetchError::Answer { file: SCENE_FILE.to_owned(), what });
                }
                Err(Trouble::OtherTag) => {
                    (bytes, tag) = (Vec::new(), None);
                    failures += 1;
                    let changed = Broken::new("it changed while it was fetched");
                    self.after_failure(SCENE_FILE, failures, &changed, observer).await?;
                }
            }
        }
    }

    async fn scene_attempt(
        &mut self,
        bytes: &mut Vec<u8>,
        tag: &mut Option<String>,
        received: &mut u64,
    ) -> Result<(), Trouble> {
        let start = bytes.len() as u64;
        // Without a strong tag nothing tells whether the rest would be of the same file.
        let rest = (start > 0 && tag.is_some()).then_some(start..u64::MAX);
        let mut reply = self.transport.get(SCENE_FILE, rest.as_ref(), tag.as_deref()).await?;
        check_coding(&reply, SCENE_FILE)?;
        match (reply.status, &rest) {
            (StatusCode::OK, _) => bytes.clear(),
            (StatusCode::PARTIAL_CONTENT, Some(rest)) => {
                let begins = reply.content_range.as_ref().map(|range| range.bytes.start);
                if begins != Some(rest.start) {
                    let what = "a partial answer that does not begin where asked".to_owned();
                    return Err(Trouble::Error(FetchError::Answer { file: SCENE_FILE.to_owned(), what }));
                }
                if reply.tag != *tag {
                    return Err(Trouble::OtherTag);
                }
            }
            (StatusCode::RANGE_NOT_SATISFIABLE, Some(_)) => return Err(Trouble::OtherTag),
            (status, _) => return Err(refused(SCENE_FILE, status)),
        }
        tag.clone_from(&reply.tag);
        while let Some(piece) = reply.piece().await? {
            *received += piece.len() as u64;
            bytes.extend_from_slice(&piece);
            if bytes.len() as u64 > self.options.limits.scene_bytes {
                let reason = format!("larger than {} bytes, the limit set", self.options.limits.scene_bytes);
                return Err(Trouble::Error(FetchError::Refused { file: SCENE_FILE.to_owned(), reason }));
            }
        }
        Ok(())
    }

    /// Brings in the next bytes of a file on the way to `share` of its vertices; adds what was received to
    /// `received`.
    pub(super) async fn advance<C: Contents>(
        &mut self,
        download: &mut Download<C>,
        share: f64,
        received: &mut u64,
        observer: &mut Observer<'_>,
    ) -> Result<Outcome, FetchError> {
        let (request, prefix) = (self.options.request_bytes, self.options.prefix_bytes);
        let end = download.next_range(share, request, prefix).end;
        let file = download.file.uri.clone();
        let (mut failures, mut retags) = (0, 0);
        while download.position() < end {
            let asked = download.position()..end;
            let before = download.high_water;
            self.tell(observer, &file, EventKind::Request { start: asked.start, end });
            let attempt = self.attempt(download, &asked, received, observer).await;
            if attempt.is_err() {
                self.transport.close();
            }
            let broken = match attempt {
                Ok(Outcome::Done) if download.high_water > before => {
                    failures = 0;
                    continue;
                }
                Ok(Outcome::Done) => Broken::new("the answer brought nothing new"),
                Ok(outcome) => return Ok(outcome),
                Err(Trouble::Broken(broken)) => broken,
                Err(Trouble::Error(error)) => return Err(error),
                Err(Trouble::Changed(what)) => return Ok(Outcome::Changed(what)),
                Err(Trouble::OtherTag) => {
                    retags += 1;
                    match self.is_same(download, received).await {
                        Ok(true) => {
                            self.tell(observer, &file, EventKind::Retagged);
                            // Asked again at once, but not for ever if each answer has another tag.
                            if retags <= self.options.retries {
                                continue;
                            }
                            let what = "every answer has another entity tag".to_owned();
                            return Err(FetchError::Answer { file, what });
                        }
                        Ok(false) => return Ok(Outcome::Changed("its content id has changed".to_owned())),
                        Err(Trouble::Broken(broken)) => broken,
                        Err(Trouble::Error(error)) => return Err(error),
                        Err(_) => return Ok(Outcome::Changed("its beginning has changed".to_owned())),
                    }
                }
                Err(Trouble::Damaged(reason)) => {
                    failures += 1;
                    self.tell(observer, &file, EventKind::Damaged { reason: reason.clone() });
                    let offset = download.position();
                    if failures > self.options.retries {
                        return Err(FetchError::Damaged { file, offset, attempts: failures, reason });
                    }
                    // Once is bad luck; twice may mean that the file is another one by now (STR-CLI-08).
                    if failures > 1 {
                        match self.is_same(download, received).await {
                            Ok(true) | Err(Trouble::Broken(_)) if offset > 0 => {}
                            Err(Trouble::Error(error)) => return Err(error),
                            _ => return Ok(Outcome::Changed(reason)),
                        }
                    }
                    tokio::time::sleep(self.options.backoff_after(failures)).await;
                    continue;
                }
            };
            failures = if download.high_water > before { 1 } else { failures + 1 };
            self.after_failure(&file, failures, &broken, observer).await?;
        }
        Ok(Outcome::Done)
    }

    /// One request and its answer (STR-CLI-04).
    async fn attempt<C: Contents>(
        &mut self,
        download: &mut Download<C>,
        asked: &Range<u64>,
        received: &mut u64,
        observer: &mut Observer<'_>,
    ) -> Result<Outcome, Trouble> {
        let name = download.file.uri.clone();
        let mut reply = self.transport.get(&name, Some(asked), download.tag.as_deref()).await?;
        check_coding(&reply, &name)?;
        let wrong = |what: String| Trouble::Error(FetchError::Answer { file: name.clone(), what });
        let mut offset = match reply.status {
            StatusCode::PARTIAL_CONTENT => {
                let Some(range) = reply.content_range.clone() else {
                    return Err(wrong("a partial answer without a valid Content-Range".to_owned()));
                };
                if range.bytes.start != asked.start || range.bytes.end > asked.end {
                    return Err(wrong(format!(
                        "asked for bytes {asked:?}, the answer has {:?}",
                        range.bytes
                    )));
                }
                if let Some(total) = range.total.filter(|&total| total != download.file.byte_length) {
                    let stated = download.file.byte_length;
                    return Err(Trouble::Changed(format!("it has {total} bytes, stated are {stated}")));
                }
                asked.start
            }
            StatusCode::OK => 0,
            StatusCode::RANGE_NOT_SATISFIABLE => {
                return Err(Trouble::Changed("it is shorter than stated".to_owned()));
            }
            StatusCode::NOT_FOUND | StatusCode::GONE => {
                return Err(Trouble::Changed(format!(
                    "the server answers with status {}",
                    reply.status.as_u16()
                )));
            }
            status => return Err(refused(&name, status)),
        };
        if download.answered && download.tag.is_some() && reply.tag != download.tag {
            return Err(Trouble::OtherTag);
        }
        download.answered = true;
        download.tag.clone_from(&reply.tag);
        let end = if offset == asked.start && reply.status == StatusCode::PARTIAL_CONTENT {
            asked.end
        } else {
            download.file.byte_length
        };
        let mut outcome = Outcome::Done;
        while let Some(piece) = reply.piece().await? {
            *received += piece.len() as u64;
            // A server that ignores ranges begins at byte 0.
            let known = download.position().saturating_sub(offset).min(piece.len() as u64);
            offset += piece.len() as u64;
            if offset > end {
                return Err(Trouble::Changed(format!("more than the {end} bytes expected arrive")));
            }
            let fresh = &piece[usize::try_from(known).unwrap_or(piece.len())..];
            let mut arrived = Vec::new();
            let taken = download.receive(fresh, &mut |event| arrived.push(event));
            for event in arrived {
                let what = match event {
                    Arrived::Prefix(bytes) => EventKind::Prefix { bytes },
                    Arrived::Part { index, bytes, vertices } => EventKind::Part { index, bytes, vertices },
                    Arrived::Complete { matches: true } => EventKind::Complete,
                    Arrived::Complete { matches: false } => {
                        outcome = Outcome::Mismatch;
                        continue;
                    }
                };
                self.tell(observer, &name, what);
            }
            match taken {
                Ok(()) => {}
                Err(Refusal::Damaged(reason)) => return Err(Trouble::Damaged(reason)),
                Err(Refusal::Final(reason)) => {
                    return Err(Trouble::Error(FetchError::Refused { file: name, reason }));
                }
            }
        }
        Ok(outcome)
    }

    /// Whether the file on the server still is the one that was begun (STR-CLI-06); takes its new tag if so.
    async fn is_same<C: Contents>(
        &mut self,
        download: &mut Download<C>,
        received: &mut u64,
    ) -> Result<bool, Trouble> {
        let Some(length) = download.data_offset() else {
            // Nothing of it is in use yet.
            let file = download.file.clone();
            download.restart(file);
            return Ok(true);
        };
        let name = download.file.uri.clone();
        let mut reply = self.transport.get(&name, Some(&(0..length)), None).await?;
        check_coding(&reply, &name)?;
        match reply.status {
            StatusCode::OK => {}
            StatusCode::PARTIAL_CONTENT
                if reply.content_range.as_ref().is_some_and(|range| range.bytes == (0..length)) => {}
            StatusCode::PARTIAL_CONTENT | StatusCode::RANGE_NOT_SATISFIABLE | StatusCode::NOT_FOUND => {
                self.transport.close();
                return Ok(false);
            }
            status => return Err(refused(&name, status)),
        }
        let mut bytes = Vec::new();
        while (bytes.len() as u64) < length {
            let Some(piece) = reply.piece().await? else {
                return Err(Broken::new("the answer ended early").into());
            };
            *received += piece.len() as u64;
            bytes.extend_from_slice(&piece);
        }
        if reply.status == StatusCode::OK {
            self.transport.close();
        }
        let mut fresh = download.contents.fresh();
        let is_same = matches!(fresh.read_prefix(&bytes), Ok(Prefix::Whole(offset)) if offset == length)
            && fresh.content_id() == download.contents.content_id()
            && fresh.file_bytes() == download.contents.file_bytes();
        if is_same {
            download.tag = reply.tag;
        }
        Ok(is_same)
    }
}

fn check_coding(reply: &Reply, file: &str) -> Result<(), Trouble> {
    if reply.is_plain {
        return Ok(());
    }
    let what = "the answer has a content coding although none was asked for".to_owned();
    Err(Trouble::Error(FetchError::Answer { file: file.to_owned(), what }))
}

/// A status without content: worth another attempt, or not.
fn refused(file: &str, status: StatusCode) -> Trouble {
    if status.is_server_error() || status == StatusCode::TOO_MANY_REQUESTS {
        Trouble::Broken(Broken::new(format_args!("the server answers with status {}", status.as_u16())))
    } else {
        Trouble::Error(FetchError::Status { file: file.to_owned(), status: status.as_u16() })
    }
}
