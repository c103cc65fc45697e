//! The accept loop: bounded connections, bounded headers, and an end at shutdown whatever is attached.
//!
//! `axum::serve` has no header timeout and waits for ever on open streams at shutdown, hence a loop of our own.

use crate::bare_answer::BareAnswers;
use crate::policy::{Access, Policy};
use crate::problem::{PROBLEM_JSON, Problem};
use crate::shell::{Shell, wrap};
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
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinSet;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

/// What a listener did in its life.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ServeReport {
    /// Connections served.
    pub served: u64,
    /// Connections turned away with 503 because too many were open.
    pub turned_away: u64,
    /// Connections still open at the shutdown deadline, dropped.
    pub dropped_at_deadline: u64,
}

/// Bytes that may wait in the kernel for a client; a slow client then skips pictures instead of seeing old ones.
const NOT_SENT_LOW_WATER_BYTES: u32 = 128 << 10;

/// Bytes that may wait in the process for a client, for the same reason; also bounds what is read ahead of it.
const MAX_BUFFERED_BYTES: usize = 128 << 10;

/// Clients told at once that there is no room; more are closed without a word.
const MAX_APOLOGIES: usize = 64;

const APOLOGY_RETRY_AFTER: Duration = Duration::from_secs(5);

/// Serves `router` under `policy` until `shutdown` completes, then ends within `policy.shutdown_deadline`.
///
/// At shutdown open streams end, waiting reads are answered with 503, and changes under way are completed.
pub async fn serve(
    listener: TcpListener,
    router: Router,
    policy: Policy,
    shutdown: impl Future<Output = ()>,
) -> ServeReport {
    let access = listener.local_addr().map_or(Access::ReadOnly, |address| policy.access(address.ip()));
    if access == Access::ReadOnly {
        tracing::warn!("other machines can connect and there is no token: the web face is read-only");
    }
    let closing = CancellationToken::new();
    let policy = Arc::new(policy);
    let shell = Shell::new(Arc::clone(&policy), access, closing.clone());
    let mut open = Connections::new(wrap(router, shell), policy, closing);
    let mut shutdown = pin!(shutdown);
    loop {
        tokio::select! {
            () = &mut shutdown => break,
            accepted = listener.accept() => match accepted {
                Ok((stream, _)) => open.take(stream),
                Err(error) => pause_after(&error).await,
            },
            Some(_) = open.tasks.join_next() => {}
        }
    }
    drop(listener);
    open.close().await
}

/// Lets a moment pass when the process has no file left for another connection, instead of spinning.
async fn pause_after(error: &io::Error) {
    tracing::warn!(%error, "cannot accept a connection");
    if !matches!(error.kind(), io::ErrorKind::ConnectionAborted | io::ErrorKind::ConnectionReset) {
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
}

struct Connections {
    router: Router,
    policy: Arc<Policy>,
    closing: CancellationToken,
    tasks: JoinSet<()>,
    apologies: JoinSet<()>,
    report: ServeReport,
}

impl Connections {
    fn new(router: Router, policy: Arc<Policy>, closing: CancellationToken) -> Self {
        let (tasks, apologies) = (JoinSet::new(), JoinSet::new());
        Self { router, policy, closing, tasks, apologies, report: ServeReport::default() }
    }

    fn take(&mut self, stream: TcpStream) {
        while self.apologies.try_join_next().is_some() {}
        if self.tasks.len() < self.policy.max_connections {
            self.report.served += 1;
            let (router, policy, closing) =
                (self.router.clone(), Arc::clone(&self.policy), self.closing.clone());
            self.tasks.spawn(serve_connection(stream, router, policy, closing));
            return;
        }
        self.report.turned_away += 1;
        metrics::counter!("waymark_http_refused_total", "reason" => "connections").increment(1);
        if self.apologies.len() < MAX_APOLOGIES {
            self.apologies.spawn(apologise(stream));
        }
    }

    async fn close(mut self) -> ServeReport {
        self.closing.cancel();
        let drained = async { while self.tasks.join_next().await.is_some() {} };
        if timeout(self.policy.shutdown_deadline, drained).await.is_err() {
            self.report.dropped_at_deadline = self.tasks.len() as u64;
        }
        self.report
    }
}

async fn serve_connection(
    stream: TcpStream,
    router: Router,
    policy: Arc<Policy>,
    closing: CancellationToken,
) {
    // Neither option is needed for correctness; a socket that refuses them still serves.
    let _ = stream.set_nodelay(true);
    let _ = socket2::SockRef::from(&stream).set_tcp_notsent_lowat(NOT_SENT_LOW_WATER_BYTES);
    let io = TokioIo::new(BareAnswers::new(StallGuard::new(stream, policy.stall_timeout)));
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
            metrics::counter!("waymark_http_cut_off_total", "reason" => "slow_header").increment(1);
        }
    }
}

/// Says 503 on a connection there is no room for, and reads on briefly so that the answer is not lost to a reset.
async fn apologise(mut stream: TcpStream) {
    let problem = Problem::unavailable("too many connections; try again in 5 seconds", APOLOGY_RETRY_AFTER);
    let body = problem.to_json().to_string();
    let answer = format!(
        "HTTP/1.1 503 Service Unavailable\r\ncontent-type: {PROBLEM_JSON}\r\nretry-after: {}\r\n\
         content-length: {}\r\nconnection: close\r\n\r\n{body}",
        APOLOGY_RETRY_AFTER.as_secs(),
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
