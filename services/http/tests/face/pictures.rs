//! Pictures and events as a viewer gets them.

use crate::server::{Server, read_until, status};
use http_face::Policy;
use tokio::io::AsyncWriteExt;

#[tokio::test]
async fn a_picture_says_which_frame_it_shows() {
    let server = Server::start(Policy::default()).await;
    assert_eq!(status(&server.get("/api/v1/cameras/front/frame.jpg").await), 503);
    server.publish(7, 3);
    let answer = server.get("/api/v1/cameras/front/overlay.jpg?layers=gate&width=320&quality=50").await;
    assert!(answer.contains("x-waymark-sequence: 7\r\n"), "{answer}");
    assert!(answer.contains("x-waymark-captured-at: 1000\r\n"), "{answer}");
    assert!(answer.contains("x-waymark-age-ms: "), "{answer}");
    assert!(answer.ends_with("Some([\"gate\"]) Some(320) Some(50) xxx"), "{answer}");
    assert!(server.get("/api/v1/cameras/front/frame.jpg").await.ends_with("None None None xxx"));
    assert!(server.get("/api/v1/cameras/front/overlay.png").await.contains("content-type: image/png"));
}

#[tokio::test]
async fn a_jpeg_is_passed_on_as_it_came_to_all_who_ask_for_no_more() {
    let server = Server::start(Policy::default()).await;
    server.publish_source(7, b"JPEG".to_vec());
    let at = "/api/v1/cameras/front";
    assert!(server.get(&format!("{at}/frame.jpg")).await.ends_with("\r\n\r\nJPEG"));
    assert!(server.get(&format!("{at}/overlay.jpg?layers=")).await.ends_with("\r\n\r\nJPEG"));
    assert!(server.get(&format!("{at}/seen")).await.contains("\r\n\r\nJPEG\r\n--"));
    assert_eq!(server.cameras.encoded().collect::<Vec<_>>(), [("front", 0)]);
    for made in
        ["frame.jpg?quality=80", "frame.jpg?width=320", "overlay.jpg", "seen?layers=gate", "seen?format=png"]
    {
        assert!(server.get(&format!("{at}/{made}")).await.contains(" JPEG"), "{made}");
    }
    assert_eq!(server.cameras.encoded().collect::<Vec<_>>(), [("front", 5)]);
}

/// However fast pictures follow each other, what is told with one is told of it.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn picture_and_what_was_seen_in_it_are_of_the_same_frame() {
    let server = std::sync::Arc::new(Server::start(Policy::default()).await);
    server.publish_source(1, b"J".to_vec());
    let feeding = tokio::spawn({
        let server = std::sync::Arc::clone(&server);
        async move {
            for sequence in (2..=200).cycle() {
                server.publish_source(sequence, vec![b'J'; sequence as usize]);
                tokio::task::yield_now().await;
            }
        }
    });
    let mut seen = 0;
    for _ in 0..200 {
        let answer = server.get(&format!("/api/v1/cameras/front/seen?after={seen}")).await;
        let field = |name: &str| answer.lines().find_map(|line| line.strip_prefix(name)).unwrap().to_owned();
        seen = field("x-waymark-sequence: ").parse().unwrap();
        assert!(answer.contains(&format!("{{\"bytes\":{seen}}}")), "{answer}");
        assert!(answer.contains(&format!("\r\n\r\n{}\r\n--", "J".repeat(seen))), "{answer}");
    }
    feeding.abort();
}

#[tokio::test]
async fn cameras_and_layers_are_listed() {
    let server = Server::start(Policy::default()).await;
    let answer = server.get("/api/v1/cameras").await;
    assert!(answer.ends_with(r#"{"cameras":["front"],"layers":["outline","gate"]}"#), "{answer}");
}

#[tokio::test]
async fn a_long_poll_gets_the_next_picture() {
    let server = Server::start(Policy::default()).await;
    server.publish(7, 3);
    let mut waiting = server.connect().await;
    let request = b"GET /api/v1/cameras/front/frame.jpg?after=7 HTTP/1.1\r\nHost: [::1]\r\n\r\n";
    waiting.write_all(request).await.unwrap();
    server.publish(8, 3);
    let answer = read_until(&mut waiting, "xxx").await;
    assert!(answer.contains("x-waymark-sequence: 8\r\n"), "{answer}");
}

#[tokio::test]
async fn unknown_and_out_of_range_values_are_named() {
    let server = Server::start(Policy::default()).await;
    server.publish(7, 3);
    let cases = [
        ("overlay.jpg?width=1e9", "width"),
        ("overlay.jpg?layers=gate,halo", "layers"),
        ("overlay.jpg?colour=red", "colour"),
        ("overlay.png?quality=50", "quality"),
        ("frame.jpg?layers=gate", "layers"),
        ("frame.jpg?after=-1", "after"),
        ("seen?format=bmp", "format"),
        ("seen?layers=halo", "layers"),
        ("seen?format=png&quality=0", "quality"),
        ("stream.mjpeg?fps=0", "fps"),
        ("stream.mjpeg?overlay=maybe", "overlay"),
    ];
    for (target, parameter) in cases {
        let answer = server.get(&format!("/api/v1/cameras/front/{target}")).await;
        assert_eq!(status(&answer), 400, "{answer}");
        assert!(answer.contains(&format!("\"parameter\":\"{parameter}\"")), "{answer}");
    }
    assert_eq!(status(&server.get("/api/v1/cameras/rear/frame.jpg").await), 404);
}

#[tokio::test]
async fn motion_jpeg_sends_each_new_picture_as_a_part() {
    let server = Server::start(Policy::default()).await;
    server.publish(1, 3);
    let mut stream = server.connect().await;
    let request =
        b"GET /api/v1/cameras/front/stream.mjpeg?fps=60&overlay=false HTTP/1.1\r\nHost: localhost\r\n\r\n";
    stream.write_all(request).await.unwrap();
    let first = read_until(&mut stream, "xxx").await;
    assert!(first.contains("content-type: multipart/x-mixed-replace; boundary=waymark-frame"), "{first}");
    assert!(
        first.contains("--waymark-frame\r\ncontent-type: image/jpeg\r\ncontent-length: 18\r\n"),
        "{first}"
    );
    assert!(first.contains("x-waymark-sequence: 1\r\n"), "{first}");
    server.publish(2, 3);
    assert!(read_until(&mut stream, "xxx").await.contains("x-waymark-sequence: 2\r\n"));
}

#[tokio::test]
async fn events_flow_and_resume() {
    let server = Server::start(Policy::default()).await;
    server.events.publish("camera", &1).unwrap();
    server.events.publish("camera", &2).unwrap();
    let mut stream = server.connect().await;
    let request = b"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\nLast-Event-ID: 1\r\n\r\n";
    stream.write_all(request).await.unwrap();
    let text = read_until(&mut stream, "data: 2\n\n").await;
    assert!(text.contains("content-type: text/event-stream"), "{text}");
    assert!(!text.contains("data: 1\n"), "{text}");
    server.events.publish("camera", &3).unwrap();
    read_until(&mut stream, "id: 3\nevent: camera\ndata: 3\n\n").await;
}
