//! What is let in, and how refusals read.

use crate::server::{Server, status};
use http_face::{Policy, Token};
use std::sync::atomic::Ordering;

#[tokio::test]
async fn the_page_comes_with_security_headers_and_is_sent_once() {
    let server = Server::start(Policy::default()).await;
    let answer = server.get("/").await;
    assert_eq!(status(&answer), 200);
    for header in [
        "content-security-policy: default-src 'none'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "content-type: text/html",
    ] {
        assert!(answer.contains(header), "{header} in {answer}");
    }
    let tag = answer.lines().find_map(|line| line.strip_prefix("etag: ")).unwrap();
    let again = server.ask("GET", "/", &format!("If-None-Match: {tag}\r\n"), "").await;
    assert_eq!(status(&again), 304);
}

#[tokio::test]
async fn names_that_try_to_leave_the_page_are_not_found() {
    let server = Server::start(Policy::default()).await;
    for target in
        ["/../Cargo.toml", "/%2e%2e/Cargo.toml", "/..%2fCargo.toml", "/index.html%00", "//etc/passwd", "/no"]
    {
        let answer = server.get(target).await;
        assert_eq!(status(&answer), 404, "{target}: {answer}");
        assert!(answer.contains("content-type: application/problem+json"), "{target}: {answer}");
    }
}

#[tokio::test]
async fn foreign_hosts_and_origins_are_refused_and_change_nothing() {
    let server = Server::start(Policy::default()).await;
    let foreign =
        server.ask("POST", "/change", "Origin: https://evil.example\r\nContent-Length: 0\r\n", "").await;
    assert_eq!(status(&foreign), 403);
    let refused = server.get("/refused").await;
    assert!(refused.contains(r#"("host", 0), ("origin", 1)"#), "{refused}");
    let mut stream = server.connect().await;
    tokio::io::AsyncWriteExt::write_all(&mut stream, b"GET /livez HTTP/1.1\r\nHost: evil.example\r\n\r\n")
        .await
        .unwrap();
    let answer = crate::server::read_until(&mut stream, "}").await;
    assert_eq!(status(&answer), 403);
    assert_eq!(server.changes.load(Ordering::SeqCst), 0);
    let own = server.ask("POST", "/change", "Origin: http://127.0.0.1\r\nContent-Length: 2\r\n", "ab").await;
    assert!(own.ends_with("\r\n\r\n2"), "{own}");
    assert_eq!(server.changes.load(Ordering::SeqCst), 1);
}

#[tokio::test]
async fn changes_need_the_token_once_there_is_one() {
    let policy = Policy { token: Token::new("0123456789abcdef"), ..Policy::default() };
    let server = Server::start(policy).await;
    let without = server.ask("POST", "/change", "Content-Length: 0\r\n", "").await;
    assert_eq!(status(&without), 401);
    assert!(without.contains("www-authenticate: Bearer"), "{without}");
    let with = "Authorization: Bearer 0123456789abcdef\r\nContent-Length: 0\r\n";
    assert_eq!(status(&server.ask("POST", "/change", with, "").await), 200);
    let answer = server.get("/access").await;
    assert!(answer.contains("x-waymark-access: token\r\n") && answer.ends_with("token"), "{answer}");
}

#[tokio::test]
async fn too_long_too_large_and_too_much_are_problems() {
    let server = Server::start(Policy::default()).await;
    for length in [5 << 10, 64 << 10, 200 << 10] {
        let answer = server.get(&format!("/livez?{}", "a".repeat(length))).await;
        assert!(matches!(status(&answer), 414 | 431), "{length}: {answer}");
        assert!(answer.contains("application/problem+json"), "{length}: {answer}");
    }
    let large = "x".repeat(3 << 20);
    let head = format!("Content-Length: {}\r\n", large.len());
    let answer = server.ask("POST", "/change", &head, &large).await;
    assert_eq!(status(&answer), 413, "{answer}");
    assert!(answer.contains("\"max_bytes\":1048576"), "{answer}");
    assert_eq!(server.changes.load(Ordering::SeqCst), 0);
}

#[tokio::test]
async fn what_is_not_http_is_a_problem_too() {
    let server = Server::start(Policy::default()).await;
    let answer = server.ask("GET", "/a b", "", "").await;
    assert_eq!(status(&answer), 400, "{answer}");
    assert!(answer.contains("application/problem+json"), "{answer}");
    let answer = server.ask("DELETE", "/livez", "", "").await;
    assert_eq!(status(&answer), 405, "{answer}");
    assert!(answer.contains("allow: GET,HEAD"), "{answer}");
}

#[tokio::test]
async fn health_gives_a_reason_for_each_check() {
    let server = Server::start(Policy::default()).await;
    assert!(server.get("/livez").await.contains(r#"{"name":"process","ok":true,"reason":"runs"}"#));
    let ready = server.get("/readyz").await;
    assert_eq!(status(&ready), 503);
    assert!(ready.contains(r#""reason":"the disk is full""#), "{ready}");
}
