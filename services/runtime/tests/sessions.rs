//! Sessions over loopback TCP: routing, reconnecting, presence.

#![allow(clippy::unwrap_used)] // a test's helpers may fail the test

use std::net::TcpListener;
use std::time::Duration;

use runtime::presence::{Presence, PresenceError, PresencePlace, clock_offset, members, who_is_there};
use runtime::{Identity, SessionSettings, Shutdown, StateDir};
use tokio::time::timeout;

const LONG: Duration = Duration::from_secs(20);

/// An endpoint on a port that was free a moment ago.
fn free_endpoint() -> String {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    format!("tcp/127.0.0.1:{port}")
}

fn place(instance: &str) -> PresencePlace {
    PresencePlace {
        own_key: format!("@waymark/v1/rink/v1/follower/{instance}"),
        siblings: "@waymark/v1/rink/v1/follower/*".to_owned(),
    }
}

/// Puts until the subscriber hears one: routes spread without saying when they are there.
async fn heard_through(publisher: &zenoh::Session, subscriber: &zenoh::Session, key: &str) {
    let samples = subscriber.declare_subscriber(key).await.unwrap();
    let hearing = async {
        loop {
            publisher.put(key, "x").await.unwrap();
            if timeout(Duration::from_millis(50), samples.recv_async()).await.is_ok() {
                return;
            }
        }
    };
    timeout(LONG, hearing).await.expect("nothing arrived through the router");
}

