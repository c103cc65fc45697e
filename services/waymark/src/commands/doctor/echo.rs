//! Whether what this vehicle publishes comes back to it through the router.

use std::time::{Duration, Instant};

use tokio::sync::mpsc;
use tokio::time::timeout;
use waymark_proto::keys::{Id, Resource};
use zenoh::Session;
use zenoh::qos::CongestionControl;

use super::finding::Finding;
use super::subject::Subject;

const CHECK: &str = "publications";
const WITHIN: Duration = Duration::from_secs(3);
const EVERY: Duration = Duration::from_millis(50);

/// Puts from one session and listens with another one: within one session a sample would not go through the router.
pub(super) async fn examine(session: &Session, subject: &Subject) -> Finding {
    let remedy = "where the router has access control, let this vehicle write and read below its own keys: \
                  `waymark config acl` prints what it needs";
    match round_trip(session, subject).await {
        Ok(Some(took)) => {
            Finding::yes(CHECK, format!("come back through the router in {:.1} ms", took.as_secs_f64() * 1e3))
        }
        Ok(None) => Finding::no(CHECK, format!("none came back within {} s", WITHIN.as_secs()), remedy),
        Err(reason) => Finding::no(CHECK, reason.to_string(), remedy),
    }
}

async fn round_trip(session: &Session, subject: &Subject) -> anyhow::Result<Option<Duration>> {
    let sender = subject.zenoh.visit().await?;
    let echo = subject.keys.key(Resource::Echo(Id::new("session", &session.zid().to_string())?)).to_string();
    let (heard, mut hearing) = mpsc::channel(1);
    let _listening = session
        .declare_subscriber(&echo)
        .callback(move |sample| drop(heard.try_send(sample.payload().to_bytes().into_owned())))
        .await
        .map_err(anyhow::Error::from_boxed)?;
    let began = Instant::now();
    let mut took = None;
    // Routes spread without saying when they are there, so it is said again until it is heard.
    for count in 0u32.. {
        if took.is_some() || began.elapsed() > WITHIN {
            break;
        }
        let put_at = Instant::now();
        let put = sender.put(&echo, count.to_le_bytes().to_vec()).congestion_control(CongestionControl::Drop);
        put.await.map_err(anyhow::Error::from_boxed)?;
        if let Ok(Some(_)) = timeout(EVERY, hearing.recv()).await {
            took = Some(put_at.elapsed());
        }
    }
    let _ = sender.close().await;
    Ok(took)
}
