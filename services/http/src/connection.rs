//! One connection, with limits on how long its client may take to ask and to read.

use crate::bare_answer::BareAnswers;
use crate::counters::{Counters, Refusal};
use crate::policy::Policy;
use crate::problem::{PROBLEM_JSON, Problem};
use crate::stall::StallGuard;
use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::io;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

/// Bytes that may wait in the kernel for a client; a slow client then skips pictures instead of seeing old ones.
const NOT_SENT_LOW_WATER_BYTES: u32 = 128 << 10;

/// Bytes that may wait in the process for a client, for the same reason; also bounds what is read ahead of it.
const MAX_BUFFERED_BYTES: usize = 128 << 10;

/// What every connection of a listener is served under.
#[derive(Clone, Debug)]
pub(crate) struct Terms {
    pub(crate) policy: Arc<Policy>,
    pub(crate) counters: Arc<Counters>,
    /// Cancelled when the service closes.
    pub(crate) closing: CancellationToken,
}

/// Serves one connection until its client leaves, breaks the terms, or the service closes.
pub(crate) async fn serve_connection(stream: TcpStream, router: Router, terms: Terms) {
    let Terms { policy, counters, closing } = terms;
    // Neither option is needed for correctness; a socket that refuses them still serves.
    let _ = stream.set_nodelay(true);
    let _ = socket2::SockRef::from(&stream).set_tcp_notsent_lowat(NOT_SENT_LOW_WATER_BYTES);
    let guarded = StallGuard::new(stream, policy.stall_timeout, Arc::clone(&counters));
    let io = TokioIo::new(BareAnswers::new(guarded, Arc::clone(&counters)));
    let mut connection = pin!(
        http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(policy.header_timeout)
            .max_header_size(policy.max_header_bytes)
            .max_buf_size(MAX_BUFFERED_BYTES)
            .serve_connection(io, TowerToHyperService::new(router))
    );
    let ended = tokio::select! {
        ended = connection.as_mut() => ended,
        () = closing.cancelled() => {
            connection.as_mut().graceful_shutdown();
            connection.await
        }
    };
    if let Err(error) = ended {
        tracing::debug!(%error, "a connection ended early");
        if error.is_timeout() {
            counters.count(Refusal::SlowHeader);
        }
    }
}

/// Says 503 on a connection there is no room for, and reads on briefly so that the answer is not lost to a reset.
pub(crate) async fn apologise(mut stream: TcpStream) {
    const RETRY_AFTER: Duration = Duration::from_secs(5);
    let problem = Problem::unavailable("too many connections; try again in 5 seconds", RETRY_AFTER);
    let body = problem.to_json().to_string();
    let answer = format!(
        "HTTP/1.1 503 Service Unavailable\r\ncontent-type: {PROBLEM_JSON}\r\nretry-after: {}\r\n\
         content-length: {}\r\nconnection: close\r\n\r\n{body}",
        RETRY_AFTER.as_secs(),
        body.len(),
    );
    let exchange = async {
        stream.write_all(answer.as_bytes()).await?;
        stream.shutdown().await?;
        let mut discarded = [0; 4096];
        while stream.read(&mut discarded).await? > 0 {}
        Ok::<_, io::Error>(())
    };
    // A peer that does not take it is closed all the same.
    let _ = timeout(Duration::from_secs(1), exchange).await;
}