#[tokio::test(flavor = "multi_thread")]
async fn vehicles_hear_each_other_through_a_router_that_comes_late_and_returns() {
    let endpoint = free_endpoint();
    let one = SessionSettings::vehicle(&endpoint).open().await.unwrap();
    let other = SessionSettings::vehicle(&endpoint).open().await.unwrap();
    for _ in 0..2 {
        let router = SessionSettings::router(&endpoint).open().await.unwrap();
        heard_through(&one, &other, "test/data").await;
        assert!(runtime::session::is_router_connected(&one).await);
        router.close().await.unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_without_a_router_fails_in_time_and_says_where() {
    let endpoint = free_endpoint();
    let settings = SessionSettings { open_timeout_s: 0.3, ..SessionSettings::client(&endpoint) };
    let error = timeout(LONG, settings.open()).await.unwrap().unwrap_err().to_string();
    assert!(error.contains(&endpoint) && error.contains("is the router running"), "{error}");
    assert!(!error.contains(".rs:"), "a place in Zenoh's source: {error}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_second_instance_elsewhere_is_refused_and_a_restart_is_not() {
    let endpoint = free_endpoint();
    let _router = SessionSettings::router(&endpoint).open().await.unwrap();
    let places = tempfile::tempdir().unwrap();
    let first_state = StateDir::open(&places.path().join("first")).unwrap();
    let second_state = StateDir::open(&places.path().join("second")).unwrap();
    let (first_id, second_id) = (Identity::on(&first_state), Identity::on(&second_state));
    let first = SessionSettings::client(&endpoint).open().await.unwrap();
    let second = SessionSettings::client(&endpoint).open().await.unwrap();

    let held = Presence::claim(&first, &place(&first_id.instance), &first_id, "1").await.unwrap();
    let refused = Presence::claim(&second, &place(&second_id.instance), &second_id, "1").await;
    let Err(PresenceError::AlreadyPresent { first: named, .. }) = refused else { panic!("not refused") };
    assert_eq!(named.instance, first_id.instance);

    // A restart with the first one's state directory takes over while the old process still answers.
    let restarted_id = Identity::on(&first_state);
    let restarted =
        Presence::claim(&second, &place(&restarted_id.instance), &restarted_id, "1").await.unwrap();
    drop(held);
    let there = who_is_there(&first, "@waymark/v1/rink/*/*/*").await.unwrap();
    assert_eq!(there.len(), 1, "{there:?}");
    assert!(there[0].established);
    drop(restarted);
}

#[tokio::test(flavor = "multi_thread")]
async fn of_two_that_start_together_one_stays() {
    let endpoint = free_endpoint();
    let _router = SessionSettings::router(&endpoint).open().await.unwrap();
    let places = tempfile::tempdir().unwrap();
    let mut claims = Vec::new();
    for name in ["one", "other"] {
        let session = SessionSettings::client(&endpoint).open().await.unwrap();
        let identity = Identity::on(&StateDir::open(&places.path().join(name)).unwrap());
        claims.push(tokio::spawn(async move {
            let claim = Presence::claim(&session, &place(&identity.instance), &identity, "1").await;
            (session, claim)
        }));
    }
    let mut stayed = 0;
    let mut outcomes = Vec::new();
    for claim in claims {
        let (session, claim) = claim.await.unwrap();
        stayed += usize::from(claim.is_ok());
        outcomes.push((session, claim));
    }
    assert_eq!(stayed, 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_clock_of_a_process_on_this_machine_is_not_off() {
    let endpoint = free_endpoint();
    let _router = SessionSettings::router(&endpoint).open().await.unwrap();
    let places = tempfile::tempdir().unwrap();
    let identity = Identity::on(&StateDir::open(places.path()).unwrap());
    let asked = SessionSettings::client(&endpoint).open().await.unwrap();
    let asking = SessionSettings::client(&endpoint).open().await.unwrap();
    let _presence = Presence::claim(&asked, &place(&identity.instance), &identity, "1").await.unwrap();
    let own_key = place(&identity.instance).own_key;
    let offset = clock_offset(&asking, &own_key).await.unwrap().expect("an answer");
    assert!(offset.offset_ns.abs() <= offset.round_trip_ns, "{offset:?}");
    assert_eq!(clock_offset(&asking, "@waymark/v1/rink/v9/follower/*").await.unwrap(), None);
}

#[tokio::test(flavor = "multi_thread")]
async fn of_two_that_could_not_hear_each_other_the_later_leaves_once_they_can() {
    let endpoints = [free_endpoint(), free_endpoint()];
    let places = tempfile::tempdir().unwrap();
    let mut halves = Vec::new();
    for endpoint in &endpoints {
        let router = SessionSettings::router(endpoint).open().await.unwrap();
        let session = SessionSettings::client(endpoint).open().await.unwrap();
        let state = StateDir::open(&places.path().join(endpoint.replace('/', "-"))).unwrap();
        let identity = Identity::on(&state);
        let held = Presence::claim(&session, &place(&identity.instance), &identity, "1").await.unwrap();
        halves.push((router, session, state, identity, held));
    }
    let (early, late) = (&halves[0], &halves[1]);
    let bridge = SessionSettings { connect: endpoints.to_vec(), ..SessionSettings::default() };
    let _bridge = bridge.open().await.unwrap();

    let shutdown = Shutdown::new();
    let ((), superseded) =
        timeout(LONG, late.4.hold(shutdown.requested(), &shutdown)).await.expect("nobody left");
    let Some(PresenceError::AlreadyPresent { first, .. }) = superseded else { panic!("{superseded:?}") };
    assert_eq!(first.instance, early.3.instance);
    assert!(shutdown.is_requested());
    let there = who_is_there(&late.1, &place("").siblings).await.unwrap();
    assert!(there.iter().any(|process| process.instance == early.3.instance), "{there:?}");
    assert!(timeout(Duration::from_millis(1), early.4.superseded()).await.is_err());
}

#[tokio::test(flavor = "multi_thread")]
async fn members_are_those_who_answer_and_those_who_are_only_announced() {
    let endpoint = free_endpoint();
    let _router = SessionSettings::router(&endpoint).open().await.unwrap();
    let places = tempfile::tempdir().unwrap();
    let identity = Identity::on(&StateDir::open(places.path()).unwrap());
    let there = SessionSettings::client(&endpoint).open().await.unwrap();
    let _answers = Presence::claim(&there, &place(&identity.instance), &identity, "1.2.3").await.unwrap();
    let _silent = there.liveliness().declare_token("@waymark/v1/rink/v2/leader/silent").await.unwrap();
    let asking = SessionSettings::vehicle(&endpoint).visit().await.unwrap();
    let found = members(&asking, "@waymark/v1/rink/*/*/*").await.unwrap();
    let versions: Vec<_> = found.iter().map(|one| one.introduction.as_ref().map(|it| &*it.version)).collect();
    assert_eq!(versions, [Some("1.2.3"), None], "{found:?}");
    assert!(found[0].clock.is_some() && found[1].clock.is_none(), "{found:?}");
}
