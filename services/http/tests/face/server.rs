//! A running web face and a client that speaks plain bytes.

use axum::routing::{get, post};
use axum::{Extension, Router};
use http_face::{
    Access, Api, Cameras, Check, Counters, Depiction, Events, Picture, PictureRequest, Policy, ServeReport,
    health, page, serve,
};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

pub(crate) const LAYERS: &[&str] = &["outline", "gate"];

pub(crate) struct Server {
    pub(crate) address: SocketAddr,
    pub(crate) cameras: Arc<Cameras<Vec<u8>>>,
    pub(crate) events: Arc<Events>,
    pub(crate) changes: Arc<AtomicU32>,
    stop: CancellationToken,
    task: JoinHandle<ServeReport>,
}

impl Server {
    pub(crate) async fn start(policy: Policy) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let depiction = Depiction {
            render: Arc::new(|source: &Vec<u8>, request: &PictureRequest| Ok(draw(source, request))),
            // A picture of capital letters is a JPEG here.
            own_jpeg: |source| {
                source.first().is_some_and(u8::is_ascii_uppercase).then(|| source.clone().into())
            },
            told: Some(Arc::new(|source: &Vec<u8>| Ok(format!("{{\"bytes\":{}}}", source.len())))),
        };
        let cameras = Arc::new(Cameras::new(["front".to_owned()], LAYERS, depiction));
        let events = Arc::new(Events::new(64));
        let changes = Arc::new(AtomicU32::new(0));
        let router = router(&cameras, &events, &changes);
        let stop = CancellationToken::new();
        let task = tokio::spawn(serve(listener, router, policy, stop.clone().cancelled_owned()));
        Self { address, cameras, events, changes, stop, task }
    }

    pub(crate) async fn connect(&self) -> TcpStream {
        TcpStream::connect(self.address).await.unwrap()
    }

    /// Sends a request on a connection of its own and reads the answer to its end.
    pub(crate) async fn ask(&self, method: &str, target: &str, headers: &str, body: &str) -> String {
        let mut stream = self.connect().await;
        let head =
            format!("{method} {target} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n{headers}\r\n");
        stream.write_all(head.as_bytes()).await.unwrap();
        stream.write_all(body.as_bytes()).await.unwrap();
        read_to_end(stream).await
    }

    pub(crate) async fn get(&self, target: &str) -> String {
        self.ask("GET", target, "", "").await
    }

    pub(crate) fn publish(&self, sequence: u64, bytes: usize) {
        self.publish_source(sequence, vec![b'x'; bytes]);
    }

    pub(crate) fn publish_source(&self, sequence: u64, source: Vec<u8>) {
        let source = Arc::new(source);
        let picture = Picture { sequence, captured_at_ns: 1_000, received_at: Instant::now(), source };
        self.cameras.feed("front").unwrap().publish(picture);
    }

    pub(crate) async fn stop(self) -> ServeReport {
        self.stop.cancel();
        self.task.await.unwrap()
    }
}

fn router(cameras: &Arc<Cameras<Vec<u8>>>, events: &Arc<Events>, changes: &Arc<AtomicU32>) -> Router {
    let (events, changes) = (Arc::clone(events), Arc::clone(changes));
    Router::new()
        .route("/livez", get(|| async { health(vec![Check::pass("process", "runs")]) }))
        .route("/readyz", get(|| async { health(vec![Check::fail("recorder", "the disk is full")]) }))
        .route("/api/v1/events", get(move |headers| async move { events.respond(&headers) }))
        .route(
            "/refused",
            get(|Extension(counters): Extension<Arc<Counters>>| async move {
                format!("{:?}", counters.by_reason())
            }),
        )
        .route("/access", get(|Extension(access): Extension<Access>| async move { access.name() }))
        .route(
            "/change",
            post(move |body: String| async move {
                changes.fetch_add(1, Ordering::SeqCst);
                body.len().to_string()
            }),
        )
        .merge(cameras.routes(Api::new("Test", "1")).undescribed(page()).finish())
}

/// "Draws" a picture: its source, the layers and the quality, so that a test sees what was asked for.
fn draw(source: &[u8], request: &PictureRequest) -> Vec<u8> {
    let mut bytes =
        format!("{:?} {:?} {:?} ", request.layers, request.width_px, request.quality).into_bytes();
    bytes.extend_from_slice(source);
    bytes
}

pub(crate) async fn read_to_end(mut stream: TcpStream) -> String {
    let mut bytes = Vec::new();
    // A reset after the answer still leaves the answer.
    let _ = stream.read_to_end(&mut bytes).await;
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Reads until `wanted` has arrived; gives all that was read.
pub(crate) async fn read_until(stream: &mut TcpStream, wanted: &str) -> String {
    let mut text = String::new();
    let mut chunk = [0; 4096];
    while !text.contains(wanted) {
        let read = stream.read(&mut chunk).await.unwrap();
        assert!(read > 0, "ended before {wanted:?}: {text}");
        text.push_str(&String::from_utf8_lossy(&chunk[..read]));
    }
    text
}

pub(crate) fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0)
}
