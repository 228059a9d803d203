//! The server against requests written by hand: RFC 9110 ranges and conditions, what must not be reachable, and
//! its limits.

mod support;

use std::io::{Read, Write};
use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;

use ivg_stream::{ServeError, ServerHandle, ServerOptions, serve};
use support::http::{PATIENCE, connect, get, receive, request, send};
use tokio::runtime::Runtime;
use tokio::sync::oneshot;

const CONTENT: &[u8] = b"0123456789";

struct Running {
    runtime: Runtime,
    handle: ServerHandle,
    stop: Option<oneshot::Sender<()>>,
    directory: tempfile::TempDir,
}

impl Running {
    /// A server of a directory with `ten.ivg`, which holds [`CONTENT`].
    fn start(change: impl FnOnce(&mut ServerOptions)) -> Self {
        let directory = tempfile::tempdir().unwrap();
        std::fs::create_dir(directory.path().join("scene")).unwrap();
        std::fs::write(directory.path().join("scene/ten.ivg"), CONTENT).unwrap();
        std::fs::write(directory.path().join("secret"), "secret").unwrap();
        let runtime =
            tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
        let mut options = ServerOptions::default();
        change(&mut options);
        let (stop, stopped) = oneshot::channel::<()>();
        let until = async move { stopped.await.unwrap_or(()) };
        let handle = runtime.block_on(serve(&directory.path().join("scene"), options, until)).unwrap();
        Self { runtime, handle, stop: Some(stop), directory }
    }

    fn addr(&self) -> SocketAddr {
        self.handle.address
    }

    fn write(&self, name: &str, content: &[u8]) {
        std::fs::write(self.directory.path().join("scene").join(name), content).unwrap();
    }

    fn ask_to_stop(&mut self) {
        self.stop.take().unwrap().send(()).unwrap();
    }

    fn has_stopped(&mut self) -> bool {
        let handle = &mut self.handle;
        self.runtime.block_on(async { tokio::time::timeout(PATIENCE, &mut handle.join).await }).is_ok()
    }
}

#[test]
fn a_file_is_served_whole_and_in_ranges() {
    let server = Running::start(|_| ());
    let whole = get(server.addr(), "/ten.ivg", &[]);
    assert_eq!((whole.status, whole.body.as_slice()), (200, CONTENT));
    assert_eq!(whole.field("accept-ranges"), Some("bytes"));
    assert_eq!(whole.field("content-type"), Some("application/vnd.ivg.irradiance-grid"));
    // SHA-256 of the ten digits, from coreutils' sha256sum.
    let tag = "\"84d89877f0d4041efb6bf91a16f0248f2fd573e6af05c19f96bedb9f882f7882\"";
    assert_eq!(whole.field("etag"), Some(tag));

    for (range, status, body, described) in [
        ("bytes=0-0", 206, &b"0"[..], Some("bytes 0-0/10")),
        ("bytes=3-5", 206, b"345", Some("bytes 3-5/10")),
        ("bytes=7-", 206, b"789", Some("bytes 7-9/10")),
        ("bytes=-2", 206, b"89", Some("bytes 8-9/10")),
        ("bytes=8-100", 206, b"89", Some("bytes 8-9/10")),
        ("bytes=0-1,4-5", 200, CONTENT, None),
        ("lines=0-1", 200, CONTENT, None),
    ] {
        let reply = get(server.addr(), "/ten.ivg", &[&format!("Range: {range}")]);
        assert_eq!((reply.status, reply.body.as_slice()), (status, body), "{range}");
        assert_eq!(reply.field("content-range"), described, "{range}");
        assert_eq!(reply.field("etag"), Some(tag), "{range}");
    }
    let beyond = get(server.addr(), "/ten.ivg", &["Range: bytes=10-"]);
    assert_eq!((beyond.status, beyond.field("content-range")), (416, Some("bytes */10")));
}

