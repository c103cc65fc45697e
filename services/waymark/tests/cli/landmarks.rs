//! `waymark landmark`.

use serde_json::Value;

use crate::program::waymark;
use crate::scene::{Drive, SIDE_PX, TOP_PX, left_px, text};

#[test]
fn a_learned_landmark_is_shown_with_its_six_statistics() {
    let drive = Drive::of(2);
    let shown = waymark(["landmark", "show", text(&drive.landmark())]).ended(0).stdout;
    assert!(shown.starts_with("red  shape block, size unknown, window 12×12"), "{shown}");
    for statistic in
        ["mean red", "mean green", "mean blue", "variance red", "variance green", "variance blue"]
    {
        assert!(shown.contains(statistic), "{shown}");
    }
    let json = waymark(["landmark", "show", "--json", text(&drive.landmark())]).ended(0).stdout;
    let landmark: Value = serde_json::from_str(&json).unwrap();
    let red = landmark["shades"][0]["mean"][0].as_f64().unwrap();
    assert!((red - 204.0).abs() < 2.0, "{red}");
}

#[test]
fn options_override_what_is_fitted() {
    let drive = Drive::of(2);
    let region = format!("{}#xywh={},{TOP_PX},{SIDE_PX},{SIDE_PX}", text(&drive.near()), left_px(2));
    let args = [
        "landmark",
        "learn",
        &region,
        "--id",
        "x",
        "--window",
        "6,8",
        "--tolerance",
        "9,33",
        "--size-m",
        "0.4",
    ];
    let landmark: Value = serde_json::from_str(&waymark(args).ended(0).stdout).unwrap();
    assert_eq!((&landmark["windowWidthPx"], &landmark["windowHeightPx"]), (&6.into(), &8.into()));
    assert_eq!(landmark["tolerance"]["variance"][2], 33.0);
    let exact: Value = {
        let args = ["landmark", "learn", &region, "--id", "x", "--exact", "--preset", "blue-block"];
        serde_json::from_str(&waymark(args).ended(0).stdout).unwrap()
    };
    assert_eq!(exact["windowWidthPx"], SIDE_PX);
    assert_eq!(exact["tolerance"]["mean"][0], 40.0);
}

#[test]
fn what_cannot_be_learned_is_said_and_why() {
    let drive = Drive::of(2);
    let near = text(&drive.near()).to_owned();
    let learn = |region: &str, id: &str| {
        waymark(["landmark", "learn", &format!("{near}{region}"), "--id", id]).ended(2)
    };
    learn("#xywh=150,0,11,9", "red").telling("reaches outside the picture, which is 160×120");
    learn("#xywh=1,1,0,9", "red").telling("width and height must be greater than 0");
    learn("#t=3", "red").telling("#xywh=X,Y,W,H");
    learn("#xywh=1,1,9,9", "Stop Sign").telling("[a-z0-9][a-z0-9_-]{0,62}");
    waymark(["landmark", "learn", "no.jpg#xywh=1,1,9,9", "--id", "red"])
        .ended(2)
        .telling("cannot read `no.jpg`");
}

#[test]
fn damaged_landmark_files_name_the_field() {
    let drive = Drive::of(2);
    let good = std::fs::read_to_string(drive.landmark()).unwrap();
    for (from, to, field) in [
        ("\"windowWidthPx\": 12", "\"windowWidthPx\": 0", "window_width_px is 0; allowed: 1 to 512"),
        ("\"mean\": [", "\"mean\": [\"NaN\",", "shades[0].mean"),
        ("SHAPE_CLASS_BLOCK", "SHAPE_CLASS_BLOB", "SHAPE_CLASS_BLOB"),
    ] {
        let bad = drive.path("bad.json");
        std::fs::write(&bad, good.replacen(from, to, 1)).unwrap();
        waymark(["landmark", "show", text(&bad)]).ended(2).telling(field);
        waymark(["register", text(&drive.frames()), "--landmark", text(&bad)]).ended(2).telling("bad.json");
    }
}

#[test]
fn a_frame_is_explained_statistic_by_statistic() {
    let drive = Drive::of(2);
    let picture = drive.path("why.png");
    let frame = drive.frames().join("f1.jpg");
    let landmark = drive.landmark();
    let explained = ["explain", text(&frame), "--landmark", text(&landmark), "--picture", text(&picture)];
    let found = waymark(explained).ended(0).stdout;
    assert!(found.contains("red registered at 4"), "{found}");
    assert_eq!(found.matches(" fits").count(), 7, "six statistics and an outline: {found}");
    assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));

    std::fs::write(drive.path("grey.png"), drive.floor()).unwrap();
    let bare = drive.path("grey.png");
    let missed = waymark(["explain", text(&bare), "--landmark", text(&landmark)]).ended(0).stdout;
    assert!(missed.contains("red not registered") && missed.contains("fails"), "{missed}");
}
