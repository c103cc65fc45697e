//! Whether somebody answers with the leader's landmarks.

use leader::client::LandmarkClient;
use zenoh::Session;

use super::finding::Finding;
use super::subject::Subject;

const CHECK: &str = "landmarks";

pub(super) async fn examine(session: &Session, subject: &Subject) -> Finding {
    let Some(leader) = &subject.leader else {
        return Finding::not_applicable(CHECK, format!("a {} follows nobody", subject.role()));
    };
    let client = LandmarkClient::new(session.clone(), leader.clone());
    match client.list().await {
        Ok(set) if set.landmarks.is_empty() => {
            let found = format!("leader {} publishes none", leader.vehicle());
            Finding::no(CHECK, found, "publish some: `waymark landmark publish FILE`")
        }
        Ok(set) => {
            let (count, version) = (set.landmarks.len(), set.version);
            let version = format!("{}.{}", version.epoch, version.version);
            Finding::yes(CHECK, format!("{count} of leader {}, version {version}", leader.vehicle()))
        }
        Err(error) => {
            let remedy = "start `waymark leader`, or `waymark router --store DIR`, which answers for leaders that are \
                          gone; see that `leader` names the right vehicle";
            Finding::no(CHECK, error.to_string(), remedy)
        }
    }
}
