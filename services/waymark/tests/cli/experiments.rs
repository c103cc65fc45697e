//! `waymark experiments`.

use serde_json::Value;

use crate::program::waymark;
use crate::scene::text;

#[test]
fn a_few_experiments_are_written_as_a_page_and_as_results() {
    let directory = tempfile::tempdir().unwrap();
    let into = directory.path().join("made/here");
    waymark(["experiments", "--only", "4.1,4.9,2.9", "--report", text(&into), "--quiet"]).ended(0);
    let results = std::fs::read(into.join("results.json")).unwrap();
    let results: Vec<Value> = serde_json::from_slice(&results).unwrap();
    let of = |id: &str| results.iter().find(|row| row["id"] == id).unwrap_or_else(|| panic!("{id}"));
    assert_eq!(of("4.9 blue x largest error")["thesis"], 20.0);
    let false_passes = of("4.1 false passes at 9°");
    assert!((0.9..1.0).contains(&false_passes["ours"].as_f64().unwrap()), "{false_passes}");
    assert_eq!(false_passes["thesis"], Value::Null);
    let page = std::fs::read_to_string(into.join("index.html")).unwrap();
    assert!(page.contains("data:image/png") && page.contains("</html>"));
}

#[test]
fn an_unknown_experiment_is_told_with_the_known_ones() {
    let directory = tempfile::tempdir().unwrap();
    waymark(["experiments", "--only", "7", "-o", text(directory.path())]).ended(2).telling("4.10");
}
