//! Which crate may use which, as ARCHITECTURE.md says: enforced, not remembered.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use serde_json::Value;
use tests::workspace;

/// Every crate with those of ours that it may use.
const ALLOWED: [(&str, &[&str]); 15] = [
    ("vision", &[]),
    ("waymark-proto", &["vision"]),
    ("recording", &["vision", "waymark-proto"]),
    ("video", &["vision"]),
    ("runtime", &[]),
    ("http-face", &[]),
    ("ingest", &["vision", "waymark-proto", "recording", "video", "runtime", "http-face"]),
    ("simulator", &["vision", "waymark-proto", "recording", "video", "runtime", "http-face", "ingest"]),
    ("camera", MEMBER),
    ("leader", MEMBER),
    ("follower", MEMBER),
    ("analysis", MEMBER),
    ("player", MEMBER),
    ("waymark", BINARY),
    ("tests", BINARY),
];
const MEMBER: &[&str] =
    &["vision", "waymark-proto", "recording", "video", "runtime", "http-face", "ingest", "simulator"];
const BINARY: &[&str] = &[
    "vision",
    "waymark-proto",
    "recording",
    "video",
    "runtime",
    "http-face",
    "ingest",
    "simulator",
    "camera",
    "leader",
    "follower",
    "analysis",
    "player",
];

/// What `vision` must not even reach through others: it has no wire, no runtime, no log.
const FORBIDDEN_IN_VISION: [&str; 6] = ["prost", "serde", "zenoh", "tokio", "tracing", "libc"];

#[test]
fn every_crate_uses_only_what_stands_left_of_it() {
    let allowed: BTreeMap<&str, &[&str]> = ALLOWED.into();
    let crates = dependencies_by_crate();
    assert_eq!(
        crates.keys().map(String::as_str).collect::<BTreeSet<_>>(),
        allowed.keys().copied().collect::<BTreeSet<_>>(),
        "the crates of the workspace and of this rule differ"
    );
    for (name, dependencies) in &crates {
        let ours = dependencies.iter().filter(|dependency| crates.contains_key(*dependency));
        let forbidden: Vec<_> =
            ours.filter(|&one| one != name && !allowed[name.as_str()].contains(&one.as_str())).collect();
        assert!(forbidden.is_empty(), "{name} must not use {forbidden:?}");
    }
}

#[test]
fn vision_reaches_no_wire_runtime_or_log() {
    let tree =
        cargo(&["tree", "--package", "vision", "--edges", "normal", "--prefix", "none", "--format", "{p}"]);
    let reached: BTreeSet<&str> = tree.lines().filter_map(|line| line.split(' ').next()).collect();
    assert!(reached.contains("vision"), "no tree: {tree}");
    for forbidden in FORBIDDEN_IN_VISION {
        assert!(
            !reached.contains(forbidden),
            "vision reaches {forbidden}; see `cargo tree -p vision -i {forbidden}`"
        );
    }
}

#[test]
fn every_crate_takes_the_lint_table() {
    for (name, _) in ALLOWED {
        let manifest = manifests().remove(name).unwrap_or_else(|| panic!("no crate {name}"));
        let text = std::fs::read_to_string(&manifest).unwrap();
        assert!(text.contains("[lints]\nworkspace = true"), "{manifest} has no `[lints] workspace = true`");
    }
}

/// Direct dependencies of each crate of the workspace, of every kind.
fn dependencies_by_crate() -> BTreeMap<String, BTreeSet<String>> {
    let named = |value: &Value| value["name"].as_str().unwrap_or_default().to_owned();
    let dependencies = |package: &Value| {
        let list = package["dependencies"].as_array().cloned().unwrap_or_default();
        list.iter().map(named).collect()
    };
    packages().iter().map(|package| (named(package), dependencies(package))).collect()
}

fn manifests() -> BTreeMap<String, String> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    packages().iter().map(|package| (text(&package["name"]), text(&package["manifest_path"]))).collect()
}

fn packages() -> Vec<Value> {
    let text = cargo(&["metadata", "--no-deps", "--format-version", "1"]);
    let metadata: Value = serde_json::from_str(&text).unwrap();
    metadata["packages"].as_array().cloned().unwrap_or_default()
}

fn cargo(arguments: &[&str]) -> String {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let output =
        command.args(arguments).args(["--offline", "--locked"]).current_dir(workspace()).output().unwrap();
    assert!(output.status.success(), "cargo {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}
