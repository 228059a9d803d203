//! HTTP/1.1 by hand, so that the server is not tested with its own library's idea of a request.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// Longest wait of any test on a socket; only a failing test waits that long.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

#[derive(Debug)]
pub(crate) struct Reply {
    pub(crate) status: u16,
    pub(crate) fields: Vec<(String, String)>,
    pub(crate) body: Vec<u8>,
}

impl Reply {
    pub(crate) fn field(&self, name: &str) -> Option<&str> {
        self.fields.iter().find(|(n, _)| n.eq_ignore_ascii_case(name)).map(|(_, value)| value.as_str())
    }
}

pub(crate) fn connect(addr: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(addr).expect("connecting to loopback");
    stream.set_read_timeout(Some(PATIENCE)).expect("setting a time limit");
    stream.set_write_timeout(Some(PATIENCE)).expect("setting a time limit");
    stream
}

/// One request on a connection of its own; `fields` as lines without line ends.
pub(crate) fn request(addr: SocketAddr, method: &str, path: &str, fields: &[&str]) -> Reply {
    let mut stream = connect(addr);
    send(&mut stream, method, path, fields).expect("sending a request");
    receive(&mut stream, method).expect("a whole answer")
}

pub(crate) fn get(addr: SocketAddr, path: &str, fields: &[&str]) -> Reply {
    request(addr, "GET", path, fields)
}

pub(crate) fn send(stream: &mut TcpStream, method: &str, path: &str, fields: &[&str]) -> io::Result<()> {
    let fields: String = fields.iter().map(|field| format!("{field}\r\n")).collect();
    stream.write_all(format!("{method} {path} HTTP/1.1\r\nHost: test\r\n{fields}\r\n").as_bytes())
}

/// Reads one answer to its end, as its `Content-Length` says.
pub(crate) fn receive(stream: &mut TcpStream, method: &str) -> io::Result<Reply> {
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte)?;
        head.push(byte[0]);
    }
    let head = String::from_utf8(head).map_err(io::Error::other)?;
    let mut lines = head.lines();
    let status = lines
        .next()
        .and_then(|line| line.split(' ').nth(1)?.parse().ok())
        .ok_or(io::ErrorKind::InvalidData)?;
    let fields: Vec<_> = lines
        .filter_map(|line| {
            line.split_once(':').map(|(name, value)| (name.to_owned(), value.trim().to_owned()))
        })
        .collect();
    let mut reply = Reply { status, fields, body: Vec::new() };
    if method != "HEAD" && status != 304 && status != 204 {
        let length =
            reply.field("content-length").and_then(|n| n.parse().ok()).ok_or(io::ErrorKind::InvalidData)?;
        reply.body.resize(length, 0);
        stream.read_exact(&mut reply.body)?;
    }
    Ok(reply)
}
