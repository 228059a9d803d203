//! One connection: hyper's HTTP/1.1 machine under a deadline that moves with every piece of progress.

use std::convert::Infallible;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::TcpStream;
use tokio::sync::watch;
use tokio::time::Instant;

use super::{Shared, respond};

/// Largest number of header fields of a request.
const MAX_HEADER_FIELDS: usize = 64;

/// The moment by which a connection must have made progress.
#[derive(Debug)]
pub(super) struct Pace {
    deadline: Mutex<Instant>,
    allowed: Duration,
}

impl Pace {
    fn new(allowed: Duration) -> Self {
        Self { deadline: Mutex::new(far(allowed)), allowed }
    }

    /// Progress was made: the time starts anew.
    pub(super) fn touch(&self) {
        self.set(self.allowed);
    }

    /// The server itself has work to do that is not the client's fault.
    pub(super) fn pause(&self) {
        const LONG: Duration = Duration::from_secs(3600);
        self.set(LONG);
    }

    fn set(&self, time: Duration) {
        *self.deadline.lock().unwrap_or_else(PoisonError::into_inner) = far(time);
    }

    async fn expired(&self) {
        loop {
            let deadline = *self.deadline.lock().unwrap_or_else(PoisonError::into_inner);
            if deadline <= Instant::now() {
                return;
            }
            // Looked at again in time: the deadline can come nearer when a pause ends.
            tokio::time::sleep_until(deadline.min(far(self.allowed))).await;
        }
    }
}

/// `time` from now, or a day where that cannot be told.
fn far(time: Duration) -> Instant {
    const DAY: Duration = Duration::from_secs(86_400);
    Instant::now() + time.min(DAY)
}

/// Serves one connection until it ends, breaks, is too slow, or the server stops.
pub(super) async fn run(stream: TcpStream, shared: Arc<Shared>, mut stopping: watch::Receiver<bool>) {
    let options = &shared.options;
    let pace = Arc::new(Pace::new(options.request_timeout));
    let service = service_fn(|request| {
        let (shared, pace) = (Arc::clone(&shared), Arc::clone(&pace));
        async move { Ok::<_, Infallible>(respond::answer(&request, &shared, &pace).await) }
    });
    // Small answers leave at once; a connection where that fails still works.
    let _slower = stream.set_nodelay(true);
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(options.header_timeout)
        .max_buf_size(options.max_header_bytes)
        .max_headers(MAX_HEADER_FIELDS)
        .serve_connection(TokioIo::new(stream), service);
    let mut connection = std::pin::pin!(connection);
    let mut told = *stopping.borrow_and_update();
    if told {
        connection.as_mut().graceful_shutdown();
    }
    loop {
        tokio::select! {
            // How a connection ended is its client's affair.
            _ended = connection.as_mut() => return,
            () = pace.expired() => return,
            _changed = stopping.changed(), if !told => {
                told = true;
                connection.as_mut().graceful_shutdown();
            }
        }
    }
}
