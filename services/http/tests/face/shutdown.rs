//! The end: streams end, waiting reads are answered, nothing holds the process.

use crate::server::{Server, read_to_end, read_until};
use http_face::Policy;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::time::timeout;

#[tokio::test]
async fn attached_viewers_do_not_hold_the_shutdown() {
    let server = Server::start(Policy::default()).await;
    server.publish(1, 3);
    let mut streams = Vec::new();
    for (target, sign) in
        [("/api/v1/cameras/front/stream.mjpeg", "xxx"), ("/api/v1/events", "retry:"), ("/livez", "}")]
    {
        let mut stream = server.connect().await;
        let request = format!("GET {target} HTTP/1.1\r\nHost: localhost\r\n\r\n");
        stream.write_all(request.as_bytes()).await.unwrap();
        read_until(&mut stream, sign).await;
        streams.push(stream);
    }
    let mut waiting = server.connect().await;
    waiting
        .write_all(b"GET /api/v1/cameras/front/frame.jpg?after=1 HTTP/1.1\r\nHost: localhost\r\n\r\n")
        .await
        .unwrap();
    let _silent = server.connect().await;
    let report = timeout(Duration::from_secs(10), server.stop()).await.unwrap();
    assert_eq!(report.dropped_at_deadline, 0);
    // A chunked body that ends properly ends with an empty chunk.
    assert!(read_to_end(streams.remove(0)).await.ends_with("0\r\n\r\n"));
    assert!(read_to_end(streams.remove(0)).await.ends_with("0\r\n\r\n"));
}

#[tokio::test]
async fn a_client_that_takes_nothing_is_dropped_at_the_deadline() {
    let server =
        Server::start(Policy { shutdown_deadline: Duration::from_millis(100), ..Policy::default() }).await;
    server.publish(1, 32 << 20);
    let mut stuck = server.connect().await;
    stuck
        .write_all(b"GET /api/v1/cameras/front/frame.jpg HTTP/1.1\r\nHost: localhost\r\n\r\n")
        .await
        .unwrap();
    read_until(&mut stuck, "xxx").await;
    let report = timeout(Duration::from_secs(10), server.stop()).await.unwrap();
    assert_eq!(report.dropped_at_deadline, 1);
}
