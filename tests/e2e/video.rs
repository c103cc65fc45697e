//! Cameras that send H.264: what people do on the pages works as with single pictures.

use serde_json::Value;
use tests::face::{Answer, Face};
use tests::program::Program;

use crate::convoy::{Place, connect, landmark, publish};

const JPEG: &[u8] = &[0xFF, 0xD8, 0xFF];
const PNG: &[u8] = b"\x89PNG\r\n";

#[test]
fn a_landmark_is_learned_from_a_film_by_box() {
    let place = Place::new();
    let _router = place.start_router();
    let (_leader, face) = place.start_service("leader", "leader", &[r#"cameras=["front"]"#]);
    let connect = connect(&place.endpoint);
    let settings =
        [connect.as_str(), "vehicle=leader", "encoding=h264", "source=sim:rink?seed=5&fps=5&vehicle=1"];
    let settings = settings.into_iter().flat_map(|setting| ["--set", setting]);
    let _camera = Program::start(["camera"].into_iter().chain(settings));
    face.polled("/api/v1/status", |status| status["cameras"][0]["state"] == "live");

    assert_eq!(face.post("/api/v1/lessons?camera=front"), 201);
    let asked = "/api/v1/lessons/1";
    assert_picture(&face.get(&format!("{asked}/picture.png")), PNG);
    let drawn = "x=200&y=100&w=60&h=40";
    let learned = face.json(&format!("{asked}/landmark?{drawn}"));
    assert!(learned["landmark"]["shades"].as_array().is_some_and(|shades| !shades.is_empty()), "{learned}");
    assert_picture(&face.get(&format!("{asked}/mask.png?{drawn}")), PNG);
    assert_seen(&face, &Value::Null);
}

#[test]
fn a_landmark_is_explained_in_a_film_and_the_page_gets_its_pictures() {
    let place = Place::new();
    let _router = place.start_router();
    let (_leader, _) = place.start_service("leader", "leader", &[]);
    place.edit(&publish([landmark("red", 120.0)]));
    let vehicle = place.start_vehicle_with("follower", &[], &["encoding=h264"]);
    let face = &vehicle.face;
    face.json_once("/api/v1/status", |status| status["cameras"][0]["landmarks"][0]["id"] == "red");

    let explained = face.json("/api/v1/cameras/front/explanations/red");
    assert_eq!(explained["statistics"].as_array().map(Vec::len), Some(6), "{explained}");
    assert_picture(&face.get("/api/v1/cameras/front/frame.jpg"), JPEG);
    assert_seen(face, &Value::from("red"));
    // Nothing that a browser shows comes out of such a camera: each picture that is looked at is encoded.
    let metrics = String::from_utf8(face.get("/metrics").body).unwrap();
    assert!(!metrics.contains("waymark_http_encodes_total{camera=\"front\"} 0\n"), "{metrics}");
}

fn assert_picture(answer: &Answer, begin: &[u8]) {
    assert_eq!(answer.status, 200, "{}", String::from_utf8_lossy(&answer.body));
    assert!(answer.body.starts_with(begin), "{}: {:?}", answer.media_type, answer.body.get(..8));
}

/// What the page asks for: a JPEG, and the first landmark that was looked for in it, if one was.
fn assert_seen(face: &Face, landmark: &Value) {
    let answer = face.get("/api/v1/cameras/front/seen");
    assert_eq!((answer.status, answer.media_type.as_str()), (200, "multipart/form-data"));
    let picture_at = answer.body.windows(JPEG.len()).position(|bytes| bytes == JPEG);
    // What is told comes before the picture, whose bytes may look like anything.
    let text = String::from_utf8_lossy(&answer.body[..picture_at.expect("a picture")]);
    let told = text.lines().find(|line| line.starts_with('{')).unwrap_or("null");
    let told: Value = serde_json::from_str(told).unwrap();
    assert_eq!(&told["landmarks"][0]["id"], landmark, "{told}");
}
