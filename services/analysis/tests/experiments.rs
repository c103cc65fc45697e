//! `results.json` and the page of the experiments, from those that need no long simulated drive.

#![allow(clippy::unwrap_used)] // in a test, a panic with its place is the report

use analysis::experiments::{Done, Lab, html, results, run, selected};
use serde_json::Value;

fn done(wanted: &[&str]) -> Vec<Done> {
    let wanted: Vec<String> = wanted.iter().map(|&wanted| wanted.to_owned()).collect();
    run(&selected(&wanted).unwrap(), &Lab::default(), |_| {}).unwrap()
}

#[test]
fn results_are_as_the_contract_says() {
    let done = done(&["2.6", "2.7", "3.1", "4.0.2", "4.0.4"]);
    let json: Value = serde_json::from_slice(&serde_json::to_vec(&results(&done)).unwrap()).unwrap();
    let rows = json.as_array().unwrap();
    assert!(rows.len() >= 20, "{json:#}");
    let mut ids: Vec<&str> = rows.iter().map(|row| row["id"].as_str().unwrap()).collect();
    for row in rows {
        assert!(row["ours"].is_number() || row["ours"].is_null(), "{row}");
        assert!(row["thesis"].is_number() || row["thesis"].is_string() || row["thesis"].is_null(), "{row}");
        assert!(row["unit"].is_string() && row["note"].is_string(), "{row}");
    }
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), rows.len(), "ids are unique");
}

#[test]
fn the_printed_tables_are_judged_and_the_page_stands_alone() {
    let done = done(&["B, C", "4.8", "4.9"]);
    assert!(done.iter().all(|done| !done.account.sentence.is_empty()));
    let page = html(&done);
    for outside in ["<link", "<script", "src=\"http", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.matches("<svg").count() >= 6);
    assert!(page.contains("extrapolates backwards"));
}
