//! `waymark config`.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::program::waymark;
use crate::scene::text;

struct File {
    _directory: tempfile::TempDir,
    path: PathBuf,
}

fn file(name: &str, content: &str) -> File {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    fs::write(&path, content).unwrap();
    File { _directory: directory, path }
}

#[test]
fn show_says_where_every_value_comes_from() {
    let file = file("follower.toml", "vehicle = \"truck-7\"\n[http]\nlisten = \"127.0.0.1:9000\"\n");
    let arguments =
        ["config", "show", "follower", "-c", text(&file.path), "--set", "http.listen=127.0.0.1:9001"];
    let table = waymark(arguments).ended(0).stdout;
    let line = |key: &str| table.lines().find(|line| line.starts_with(key)).unwrap().to_owned();
    assert!(line("vehicle").ends_with("follower.toml"), "{table}");
    assert!(line("http.listen").contains("\"127.0.0.1:9001\""), "{table}");
    assert!(line("http.listen").ends_with("--set http.listen=127.0.0.1:9001"), "{table}");
    assert!(line("prediction").ends_with("default"), "{table}");
    let json = waymark(arguments.iter().chain(&["--json"])).ended(0).stdout;
    let settings: Vec<Value> = serde_json::from_str(&json).unwrap();
    assert!(settings.iter().any(|it| it["key"] == "mode" && it["value"] == "\"adaptive\""), "{json}");
}

#[test]
fn what_is_wrong_is_quoted_with_its_place_and_the_nearest_key() {
    let file = file("leader.toml", "fleet = \"convoy\"\n\n[http]\nlisten_on = \"127.0.0.1:1\"\n");
    for command in ["check", "show"] {
        waymark(["config", command, "leader", "-c", text(&file.path)])
            .ended(2)
            .telling("leader.toml, line 4: nothing reads \"http.listen_on\"; did you mean \"listen\"?")
            .telling("| listen_on = \"127.0.0.1:1\"");
    }
    waymark(["config", "check", "leader", "-c", "no-such.toml"]).ended(2).telling("no-such.toml");
}

#[test]
fn check_looks_at_what_a_start_would_refuse() {
    for service in ["leader", "follower", "camera"] {
        waymark(["config", "check", service]).ended(0).telling("in order");
    }
    let json5 = file("zenoh.json5", "{ mode: 'captain' }");
    let zenoh = format!("zenoh.file={}", json5.path.display());
    for (service, setting, words) in [
        ("follower", "vehicle=\"Truck 7\"", "vehicle is \"Truck 7\""),
        ("follower", "cameras=[\"..\"]", "camera is \"..\""),
        ("follower", "http.token_file=/no/such", "/no/such"),
        ("follower", "mode=magic", "mode"),
        ("leader", "landmarks=[\"/no/such.json\"]", "/no/such.json"),
        ("leader", "zenoh.connect=[\"nowhere\"]", "zenoh.connect"),
        ("leader", zenoh.as_str(), "zenoh.json5"),
        ("leader", "log.filter=leader=loud", "log.filter"),
        ("camera", "source=rtsp://nowhere", "rtsp"),
        ("camera", "jpeg_quality=0", "jpeg_quality is 0"),
    ] {
        waymark(["config", "check", service, "--set", setting]).ended(2).telling(words);
    }
}

#[test]
fn schemas_describe_what_is_accepted() {
    for service in ["leader", "follower", "camera"] {
        let schema: Value =
            serde_json::from_str(&waymark(["config", "schema", service]).ended(0).stdout).unwrap();
        let shown = waymark(["config", "show", service, "--json"]).ended(0).stdout;
        let shown: Vec<Value> = serde_json::from_str(&shown).unwrap();
        for setting in &shown {
            let key = setting["key"].as_str().unwrap();
            let property = key.split('.').fold(&schema, |schema, part| &schema["properties"][part]);
            assert!(property["description"].is_string(), "{service}: no {key} in the schema");
        }
    }
}
