//! Many clients and clients that do not do their part.

use crate::server::{Server, read_to_end, read_until, status};
use http_face::Policy;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::time::timeout;

const MOTION: &[u8] = b"GET /api/v1/cameras/front/stream.mjpeg HTTP/1.1\r\nHost: localhost\r\n\r\n";

fn impatient() -> Policy {
    let short = Duration::from_millis(300);
    Policy { header_timeout: short, body_timeout: short, stall_timeout: short, ..Policy::default() }
}

#[tokio::test]
async fn half_sent_headers_are_cut_off_and_others_served() {
    let server = Server::start(impatient()).await;
    let mut slow = Vec::new();
    for _ in 0..100 {
        let mut stream = server.connect().await;
        stream.write_all(b"GET / HTTP/1.1\r\nX-Slow: ").await.unwrap();
        slow.push(stream);
    }
    assert_eq!(status(&server.get("/livez").await), 200);
    for stream in slow {
        timeout(Duration::from_secs(10), read_to_end(stream)).await.unwrap();
    }
}

#[tokio::test]
async fn a_silent_connection_and_a_slow_body_are_cut_off() {
    let server = Server::start(impatient()).await;
    let silent = server.connect().await;
    timeout(Duration::from_secs(10), read_to_end(silent)).await.unwrap();
    let slow = server.ask("POST", "/change", "Content-Length: 10\r\n", "abc").await;
    assert_eq!(status(&slow), 408, "{slow}");
}

#[tokio::test]
async fn beyond_the_cap_there_is_a_503_that_says_when_to_come_back() {
    let server = Server::start(Policy { max_connections: 2, ..Policy::default() }).await;
    let (mut first, mut second) = (server.connect().await, server.connect().await);
    for stream in [&mut first, &mut second] {
        stream.write_all(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n").await.unwrap();
        read_until(stream, "}").await;
    }
    let refused = read_to_end(server.connect().await).await;
    assert_eq!(status(&refused), 503, "{refused}");
    assert!(refused.contains("retry-after: 5\r\n"), "{refused}");
    drop(first);
    // The freed place is seen once the server has noticed the close.
    while status(&server.get("/livez").await) != 200 {
        tokio::task::yield_now().await;
    }
    assert!(server.stop().await.turned_away >= 1);
}

#[tokio::test]
async fn streams_are_bounded_and_those_that_never_read_are_cut_off() {
    let server = Server::start(impatient()).await;
    server.publish(0, 10);
    let mut watching = Vec::new();
    for _ in 0..16 {
        let mut stream = server.connect().await;
        stream.write_all(MOTION).await.unwrap();
        read_until(&mut stream, "xxx").await;
        watching.push(stream);
    }
    let mut late = server.connect().await;
    late.write_all(MOTION).await.unwrap();
    let refused = read_until(&mut late, "}").await;
    assert_eq!(status(&refused), 503, "{refused}");
    assert!(refused.contains("retry-after: 5\r\n"), "{refused}");

    // Nobody reads on: once the buffers are full each stream is closed and its place is free again.
    let again = async {
        for sequence in 1.. {
            server.publish(sequence, 1 << 20);
            let mut stream = server.connect().await;
            stream.write_all(MOTION).await.unwrap();
            if status(&read_until(&mut stream, "\r\n\r\n").await) == 200 {
                break;
            }
        }
    };
    timeout(Duration::from_secs(10), again).await.unwrap();
    assert_eq!(status(&server.get("/livez").await), 200);
}
