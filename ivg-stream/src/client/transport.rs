//! One HTTP/1.1 connection that is opened when needed, and answers read piece by piece under time limits.

use std::ops::Range;
use std::time::Duration;

use bytes::Bytes;
use http_body_util::{BodyExt, Empty};
use hyper::body::Incoming;
use hyper::client::conn::http1::{self, SendRequest};
use hyper::header;
use hyper::{Method, Request, StatusCode};
use hyper_util::rt::TokioIo;
use tokio::net::TcpStream;
use tokio::time::timeout;

use super::url::SceneUrl;
use crate::http::range::{ContentRange, parse_content_range};
use crate::http::tag::is_strong;

/// A failure of the connection, which a later attempt may not meet.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub(super) struct Broken(String);

impl Broken {
    pub(super) fn new(reason: impl ToString) -> Self {
        Self(reason.to_string())
    }
}

/// The way to one server.
#[derive(Debug)]
pub(super) struct Transport {
    url: SceneUrl,
    connect_timeout: Duration,
    stall_timeout: Duration,
    sender: Option<SendRequest<Empty<Bytes>>>,
}

/// The head of an answer, and its body as it comes.
#[derive(Debug)]
pub(super) struct Reply {
    pub(super) status: StatusCode,
    /// The entity tag, if it is a strong one.
    pub(super) tag: Option<String>,
    /// Of a 206 answer; `None` if absent or malformed.
    pub(super) content_range: Option<ContentRange>,
    /// Whether the body is as the file is, without a content coding.
    pub(super) is_plain: bool,
    body: Incoming,
    stall_timeout: Duration,
}

impl Transport {
    pub(super) fn new(url: SceneUrl, connect_timeout: Duration, stall_timeout: Duration) -> Self {
        Self { url, connect_timeout, stall_timeout, sender: None }
    }

    /// Drops the connection: needed wherever a body was not read to its end.
    pub(super) fn close(&mut self) {
        self.sender = None;
    }

    /// Asks for a file of the directory or a range of it; with `tag`, for the range only if the file still has
    /// that tag, else for the whole.
    ///
    /// # Errors
    /// If no connection can be had or it breaks before the head of the answer is in.
    pub(super) async fn get(
        &mut self,
        name: &str,
        range: Option<&Range<u64>>,
        tag: Option<&str>,
    ) -> Result<Reply, Broken> {
        if let Some(mut sender) = self.sender.take() {
            // A server may close an idle connection at any moment: that is no failure yet.
            if sender.ready().await.is_ok()
                && let Ok(reply) = self.ask(&mut sender, name, range, tag).await
            {
                self.sender = Some(sender);
                return Ok(reply);
            }
        }
        let mut sender = self.connect().await?;
        let reply = self.ask(&mut sender, name, range, tag).await?;
        self.sender = Some(sender);
        Ok(reply)
    }

    async fn connect(&self) -> Result<SendRequest<Empty<Bytes>>, Broken> {
        let opening = async {
            let stream = TcpStream::connect(self.url.address()).await.map_err(Broken::new)?;
            // Requests are small and waited for.
            stream.set_nodelay(true).map_err(Broken::new)?;
            let (sender, connection) = http1::handshake(TokioIo::new(stream)).await.map_err(Broken::new)?;
            // Ends when the sender is dropped or the server closes; failures show at the sender.
            tokio::spawn(connection);
            Ok(sender)
        };
        let late =
            || Broken::new(format_args!("no connection to {} within {:?}", self.url, self.connect_timeout));
        timeout(self.connect_timeout, opening).await.map_err(|_| late())?
    }

    async fn ask(
        &self,
        sender: &mut SendRequest<Empty<Bytes>>,
        name: &str,
        range: Option<&Range<u64>>,
        tag: Option<&str>,
    ) -> Result<Reply, Broken> {
        let mut request = Request::builder()
            .method(Method::GET)
            .uri(self.url.target(name))
            .header(header::HOST, self.url.host_field())
            .header(header::ACCEPT_ENCODING, "identity");
        if let Some(range) = range {
            request = request.header(header::RANGE, range_field(range));
            if let Some(tag) = tag {
                request = request.header(header::IF_RANGE, tag);
            }
        }
        let request = request.body(Empty::new()).map_err(Broken::new)?;
        let answer = timeout(self.stall_timeout, sender.send_request(request));
        let answer = answer.await.map_err(|_| stalled(self.stall_timeout))?.map_err(Broken::new)?;
        let field = |name| answer.headers().get(name).and_then(|value| value.to_str().ok());
        Ok(Reply {
            status: answer.status(),
            tag: field(header::ETAG).filter(|tag| is_strong(tag)).map(str::to_owned),
            content_range: field(header::CONTENT_RANGE).and_then(parse_content_range),
            is_plain: field(header::CONTENT_ENCODING)
                .is_none_or(|coding| coding.eq_ignore_ascii_case("identity")),
            stall_timeout: self.stall_timeout,
            body: answer.into_body(),
        })
    }
}

impl Reply {
    /// The next piece of the body, `None` at its end.
    ///
    /// # Errors
    /// If the connection breaks or nothing arrives in time.
    pub(super) async fn piece(&mut self) -> Result<Option<Bytes>, Broken> {
        loop {
            let frame = timeout(self.stall_timeout, self.body.frame());
            match frame.await.map_err(|_| stalled(self.stall_timeout))? {
                None => return Ok(None),
                Some(Err(error)) => return Err(Broken::new(error)),
                Some(Ok(frame)) => {
                    // Trailers say nothing of use.
                    if let Ok(data) = frame.into_data() {
                        return Ok(Some(data));
                    }
                }
            }
        }
    }
}

/// A range up to `u64::MAX` has no end.
fn range_field(range: &Range<u64>) -> String {
    match range.end {
        u64::MAX => format!("bytes={}-", range.start),
        end => format!("bytes={}-{}", range.start, end.saturating_sub(1)),
    }
}

fn stalled(time: Duration) -> Broken {
    Broken::new(format_args!("nothing arrived for {time:?}"))
}