#[test]
fn conditions_compare_tags() {
    let server = Running::start(|_| ());
    let tag = get(server.addr(), "/ten.ivg", &[]).field("etag").unwrap().to_owned();
    let range = "Range: bytes=1-2";
    for (fields, status, body) in [
        (vec![range.to_owned(), format!("If-Range: {tag}")], 206, "12"),
        (vec![range.to_owned(), "If-Range: \"other\"".to_owned()], 200, "0123456789"),
        (vec![range.to_owned(), format!("If-Range: W/{tag}")], 200, "0123456789"),
        (vec![range.to_owned(), "If-Range: Sat, 01 Jan 2000 00:00:00 GMT".to_owned()], 200, "0123456789"),
        (vec![format!("If-None-Match: {tag}")], 304, ""),
        (vec![format!("If-None-Match: W/{tag}")], 304, ""),
        (vec!["If-None-Match: \"other\"".to_owned()], 200, "0123456789"),
        (vec![format!("If-Match: {tag}"), range.to_owned()], 206, "12"),
        (vec!["If-Match: \"other\"".to_owned()], 412, "the file has changed\n"),
    ] {
        let lines: Vec<&str> = fields.iter().map(String::as_str).collect();
        let reply = get(server.addr(), "/ten.ivg", &lines);
        assert_eq!(
            (reply.status, String::from_utf8_lossy(&reply.body).as_ref()),
            (status, body),
            "{fields:?}"
        );
    }
}

#[test]
fn the_tag_follows_the_content_even_at_equal_length() {
    let server = Running::start(|_| ());
    let first = get(server.addr(), "/ten.ivg", &[]).field("etag").unwrap().to_owned();
    server.write("ten.ivg", b"9876543210");
    let second = get(server.addr(), "/ten.ivg", &["Range: bytes=0-1", &format!("If-Range: {first}")]);
    assert_ne!(second.field("etag"), Some(first.as_str()));
    assert_eq!((second.status, second.body.as_slice()), (200, &b"9876543210"[..]));
    server.write("ten.ivg", CONTENT);
    assert_eq!(get(server.addr(), "/ten.ivg", &[]).field("etag"), Some(first.as_str()));
}

#[test]
fn head_tells_what_get_would_send_without_a_body() {
    let server = Running::start(|_| ());
    let mut stream = connect(server.addr());
    send(&mut stream, "HEAD", "/ten.ivg", &["Range: bytes=1-2"]).unwrap();
    let head = receive(&mut stream, "HEAD").unwrap();
    // Ranges are defined for GET only (RFC 9110, 14.2).
    assert_eq!((head.status, head.field("content-length")), (200, Some("10")));
    // A body would stand before this answer.
    send(&mut stream, "GET", "/ten.ivg", &["Range: bytes=4-4"]).unwrap();
    assert_eq!(receive(&mut stream, "GET").unwrap().body, b"4");
}

#[test]
fn other_methods_are_refused_and_named() {
    let server = Running::start(|_| ());
    for method in ["PUT", "POST", "DELETE", "PATCH", "TRACE"] {
        let reply = request(server.addr(), method, "/ten.ivg", &["Content-Length: 0"]);
        assert_eq!((reply.status, reply.field("allow")), (405, Some("GET, HEAD, OPTIONS")), "{method}");
    }
    assert_eq!(get(server.addr(), "/ten.ivg", &[]).body, CONTENT);
}

#[test]
fn other_origins_may_read_ranges_if_allowed() {
    let server = Running::start(|_| ());
    let reply = get(server.addr(), "/ten.ivg", &["Origin: http://elsewhere", "Range: bytes=0-0"]);
    assert_eq!(reply.field("access-control-allow-origin"), Some("*"));
    let exposed = reply.field("access-control-expose-headers").unwrap();
    assert!(
        ["ETag", "Content-Range", "Accept-Ranges"].iter().all(|name| exposed.contains(name)),
        "{exposed}"
    );
    let preflight =
        request(server.addr(), "OPTIONS", "/ten.ivg", &["Access-Control-Request-Headers: if-range"]);
    assert_eq!(preflight.status, 204);
    assert!(preflight.field("access-control-allow-headers").unwrap().contains("If-Range"));

    let closed = Running::start(|options| options.cors = false);
    assert_eq!(get(closed.addr(), "/ten.ivg", &[]).field("access-control-allow-origin"), None);
}

