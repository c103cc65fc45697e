//! `waymark register`.

use std::process::{Command, Stdio};

use serde_json::Value;

use crate::program::{Ran, waymark};
use crate::scene::{Drive, SIDE_PX, TOP_PX, left_px, text};

fn register(drive: &Drive, more: &[&str]) -> Ran {
    let (frames, landmark) = (drive.frames(), drive.landmark());
    waymark([&["register", text(&frames), "--landmark", text(&landmark)], more].concat())
}

/// The rows of a CSV result as columns by name.
fn column<'a>(csv: &'a str, name: &str) -> Vec<&'a str> {
    let mut lines = csv.lines();
    let at = lines.next().unwrap().split(',').position(|column| column == name).unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap()).collect()
}

#[test]
fn a_block_is_found_in_every_frame_and_where_it_is() {
    let drive = Drive::of(6);
    for mode in ["faithful", "adaptive"] {
        let csv = register(&drive, &["--mode", mode]).ended(0).stdout;
        assert_eq!(column(&csv, "result"), ["measured"; 6], "{mode}: {csv}");
        assert_eq!(column(&csv, "frame"), ["1", "2", "3", "4", "5", "6"]);
        assert_eq!(column(&csv, "captured_at_ns")[1], "33333333");
        for (number, (x, y)) in (1..).zip(column(&csv, "x_px").into_iter().zip(column(&csv, "y_px"))) {
            let (x, y): (f32, f32) = (x.parse().unwrap(), y.parse().unwrap());
            let half = SIDE_PX as f32 / 2.0;
            let off = (x - left_px(number) as f32 - half).hypot(y - TOP_PX as f32 - half);
            assert!(off < 1.0, "{mode}, frame {number}: {x} {y}");
        }
    }
}

#[test]
fn the_header_is_the_contract() {
    let csv = register(&Drive::of(1), &[]).ended(0).stdout;
    assert_eq!(
        csv.lines().next().unwrap(),
        "input,frame,captured_at_ns,camera,landmark,instance,result,x_px,y_px,area_px2,mask_area_2x,shape_score,\
         score,predicted_x_px,predicted_y_px,predicted_area_px2,innovation_px,gain,bearing_rad,range_m"
    );
}

#[test]
fn ndjson_says_the_same_as_csv() {
    let drive = Drive::of(3);
    let csv = register(&drive, &[]).ended(0).stdout;
    let ndjson = register(&drive, &["--format", "ndjson"]).ended(0).stdout;
    let rows: Vec<Value> = ndjson.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let xs: Vec<f64> = rows.iter().map(|row| row["x_px"].as_f64().unwrap()).collect();
    let expected: Vec<f64> = column(&csv, "x_px").iter().map(|x| x.parse::<f32>().unwrap().into()).collect();
    assert_eq!(
        xs.iter().map(|x| *x as f32).collect::<Vec<_>>(),
        expected.iter().map(|x| *x as f32).collect::<Vec<_>>()
    );
    assert!(rows[0]["predicted_x_px"].is_null(), "nothing predicts a first sighting");
}

#[test]
fn many_inputs_come_out_in_order_whatever_the_threads() {
    let (drive, other) = (Drive::of(5), Drive::of(3));
    let (frames, others, landmark) = (drive.frames(), other.frames(), drive.landmark());
    let inputs = [text(&frames), text(&others), text(&frames)];
    let run = |threads: &str| {
        let options = ["--landmark", text(&landmark), "--threads", threads];
        waymark([&["register"], &inputs[..], &options].concat()).ended(0).stdout
    };
    let one = run("1");
    assert_eq!(one, run("3"));
    let expected: Vec<&str> = [[inputs[0]; 5].as_slice(), &[inputs[1]; 3], &[inputs[2]; 5]].concat();
    assert_eq!(column(&one, "input"), expected);
}

#[test]
fn a_damaged_picture_is_named_and_the_rest_goes_on() {
    let drive = Drive::of(5);
    let third = drive.frames().join("f3.jpg");
    let whole = std::fs::read(&third).unwrap();
    std::fs::write(&third, &whole[..whole.len() / 2]).unwrap();
    let ran = register(&drive, &["--quiet"]).ended(3).telling("f3.jpg").telling("1 of 5 frames");
    assert_eq!(column(&ran.stdout, "frame"), ["1", "2", "4", "5"]);
}

#[test]
fn costs_are_written_stage_by_stage() {
    let drive = Drive::of(4);
    let stats = drive.path("cost.json");
    register(&drive, &["--mode", "faithful", "--stats", text(&stats)]).ended(0);
    let cost: Value = serde_json::from_str(&std::fs::read_to_string(stats).unwrap()).unwrap();
    assert_eq!(cost["frames"], 4);
    assert!(cost["cpu_s"].as_f64().unwrap() > 0.0);
    let names =
        ["decode", "statistics", "mask", "components", "outline", "hough", "shape", "measure", "register"];
    for name in names {
        for figure in ["p50_ms", "p99_ms", "mean_ms"] {
            assert!(cost["stages"][name][figure].is_number(), "{name} {figure}: {cost}");
        }
    }
}

#[test]
fn every_frame_is_drawn() {
    let drive = Drive::of(3);
    let overlays = drive.path("drawn");
    register(&drive, &["--overlays", text(&overlays)]).ended(0);
    let mut names: Vec<_> = std::fs::read_dir(&overlays).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["frames-000001.jpg", "frames-000002.jpg", "frames-000003.jpg"]);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let drive = Drive::of(3);
    let mut child = Command::new(env!("CARGO_BIN_EXE_waymark"))
        .args(["register", text(&drive.frames()), "--landmark", text(&drive.landmark())])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
}

#[test]
fn what_cannot_be_registered_is_said_and_why() {
    let drive = Drive::of(1);
    let (frames, landmark) = (drive.frames(), drive.landmark());
    waymark(["register", text(&frames)]).ended(2).telling("--landmark FILE");
    let with_landmark = |input: &str| waymark(["register", input, "--landmark", text(&landmark)]).ended(2);
    with_landmark("nowhere").telling("`nowhere` is not a file, a directory or a glob");
    with_landmark(text(&drive.path(""))).telling("frames` does");
    with_landmark("zenoh:waymark/v1/**").telling("live source");
    with_landmark("ftp://camera").telling("scheme `ftp`");
    let twice = ["register", text(&frames), "-l", text(&landmark), "-l", text(&landmark)];
    waymark(twice).ended(2).telling("give each id once");
    waymark(["register", text(&frames), "-l", text(&landmark), "--threads", "0"]).ended(2);
}
