//! From a request to an answer: methods, conditions, ranges, fields (RFC 9110).

use std::io::{self, SeekFrom};
use std::ops::Range;
use std::sync::Arc;

use hyper::body::Incoming;
use hyper::header::{self, HeaderMap, HeaderName, HeaderValue};
use hyper::{Method, Request, Response, StatusCode};
use tokio::io::AsyncSeekExt;

use super::Shared;
use super::body::Answer;
use super::connection::Pace;
use super::files::Opened;
use crate::http::range::{Asked, parse_range};
use crate::http::{media, tag};

const METHODS: HeaderValue = HeaderValue::from_static("GET, HEAD, OPTIONS");

/// Answers one request; never fails, since every failure has a status.
pub(super) async fn answer(
    request: &Request<Incoming>,
    shared: &Shared,
    pace: &Arc<Pace>,
) -> Response<Answer> {
    pace.pause();
    let mut response = match *request.method() {
        Method::GET | Method::HEAD => match shared.files.find(request.uri().path()).await {
            Ok(Some(opened)) => send(request, opened, pace).await.unwrap_or_else(|error| unreadable(&error)),
            Ok(None) => text(StatusCode::NOT_FOUND, "no such file in this scene directory\n"),
            Err(error) => unreadable(&error),
        },
        Method::OPTIONS => allowing(empty(StatusCode::NO_CONTENT)),
        _ => allowing(text(StatusCode::METHOD_NOT_ALLOWED, "files here can be read only: GET and HEAD\n")),
    };
    pace.touch();
    common_fields(response.headers_mut(), shared.options.cors, request.method() == Method::OPTIONS);
    if request.method() == Method::HEAD {
        let length = hyper::body::Body::size_hint(response.body()).lower();
        response.headers_mut().entry(header::CONTENT_LENGTH).or_insert_with(|| length.into());
        *response.body_mut() = Answer::Empty;
    }
    response
}

/// A file that exists: conditions first, then the range, in the order of RFC 9110 section 13.2.2.
async fn send(request: &Request<Incoming>, opened: Opened, pace: &Arc<Pace>) -> io::Result<Response<Answer>> {
    let Opened { file, path, length, tag } = opened;
    let headers = request.headers();
    let mut response = if field(headers, header::IF_MATCH)
        .is_some_and(|list| !tag::any_strong_match(&list, &tag))
    {
        text(StatusCode::PRECONDITION_FAILED, "the file has changed\n")
    } else if field(headers, header::IF_NONE_MATCH).is_some_and(|list| tag::any_weak_match(&list, &tag)) {
        empty(StatusCode::NOT_MODIFIED)
    } else {
        match asked(request, &tag, length) {
            Asked::Unsatisfiable => {
                let mut response = text(StatusCode::RANGE_NOT_SATISFIABLE, "the file is shorter than that\n");
                response.headers_mut().insert(header::CONTENT_RANGE, value(&format!("bytes */{length}"))?);
                response
            }
            Asked::Whole => part(file, 0..length, StatusCode::OK, pace).await?,
            Asked::Part(range) => {
                let described = format!("bytes {}-{}/{length}", range.start, range.end - 1);
                let mut response = part(file, range, StatusCode::PARTIAL_CONTENT, pace).await?;
                response.headers_mut().insert(header::CONTENT_RANGE, value(&described)?);
                response
            }
        }
    };
    let is_file = response.status().is_success();
    let fields = response.headers_mut();
    fields.insert(header::ETAG, value(&tag)?);
    fields.insert(header::ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    // A file may be replaced at any moment; caches ask again, which the tag makes cheap.
    fields.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache, no-transform"));
    if is_file {
        fields.insert(header::CONTENT_TYPE, HeaderValue::from_static(media::media_type(&path)));
    }
    Ok(response)
}

/// The range asked for; ranges are defined for GET only, and only while `If-Range` names the present tag.
fn asked(request: &Request<Incoming>, tag: &str, length: u64) -> Asked {
    let headers = request.headers();
    // Sent twice, a field has no meaning that could be relied on.
    let mut ranges = headers.get_all(header::RANGE).iter();
    let (Some(range), None) = (ranges.next(), ranges.next()) else { return Asked::Whole };
    let unchanged = field(headers, header::IF_RANGE).is_none_or(|held| tag::is_strong(&held) && held == tag);
    match range.to_str() {
        Ok(range) if request.method() == Method::GET && unchanged => parse_range(range, length),
        _ => Asked::Whole,
    }
}

async fn part(
    file: std::fs::File,
    range: Range<u64>,
    status: StatusCode,
    pace: &Arc<Pace>,
) -> io::Result<Response<Answer>> {
    let mut file = tokio::fs::File::from_std(file);
    file.seek(SeekFrom::Start(range.start)).await?;
    let body = Answer::File { file, remaining: range.end - range.start, pace: Arc::clone(pace) };
    Ok(with_status(Response::new(body), status))
}

fn common_fields(fields: &mut HeaderMap, cors: bool, is_preflight: bool) {
    const MOST_PREFLIGHT_SECONDS: HeaderValue = HeaderValue::from_static("86400");
    fields.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    if !cors {
        return;
    }
    fields.insert(header::ACCESS_CONTROL_ALLOW_ORIGIN, HeaderValue::from_static("*"));
    let exposed = HeaderValue::from_static("ETag, Content-Range, Accept-Ranges, Content-Length");
    fields.insert(header::ACCESS_CONTROL_EXPOSE_HEADERS, exposed);
    if is_preflight {
        let conditions = HeaderValue::from_static("Range, If-Range, If-Match, If-None-Match");
        fields.insert(header::ACCESS_CONTROL_ALLOW_HEADERS, conditions);
        fields.insert(header::ACCESS_CONTROL_ALLOW_METHODS, METHODS);
        fields.insert(header::ACCESS_CONTROL_MAX_AGE, MOST_PREFLIGHT_SECONDS);
    }
}

fn field(headers: &HeaderMap, name: HeaderName) -> Option<String> {
    // A field that is no text cannot name a tag: it counts as one that matches nothing.
    headers.get(name).map(|value| value.to_str().unwrap_or_default().trim().to_owned())
}

fn value(text: &str) -> io::Result<HeaderValue> {
    HeaderValue::from_str(text).map_err(io::Error::other)
}

fn unreadable(error: &io::Error) -> Response<Answer> {
    match error.kind() {
        io::ErrorKind::PermissionDenied => text(StatusCode::FORBIDDEN, "the server may not read this file\n"),
        io::ErrorKind::ResourceBusy => {
            let mut response = text(StatusCode::SERVICE_UNAVAILABLE, "the file is being written\n");
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
            response
        }
        _ => text(StatusCode::INTERNAL_SERVER_ERROR, "the server cannot read this file\n"),
    }
}

fn allowing(mut response: Response<Answer>) -> Response<Answer> {
    response.headers_mut().insert(header::ALLOW, METHODS);
    response
}

fn empty(status: StatusCode) -> Response<Answer> {
    with_status(Response::new(Answer::Empty), status)
}

fn text(status: StatusCode, text: &'static str) -> Response<Answer> {
    let mut response = with_status(Response::new(Answer::Text(text.into())), status);
    response
        .headers_mut()
        .insert(header::CONTENT_TYPE, HeaderValue::from_static("text/plain; charset=utf-8"));
    response
}

fn with_status(mut response: Response<Answer>, status: StatusCode) -> Response<Answer> {
    *response.status_mut() = status;
    response
}
