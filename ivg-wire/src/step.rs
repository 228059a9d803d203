//! The answer of every push reader.

/// What a reader made of the bytes it was shown.
///
/// The caller owns the buffer. After [`Step::Consumed`] it drops that many bytes from the front and asks
/// again; after [`Step::NeedMore`] it keeps all bytes, appends more and asks again with the longer input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use = "the caller must drop the consumed bytes, or fetch the missing ones"]
pub enum Step<E> {
    /// The input is a proper prefix of something valid so far; at least this many more bytes are needed.
    NeedMore(usize),
    /// This many bytes from the front of the input made this event.
    Consumed(usize, E),
}

impl<E> Step<E> {
    /// The same step with its event converted.
    pub fn map<F>(self, convert: impl FnOnce(E) -> F) -> Step<F> {
        match self {
            Self::NeedMore(n) => Step::NeedMore(n),
            Self::Consumed(n, event) => Step::Consumed(n, convert(event)),
        }
    }
}
