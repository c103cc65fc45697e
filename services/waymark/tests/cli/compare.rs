//! `waymark compare`.

use serde_json::Value;

use crate::program::waymark;
use crate::scene::{Drive, SIDE_PX, TOP_PX, left_px, text};

/// A box on every line, as tracking benchmarks have it.
fn truth(frames: u32) -> String {
    (1..=frames).map(|number| format!("{},{TOP_PX},{SIDE_PX},{SIDE_PX}\n", left_px(number))).collect()
}

fn races(directory: &std::path::Path) -> Vec<Value> {
    serde_json::from_slice(&std::fs::read(directory.join("compare.json")).unwrap()).unwrap()
}

#[test]
fn methods_are_judged_by_truth_in_one_page_and_a_json() {
    let drive = Drive::of(6);
    let (report, truth_file) = (drive.path("compared"), drive.path("truth.txt"));
    std::fs::write(&truth_file, truth(6)).unwrap();
    let (frames, landmark) = (drive.frames(), drive.landmark());
    let args = ["compare", text(&frames), "--landmark", text(&landmark), "--truth", text(&truth_file)];
    waymark([&args[..], &["--report", text(&report)]].concat()).ended(0).telling("does best");
    let races = races(&report);
    assert_eq!((races.len(), &races[0]["judge"], &races[0]["frames"]), (1, &"truth".into(), &6.into()));
    let methods = races[0]["methods"].as_array().unwrap();
    assert_eq!(methods.len(), 9);
    for (method, least) in
        [("adaptive", 0.99), ("faithful", 0.99), ("ncc-colour", 0.99), ("colour-blob", 0.99)]
    {
        let figures = methods.iter().find(|figures| figures["method"] == method).unwrap();
        assert!(figures["detection_rate"].as_f64().unwrap() > least, "{figures}");
        assert!(figures["cpu_median_ms"].is_number(), "{figures}");
    }
    let page = std::fs::read_to_string(report.join("index.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("data:image/jpeg") && !page.contains("src=\"http"));
}

#[test]
fn without_truth_methods_are_judged_by_each_other() {
    let drive = Drive::of(4);
    let report = drive.path("compared");
    let (frames, landmark) = (drive.frames(), drive.landmark());
    let args = [
        "compare",
        text(&frames),
        "--landmark",
        text(&landmark),
        "--methods",
        "faithful,adaptive,colour-blob",
    ];
    waymark([&args[..], &["-o", text(&report)]].concat()).ended(0).telling("Agreement is no truth");
    let races = races(&report);
    assert_eq!(races[0]["judge"], "agreement");
    let methods = races[0]["methods"].as_array().unwrap();
    assert!(methods.iter().all(|figures| figures["agreement_rate"] == 1.0), "{methods:?}");
}

#[test]
fn mistakes_are_named() {
    let drive = Drive::of(2);
    let (frames, landmark) = (drive.frames(), drive.landmark());
    let report = drive.path("compared");
    let compare =
        |rest: &[&str]| waymark([&["compare", text(&frames), "-o", text(&report)], rest].concat()).ended(2);
    compare(&[]).telling("--landmark FILE");
    compare(&["--landmark", text(&landmark), "--methods", "sift"]).telling("ncc-scales");
    compare(&["--landmark", text(&landmark), "--truth", "none.csv"]).telling("none.csv");
    waymark(["compare", text(&frames), "--landmark", text(&landmark)]).ended(2).telling("--report");
}
