//! What is made of recordings, shown on the reference recordings.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::waymark;
use crate::scene::text;

fn rink() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../recordings/reference/rink.mcap")
}

#[test]
fn a_comparison_says_what_changed_and_ends_with_it() {
    let rink = rink();
    let diff = |more: &[&str]| waymark([&["register", text(&rink), "--diff"], more].concat());
    let faithful = diff(&["--mode", "faithful"]).ended(1).telling("differ");
    let header = "input,frame,captured_at_ns,camera,landmark,instance,field,recorded,again,difference,past";
    assert_eq!(faithful.stdout.lines().next(), Some(header));
    assert!(faithful.stdout.lines().any(|line| line.contains(",centroid_px,")), "{}", faithful.stdout);
    let same = waymark(["register", "--diff", "services"]).ended(2);
    assert!(same.stderr.contains("services"), "{}", same.stderr);
}

#[test]
fn a_recording_written_again_is_whole_and_is_compared_with_its_old_results() {
    let directory = tempfile::tempdir().unwrap();
    let (rink, again) = (rink(), directory.path().join("again.mcap"));
    let ran = waymark(["register", text(&rink), "--mode", "faithful", "-o", text(&again)]).ended(0);
    waymark(["recording", "check", text(&again)]).ended(0);
    let info = waymark(["recording", "info", "--json", text(&again)]).ended(0).stdout;
    let info: Value = serde_json::from_str(&info).unwrap();
    let messages = |topic: &str| {
        let topics = info["topics"].as_array().unwrap().iter();
        topics.filter(|entry| entry["topic"] == topic).map(|entry| entry["messages"].clone()).next().unwrap()
    };
    let topic = "/follower/camera/front/registration";
    assert_eq!(messages(&format!("{topic}/again")), messages(topic));
    assert!(info["metadata"]["waymark.again"]["mode"] == "faithful", "{}", info["metadata"]);
    let export = |file: &Path| {
        let csv = waymark(["recording", "export", text(file)]).ended(0).stdout;
        csv.lines().skip(1).map(|line| line.split_once(',').unwrap().1.to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(export(&again), export(&rink), "{}", ran.stderr);
    waymark(["register", text(&rink), "-o", text(&again)]).ended(2).telling("cannot create");
    waymark(["register", text(&rink), text(&again), "-o", "x.mcap"]).ended(2).telling("exactly one");
}

#[test]
fn tables_are_exported_in_every_format_and_kept_when_they_are_there() {
    let directory = tempfile::tempdir().unwrap();
    let (rink, out) = (rink(), directory.path().join("tables"));
    let into = format!("{}/", out.display());
    let glob = rink.with_file_name("*.mcap");
    for format in ["csv", "ndjson", "parquet"] {
        waymark(["recording", "export", text(&glob), "--format", format, "-o", &into])
            .ended(0)
            .telling("2 recordings")
            .telling(" 0 tables were there already");
    }
    let csv = std::fs::read_to_string(out.join("rink.csv")).unwrap();
    assert_eq!(csv, waymark(["recording", "export", text(&rink)]).ended(0).stdout);
    let ndjson = std::fs::read_to_string(out.join("rink.ndjson")).unwrap();
    assert_eq!(ndjson.lines().count(), csv.lines().count() - 1);
    assert!(std::fs::read(out.join("stop-sign.parquet")).unwrap().starts_with(b"PAR1"));
    waymark(["recording", "export", text(&glob), "-o", &into])
        .ended(0)
        .telling(" 2 tables were there already");
    let truth = waymark(["recording", "export", text(&rink), "--table", "truth"]).ended(0).stdout;
    assert!(truth.starts_with("input,frame,captured_at_ns,camera,object,"), "{truth}");
    waymark(["recording", "export", text(&rink), "--format", "parquet"]).ended(2).telling("-o");
    waymark(["recording", "export", text(&glob), "-o", "one.csv"]).ended(2).telling("one.csv/");
}

#[test]
fn pictures_are_exported_as_recorded_and_drawn() {
    let directory = tempfile::tempdir().unwrap();
    let (frames, drawn) = (directory.path().join("frames"), directory.path().join("drawn"));
    let rink = rink();
    waymark(["recording", "export", text(&rink), "--frames", text(&frames), "--overlays", text(&drawn)])
        .ended(0);
    let count = |directory: &Path| std::fs::read_dir(directory).unwrap().count();
    assert_eq!((count(&frames), count(&drawn)), (100, 91));
    assert!(frames.join("rink.mcap-front-000001.jpg").exists());
    let strip = directory.path().join("strip.png");
    waymark(["recording", "info", text(&rink), "--images", text(&strip)]).ended(0);
    assert!(std::fs::read(&strip).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn reports_of_many_recordings_have_one_summary() {
    let directory = tempfile::tempdir().unwrap();
    let (glob, into) = (rink().with_file_name("*.mcap"), format!("{}/", directory.path().display()));
    let json = waymark(["recording", "report", text(&glob), "-o", &into, "--json"]).ended(0).stdout;
    let figures: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(figures.len(), 2);
    assert!(figures[0]["cameras"][0]["landmarks"][0]["score"]["detection_rate"].is_number(), "{json}");
    let summary = std::fs::read_to_string(directory.path().join("summary.json")).unwrap();
    assert_eq!(serde_json::from_str::<Vec<Value>>(&summary).unwrap(), figures);
    for page in ["index.html", "rink.html", "stop-sign.html"] {
        assert!(directory.path().join(page).exists(), "{page}");
    }
    let made_at = |page: &str| std::fs::metadata(directory.path().join(page)).unwrap().modified().unwrap();
    let before = made_at("rink.html");
    waymark(["recording", "report", text(&glob), "-o", &into]).ended(0);
    assert_eq!(made_at("rink.html"), before, "it was there already");
    waymark(["recording", "report", text(&glob)]).ended(2);
}

#[test]
fn tables_of_many_inputs_are_kept_when_they_are_there() {
    let directory = tempfile::tempdir().unwrap();
    let (rink, stop_sign) = (rink(), rink().with_file_name("stop-sign.mcap"));
    let into = ["--into", text(directory.path())];
    let both = || waymark([&["register", text(&rink), text(&stop_sign)], &into[..]].concat()).ended(0);
    assert_eq!(both().stdout, "");
    let csv = std::fs::read_to_string(directory.path().join("rink.csv")).unwrap();
    assert_eq!(csv, waymark(["register", text(&rink)]).ended(0).stdout);
    std::fs::remove_file(directory.path().join("stop-sign.csv")).unwrap();
    both().telling("1 tables were there already");
    assert!(directory.path().join("stop-sign.csv").exists());
    waymark([&["register", text(&rink), text(&rink)], &into[..]].concat()).ended(2).telling("twice");
}
