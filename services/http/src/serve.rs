//! The accept loop: bounded connections, bounded headers, and an end at shutdown whatever is attached.
//!
//! `axum::serve` has no header timeout and waits for ever on open streams at shutdown, hence a loop of our own.

use crate::connection::{Terms, apologise, serve_connection};
use crate::counters::Refusal;
use crate::policy::{Access, Policy};
use crate::shell::{Shell, wrap};
use axum::Router;
use std::io;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;
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

/// Clients told at once that there is no room; more are closed without a word.
const MAX_APOLOGIES: usize = 64;

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
    let terms =
        Terms { policy: Arc::new(policy), counters: Arc::default(), closing: CancellationToken::new() };
    let mut open = Connections::new(wrap(router, Shell::new(terms.clone(), access)), terms);
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
    terms: Terms,
    tasks: JoinSet<()>,
    apologies: JoinSet<()>,
    report: ServeReport,
}

impl Connections {
    fn new(router: Router, terms: Terms) -> Self {
        let (tasks, apologies) = (JoinSet::new(), JoinSet::new());
        Self { router, terms, tasks, apologies, report: ServeReport::default() }
    }

    fn take(&mut self, stream: TcpStream) {
        while self.apologies.try_join_next().is_some() {}
        if self.tasks.len() < self.terms.policy.max_connections {
            self.report.served += 1;
            self.tasks.spawn(serve_connection(stream, self.router.clone(), self.terms.clone()));
            return;
        }
        self.report.turned_away += 1;
        self.terms.counters.count(Refusal::Connections);
        if self.apologies.len() < MAX_APOLOGIES {
            self.apologies.spawn(apologise(stream));
        }
    }

    async fn close(mut self) -> ServeReport {
        self.terms.closing.cancel();
        let drained = async { while self.tasks.join_next().await.is_some() {} };
        if timeout(self.terms.policy.shutdown_deadline, drained).await.is_err() {
            self.report.dropped_at_deadline = self.tasks.len() as u64;
        }
        self.report
    }
}
