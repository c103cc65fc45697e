//! Registers a directory of pictures with what is learned from boxes, and writes `register`'s CSV for scoring.
//!
//! `score_sequence ID SHAPE DIRECTORY OUT.csv PICTURE#xywh=X,Y,W,H …`
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::disallowed_methods,
    reason = "a tool for developers"
)]

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use vision::frame::decode::{DecodeLimits, decode};
use vision::{
    Follow, FollowOptions, Frame, FrameStamp, LandmarkSet, LearnOptions, NoProbe, RectPx, SetVersion,
    ShapeClass, Timestamp, learn,
};

const HEADER: &str = "input,frame,captured_at_ns,camera,landmark,instance,result,x_px,y_px,area_px2,mask_area_2x,\
shape_score,score,predicted_x_px,predicted_y_px,predicted_area_px2,innovation_px,gain,bearing_rad,range_m\n";

fn picture(path: &str) -> Frame {
    decode(&std::fs::read(path).unwrap(), &DecodeLimits::default()).unwrap()
}

fn region(text: &str) -> (Frame, RectPx) {
    let (path, numbers) = text.split_once("#xywh=").unwrap();
    let n: Vec<u32> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
    (picture(path), RectPx { x: n[0], y: n[1], width: n[2], height: n[3] })
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [id, shape, directory, out, boxes @ ..] = arguments.as_slice() else { panic!("see the source") };
    let shape = ShapeClass::ALL.into_iter().find(|class| class.name() == shape).unwrap();
    let boxes: Vec<(Frame, RectPx)> = boxes.iter().map(|text| region(text)).collect();
    let regions: Vec<(&Frame, RectPx)> = boxes.iter().map(|(frame, rect)| (frame, *rect)).collect();
    let options = LearnOptions { id: id.clone(), shape, ..LearnOptions::default() };
    let landmark = learn(&regions, &options).unwrap();
    println!("{landmark:.1?}");
    let set = LandmarkSet { version: SetVersion::default(), landmarks: vec![Arc::new(landmark)] };
    let mut follow = Follow::new(FollowOptions::default(), set);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(directory).unwrap().map(|e| e.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "jpg"));
    paths.sort();
    let mut csv = HEADER.to_owned();
    for (k, path) in paths.iter().enumerate() {
        let stamp = FrameStamp {
            sequence: k as u64,
            captured_at: Timestamp::from_nanos(k as i64 * 1_000_000_000 / 30),
        };
        let outcome = follow.on_frame(&picture(path.to_str().unwrap()), stamp, &mut NoProbe);
        for row in &outcome.landmarks {
            let number = |value: Option<f32>| value.map_or(String::new(), |v| format!("{v}"));
            let seen = row.result.as_ref().ok();
            let result = row.result.as_ref().map_or_else(|miss| miss.name(), |_| "measured");
            writeln!(
                csv,
                "{},{},{},,{},{},{result},{},{},{},,,{},{},{},{},{},{},,",
                path.display(),
                k + 1,
                stamp.captured_at.nanos,
                row.landmark,
                row.instance,
                number(seen.map(|s| s.centroid.x)),
                number(seen.map(|s| s.centroid.y)),
                number(seen.map(|s| s.area_px2)),
                number(seen.map(|s| s.score)),
                number(row.prediction.map(|p| p.centroid.x)),
                number(row.prediction.map(|p| p.centroid.y)),
                number(row.prediction.map(|p| p.area_px2)),
                number(row.innovation_px),
                number(row.adaptation.map(|a| a.gain)),
            )
            .unwrap();
        }
    }
    std::fs::write(out, csv).unwrap();
}
