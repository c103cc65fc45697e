//! `waymark config acl`, enforced by a real router: who may do what, and that the doctor sees a refusal.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use leader::Edit;
use leader::client::{ClientError, LandmarkClient};
use runtime::SessionSettings;
use serde_json::{Value, json};
use tokio::time::timeout;
use waymark_proto::keys::VehicleKeys;
use zenoh::Session;

use crate::convoy::{Convoy, free_address, landmark};
use crate::program::waymark;

const LONG: Duration = Duration::from_secs(20);
const USERS: [&str; 5] = ["leader", "follower", "other", "operator", "stranger"];

/// A router that asks for passwords and has the printed access control.
struct Guarded {
    convoy: Convoy,
    directory: tempfile::TempDir,
}

impl Guarded {
    fn begin() -> Self {
        let directory = tempfile::tempdir().unwrap();
        let printed = waymark([
            "config",
            "acl",
            "--identify",
            "user",
            "--leader",
            "leader",
            "--follower",
            "follower",
            "--follower",
            "other",
            "--operator",
            "operator",
        ]);
        let printed = printed.ended(0).stdout;
        let (_comment, document) = printed.split_once('\n').unwrap();
        let mut config: Value = serde_json::from_str(document).unwrap();
        let passwords = directory.path().join("passwords");
        fs::write(&passwords, USERS.map(|user| format!("{user}:secret-of-{user}\n")).concat()).unwrap();
        let endpoint = format!("tcp/{}", free_address());
        config["mode"] = json!("router");
        config["listen"] = json!({ "endpoints": [endpoint] });
        config["scouting"] = json!({ "multicast": { "enabled": false } });
        config["transport"] = json!({ "auth": { "usrpwd": {
            "user": "router", "password": "secret-of-router", "dictionary_file": passwords,
        } } });
        let settings = settings(directory.path(), "router", &config);
        Self { convoy: Convoy::around(endpoint, &settings), directory }
    }

    fn file_of(&self, user: &str) -> PathBuf {
        let config = json!({
            "mode": "client",
            "connect": { "endpoints": [self.convoy.endpoint] },
            "scouting": { "multicast": { "enabled": false } },
            "transport": { "auth": { "usrpwd": { "user": user, "password": format!("secret-of-{user}") } } },
        });
        settings(self.directory.path(), user, &config).file.unwrap()
    }

    fn session(&self, user: &str) -> Session {
        let settings = SessionSettings { file: Some(self.file_of(user)), ..SessionSettings::default() };
        self.convoy.block_on(settings.open()).unwrap()
    }

    fn leader_as(&self, user: &str) -> LandmarkClient {
        LandmarkClient::new(self.session(user), VehicleKeys::new("convoy", "leader").unwrap())
    }
}

fn settings(directory: &Path, name: &str, config: &Value) -> SessionSettings {
    let file = directory.join(format!("{name}.json5"));
    fs::write(&file, config.to_string()).unwrap();
    SessionSettings { file: Some(file), ..SessionSettings::default() }
}

#[test]
fn landmarks_are_the_leaders_and_changes_the_operators() {
    let guarded = Guarded::begin();
    let _leader = guarded.convoy.lead(guarded.session("leader"));
    let publish = Edit { publish: vec![landmark("blue")], ..Edit::default() };
    let (follower, operator) = (guarded.leader_as("follower"), guarded.leader_as("operator"));
    guarded.convoy.block_on(async {
        assert_eq!(follower.list().await.unwrap().landmarks.len(), 1);
        assert_eq!(operator.edit(&publish).await.unwrap().count, 2);
        let refused = follower.edit(&publish).await.unwrap_err();
        assert!(matches!(refused, ClientError::NoAnswer { .. }), "{refused}");
    });
}

#[test]
fn a_vehicle_writes_only_below_its_own_keys() {
    let guarded = Guarded::begin();
    let (own, other) = (guarded.session("follower"), guarded.session("other"));
    guarded.convoy.block_on(async {
        let heard = other.declare_subscriber("waymark/v1/convoy/**").await.unwrap();
        let hearing = async {
            loop {
                // What must not arrive is sent before what must.
                for forbidden in ["leader/landmark/red", "leader/manifest", "other/status"] {
                    own.put(format!("waymark/v1/convoy/{forbidden}"), "x").await.unwrap();
                }
                own.put("waymark/v1/convoy/follower/status", "x").await.unwrap();
                if let Ok(Ok(sample)) = timeout(Duration::from_millis(50), heard.recv_async()).await {
                    return sample.key_expr().to_string();
                }
            }
        };
        assert_eq!(timeout(LONG, hearing).await.unwrap(), "waymark/v1/convoy/follower/status");
    });
}

#[test]
fn the_doctor_sees_who_is_refused() {
    let guarded = Guarded::begin();
    let publications = |user: &str| {
        let file = format!("zenoh.file={}", guarded.file_of(user).display());
        let vehicle = format!("vehicle={user}");
        let found = waymark(["doctor", "--json", "--set", &file, "--set", &vehicle]).ended(1).stdout;
        let report: Value = serde_json::from_str(&found).unwrap();
        let checks = report["checks"].as_array().unwrap();
        let found = checks.iter().find(|found| found["check"] == "publications").unwrap();
        (found["verdict"].clone(), found["remedy"].clone())
    };
    assert_eq!(publications("follower").0, "yes");
    let (verdict, remedy) = publications("stranger");
    assert_eq!(verdict, "no");
    assert!(remedy.as_str().unwrap().contains("waymark config acl"), "{remedy}");
}