#[test]
fn nothing_outside_the_directory_is_reachable() {
    let server = Running::start(|_| ());
    let scene = server.directory.path().join("scene");
    server.write(".hidden", b"hidden");
    std::fs::create_dir(scene.join("inner")).unwrap();
    server.write("inner/a.pmesh", b"inside");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../secret", scene.join("link-out")).unwrap();
        std::os::unix::fs::symlink("..", scene.join("directory-out")).unwrap();
        std::os::unix::fs::symlink("ten.ivg", scene.join("link-in")).unwrap();
        std::os::unix::fs::symlink("loop", scene.join("loop")).unwrap();
        assert_eq!(get(server.addr(), "/link-in", &[]).body, CONTENT, "links inside are followed");
    }
    assert_eq!(get(server.addr(), "/inner/a.pmesh", &[]).body, b"inside");
    let absolute = format!("/{}", server.directory.path().join("secret").display());
    for path in [
        "/",
        "/inner",
        "/inner/",
        "/missing",
        "/ten.ivg/",
        "/ten.ivg/x",
        "/../secret",
        "/inner/../../secret",
        "/%2e%2e/secret",
        "/..%2fsecret",
        "/inner/..%5c..%5csecret",
        "/..\\secret",
        "/link-out",
        "/directory-out/secret",
        "/loop",
        "/.hidden",
        "/%2ehidden",
        "/ten.ivg%00",
        "/%zz",
        "//etc/passwd",
        "/etc/passwd",
        absolute.as_str(),
        "http://test/../secret",
        "*",
    ] {
        let reply = get(server.addr(), path, &[]);
        // 400 where hyper refuses the request line before our code sees it.
        assert!(matches!(reply.status, 404 | 400), "{path}: {}", reply.status);
        let body = String::from_utf8_lossy(&reply.body);
        assert!(!body.contains("secret") && !body.contains("hidden"), "{path}: {body}");
    }
    assert_eq!(get(server.addr(), "http://test/ten.ivg", &[]).body, CONTENT, "absolute form of a request");
}

