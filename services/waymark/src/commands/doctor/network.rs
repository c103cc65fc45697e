//! Whether the others can be reached, and everything that can only be asked then.

use std::time::Instant;

use runtime::SessionSettings;
use runtime::session::{Mode, is_router_connected};
use zenoh::Session;

use super::finding::Finding;
use super::subject::Subject;
use super::{cameras, echo, fleet, landmarks};

pub(super) async fn examine(subject: &Subject) -> Vec<Finding> {
    let names_nobody = subject.zenoh.file.is_none() && subject.zenoh.connect.is_empty();
    if names_nobody && !subject.zenoh.multicast {
        let found = "zenoh.connect names nobody: others must connect to this service";
        return without_session(Finding::not_applicable("router", found));
    }
    let began = Instant::now();
    match subject.zenoh.visit().await {
        Ok(session) => {
            let router = router(&session, subject, began).await;
            let findings = with_session(&session, router, subject).await;
            // Whatever does not close is closed by the end of the process.
            let _ = session.close().await;
            findings
        }
        Err(error) => {
            let remedy = "start `waymark router` there, or set zenoh.connect to where it listens; with TLS, see that \
                          its certificate is signed by the authority of zenoh.file and has not expired";
            without_session(Finding::no("router", error.to_string(), remedy))
        }
    }
}

async fn router(session: &Session, subject: &Subject, began: Instant) -> Finding {
    let reached = format!("{} reached in {} ms", place(&subject.zenoh), began.elapsed().as_millis());
    if is_router_connected(session).await || subject.zenoh.mode == Mode::Peer {
        return Finding::yes("router", reached);
    }
    let remedy =
        "start `waymark router` and set zenoh.connect to it: vehicles hear each other through a router";
    Finding::no("router", format!("{reached}, but it is no router"), remedy)
}

fn place(zenoh: &SessionSettings) -> String {
    zenoh.file.as_ref().map_or_else(|| zenoh.connect.join(", "), |file| format!("that of {}", file.display()))
}

async fn with_session(session: &Session, router: Finding, subject: &Subject) -> Vec<Finding> {
    let (echo, fleet, landmarks) = tokio::join!(
        echo::examine(session, subject),
        fleet::examine(session, subject),
        landmarks::examine(session, subject),
    );
    // Pictures only now: they would lengthen the round trips that clocks are compared by.
    let cameras = cameras::examine(session, subject).await;
    [vec![router, echo], fleet, vec![landmarks], cameras].concat()
}

fn without_session(router: Finding) -> Vec<Finding> {
    let unseen = ["publications", "clocks", "versions", "landmarks", "cameras"];
    let unseen = unseen.map(|check| Finding::not_applicable(check, "nobody is reached to ask"));
    [vec![router], unseen.to_vec()].concat()
}
