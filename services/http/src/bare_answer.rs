//! Gives a body to the answers that hyper makes itself.
//!
//! What hyper cannot parse (a bad request line, too long an address, too large a header) never reaches a route: it
//! answers with a bare 400, 414 or 431. Clients are promised a problem document for every error, so such an answer
//! is recognised on its way out, by lacking the header that every answer of ours carries, and replaced.

use crate::counters::{Counters, Refusal};
use crate::problem::{PROBLEM_JSON, Problem, default_detail};
use axum::http::StatusCode;
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

/// A stream on which bare error answers become problems.
pub(crate) struct BareAnswers<S> {
    stream: S,
    counters: Arc<Counters>,
    /// The answer being sent in place of a bare one, and how much of it is sent.
    replacement: Option<(Vec<u8>, usize)>,
}

impl<S> BareAnswers<S> {
    pub(crate) const fn new(stream: S, counters: Arc<Counters>) -> Self {
        Self { stream, counters, replacement: None }
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for BareAnswers<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, buffer)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for BareAnswers<S> {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let this = &mut *self;
        if this.replacement.is_none() {
            this.replacement = bare_status(bytes).map(|status| {
                this.counters.count(Refusal::Unparseable);
                (problem_answer(status), 0)
            });
        }
        let Some((answer, sent)) = &mut this.replacement else {
            return Pin::new(&mut this.stream).poll_write(cx, bytes);
        };
        while *sent < answer.len() {
            *sent += ready!(Pin::new(&mut this.stream).poll_write(cx, &answer[*sent..]))?;
        }
        this.replacement = None;
        Poll::Ready(Ok(bytes.len()))
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        slices: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        match slices.first() {
            Some(first) if self.replacement.is_some() || bare_status(first).is_some() => {
                self.poll_write(cx, first)
            }
            _ => Pin::new(&mut self.stream).poll_write_vectored(cx, slices),
        }
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

/// The status of an error answer without content that the shell has not seen.
fn bare_status(bytes: &[u8]) -> Option<StatusCode> {
    let status = StatusCode::from_bytes(bytes.strip_prefix(b"HTTP/1.1 ")?.get(..3)?).ok()?;
    if !status.is_client_error() {
        return None;
    }
    let head = std::str::from_utf8(bytes).ok()?;
    let bare = head.contains("\r\ncontent-length: 0\r\n") && !head.contains("\r\nx-content-type-options:");
    bare.then_some(status)
}

fn problem_answer(status: StatusCode) -> Vec<u8> {
    let body = Problem::new(status, default_detail(status)).to_json().to_string();
    let head = format!(
        "HTTP/1.1 {status}\r\ncontent-type: {PROBLEM_JSON}\r\nx-content-type-options: nosniff\r\n\
         content-length: {}\r\nconnection: close\r\n\r\n",
        body.len()
    );
    (head + &body).into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    async fn sent(bytes: &[u8]) -> String {
        let (ours, mut theirs) = tokio::io::duplex(1 << 16);
        BareAnswers::new(ours, Arc::default()).write_all(bytes).await.unwrap();
        let mut text = String::new();
        theirs.read_to_string(&mut text).await.unwrap();
        text
    }

    #[tokio::test]
    async fn a_bare_error_gets_a_problem_and_all_else_passes() {
        let bare = b"HTTP/1.1 414 URI Too Long\r\nconnection: close\r\ncontent-length: 0\r\n\r\n";
        let text = sent(bare).await;
        assert!(text.starts_with("HTTP/1.1 414 URI Too Long\r\n"), "{text}");
        assert!(text.contains("\"status\":414"), "{text}");
        for other in ["HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n", "HTTP/1.1 4", "\x01\x02", ""] {
            assert_eq!(sent(other.as_bytes()).await, other);
        }
    }
}