#[test]
fn a_large_file_arrives_whole() {
    let server = Running::start(|_| ());
    let large: Vec<u8> = (0..3_000_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    server.write("large.pmesh", &large);
    assert!(get(server.addr(), "/large.pmesh", &[]).body == large);
    let range = get(server.addr(), "/large.pmesh", &["Range: bytes=1000000-2000000"]);
    assert!(range.body == large[1_000_000..=2_000_000]);
}

#[test]
fn a_request_head_that_dawdles_is_cut_off() {
    let server = Running::start(|options| options.header_timeout = Duration::from_millis(200));
    let mut stream = connect(server.addr());
    stream.write_all(b"GET /ten.ivg HTTP/1.1\r\nHost: te").unwrap();
    // Closed or reset by the server; without its limit this waits until the socket's own limit and fails.
    let mut rest = Vec::new();
    let ended = stream.read_to_end(&mut rest);
    assert!(ended.is_ok() || ended.is_err_and(|e| e.kind() == std::io::ErrorKind::ConnectionReset));
    assert!(!rest.starts_with(b"HTTP/1.1 2"));
}

#[test]
fn an_answer_that_nobody_takes_is_cut_off() {
    let server = Running::start(|options| {
        options.request_timeout = Duration::from_millis(200);
        options.max_connections = 1;
    });
    // Larger than what the socket buffers of both sides take up, so that the server has to wait for the reader.
    server.write("huge.pmesh", &vec![7; 64 << 20]);
    let mut stalled = connect(server.addr());
    send(&mut stalled, "GET", "/huge.pmesh", &[]).unwrap();
    // The only slot is free again once the stalled answer is dropped.
    assert_eq!(get(server.addr(), "/ten.ivg", &[]).body, CONTENT);
    let mut rest = Vec::new();
    let taken = stalled.read_to_end(&mut rest).map_or(rest.len(), |n| n);
    assert!(taken < 64 << 20, "the stalled answer was sent whole");
}

#[test]
fn a_head_that_is_too_long_is_refused() {
    let server = Running::start(|options| options.max_header_bytes = 8192);
    let long = format!("X: {}", "x".repeat(20_000));
    assert_eq!(get(server.addr(), "/ten.ivg", &[&long]).status, 431);
    let many: Vec<String> = (0..100).map(|i| format!("X{i}: 1")).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    assert_eq!(get(server.addr(), "/ten.ivg", &many).status, 431);
}

#[test]
fn connections_beyond_the_limit_wait() {
    let server = Running::start(|options| options.max_connections = 1);
    let mut first = connect(server.addr());
    send(&mut first, "GET", "/ten.ivg", &[]).unwrap();
    receive(&mut first, "GET").unwrap();
    let mut second = connect(server.addr());
    send(&mut second, "GET", "/ten.ivg", &[]).unwrap();
    second.set_read_timeout(Some(Duration::from_millis(300))).unwrap();
    assert!(receive(&mut second, "GET").is_err(), "served beyond the limit");
    drop(first);
    second.set_read_timeout(Some(PATIENCE)).unwrap();
    assert_eq!(receive(&mut second, "GET").unwrap().body, CONTENT);
}

#[test]
fn a_stop_lets_answers_end_and_refuses_new_ones() {
    let mut server = Running::start(|options| options.stop_timeout = Duration::from_secs(60));
    let huge = vec![7; 32 << 20];
    server.write("huge.pmesh", &huge);
    let mut busy = connect(server.addr());
    send(&mut busy, "GET", "/huge.pmesh", &[]).unwrap();
    let mut first = [0; 16];
    busy.read_exact(&mut first).unwrap();
    assert_eq!(&first[..13], b"HTTP/1.1 200 ");
    let idle = connect(server.addr());
    server.ask_to_stop();
    let mut rest = Vec::new();
    busy.read_to_end(&mut rest).unwrap();
    assert!(rest.ends_with(&huge), "the answer under way was cut off");
    assert!(server.has_stopped());
    assert!(std::net::TcpStream::connect_timeout(&server.addr(), Duration::from_secs(2)).is_err());
    drop(idle);
}

#[test]
fn a_stop_does_not_wait_for_ever() {
    let mut server = Running::start(|options| options.stop_timeout = Duration::from_millis(200));
    server.write("huge.pmesh", &vec![7; 64 << 20]);
    let mut stalled = connect(server.addr());
    send(&mut stalled, "GET", "/huge.pmesh", &[]).unwrap();
    stalled.read_exact(&mut [0; 16]).unwrap();
    server.ask_to_stop();
    assert!(server.has_stopped());
}

#[test]
fn what_cannot_be_served_is_said() {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let try_serve = |path: &Path, options| runtime.block_on(serve(path, options, std::future::pending()));
    let directory = tempfile::tempdir().unwrap();
    let missing = try_serve(&directory.path().join("none"), ServerOptions::default()).unwrap_err();
    assert!(
        matches!(&missing, ServeError::Directory { .. }) && missing.to_string().contains("none"),
        "{missing}"
    );
    let taken = try_serve(directory.path(), ServerOptions::default()).unwrap().address;
    let options = ServerOptions { address: taken, ..ServerOptions::default() };
    assert!(matches!(try_serve(directory.path(), options).unwrap_err(), ServeError::Listen { .. }));
    let options = ServerOptions { max_connections: 0, ..ServerOptions::default() };
    assert!(matches!(try_serve(directory.path(), options).unwrap_err(), ServeError::Option { .. }));
}
