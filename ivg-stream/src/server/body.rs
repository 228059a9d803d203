//! Bodies of answers: nothing, a short text, or part of a file read piece by piece.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};

use bytes::Bytes;
use hyper::body::{Body, Frame, SizeHint};
use tokio::fs::File;
use tokio::io::{AsyncRead, ReadBuf};

use super::connection::Pace;

/// Most bytes of a file in memory for one answer.
pub(super) const PIECE_BYTES: u64 = 64 * 1024;

/// The body of an answer.
#[derive(Debug)]
pub(super) enum Answer {
    /// No body.
    Empty,
    /// A short text.
    Text(Bytes),
    /// The next `remaining` bytes of a file.
    File { file: File, remaining: u64, pace: Arc<Pace> },
}

impl Body for Answer {
    type Data = Bytes;
    type Error = io::Error;

    fn poll_frame(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, io::Error>>> {
        let this = self.get_mut();
        match this {
            Self::Empty => Poll::Ready(None),
            Self::Text(text) => {
                let text = std::mem::take(text);
                *this = Self::Empty;
                Poll::Ready(Some(Ok(Frame::data(text))))
            }
            Self::File { remaining: 0, .. } => Poll::Ready(None),
            Self::File { file, remaining, pace } => {
                pace.touch();
                let wanted = usize::try_from(PIECE_BYTES.min(*remaining)).unwrap_or(usize::MAX);
                let mut piece = vec![0; wanted];
                let mut buffer = ReadBuf::new(&mut piece);
                ready!(Pin::new(file).poll_read(context, &mut buffer))?;
                let filled = buffer.filled().len();
                if filled == 0 {
                    // The file was cut after its length was promised: breaking the connection tells the client.
                    return Poll::Ready(Some(Err(io::ErrorKind::UnexpectedEof.into())));
                }
                piece.truncate(filled);
                *remaining -= filled as u64;
                Poll::Ready(Some(Ok(Frame::data(piece.into()))))
            }
        }
    }

    fn is_end_stream(&self) -> bool {
        matches!(self, Self::Empty | Self::File { remaining: 0, .. })
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact(match self {
            Self::Empty => 0,
            Self::Text(text) => text.len() as u64,
            Self::File { remaining, .. } => *remaining,
        })
    }
}
