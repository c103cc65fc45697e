//! A recorder that is started by hand.

use std::time::{SystemTime, UNIX_EPOCH};

use recording::info::Info;
use tests::DEADLINE;

use crate::convoy::Place;

#[test]
fn a_recording_started_by_hand_begins_before_its_start_and_has_the_drawn_pictures_where_wanted() {
    let place = Place::new();
    let _router = place.start_router();
    let settings = ["recorder.enabled=false", "recorder.pre_trigger_s=600", "recorder.burned_in=true"];
    let vehicle = place.start_vehicle("follower", &settings);
    vehicle.await_frames(10);
    assert_eq!(vehicle.face.json("/api/v1/recorder")["state"], "off");

    let started_at_ns = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos();
    assert!((200..300).contains(&vehicle.face.post("/api/v1/recorder/start")));
    vehicle.face.polled("/api/v1/recorder", |recorder| recorder["state"] == "recording");
    vehicle.await_frames(5);
    vehicle.program.terminate();
    assert_eq!(vehicle.program.ended_within(DEADLINE).code, Some(0));

    let recordings = std::fs::read_dir(place.path("follower-recordings")).unwrap();
    let [file] = recordings.map(|entry| entry.unwrap().path()).collect::<Vec<_>>().try_into().unwrap();
    let info = Info::read(&file).unwrap();
    let topic = |name: &str| &info.topics[&format!("/follower/camera/front/{name}")];
    for name in ["image", "registration", "burned_in"] {
        let (first_ns, last_ns) = topic(name).log_span_ns.unwrap();
        assert!(u128::from(first_ns) < started_at_ns && u128::from(last_ns) > started_at_ns, "{name}");
    }
    // The machine may not have had time to draw all of them.
    assert!(
        topic("registration").messages >= 15 && topic("burned_in").messages <= topic("registration").messages
    );
    assert_eq!(topic("burned_in").schema, "foxglove.CompressedImage");
    assert!(info.faults.is_empty(), "{:?}", info.faults);
}
