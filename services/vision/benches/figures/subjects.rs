//! What is measured.

use std::hint::black_box;
use std::rc::Rc;

use image::RgbImage;
use vision::doubled_grid::DoubledGrid;
use vision::frame::decode::{DecodeLimits, decode_into};
use vision::frame::encode::{Quality, encode_jpeg};
use vision::mask::{Lanes, Masker};
use vision::{
    BitMask, Frame, Landmark, Miss, NoProbe, RectPx, Request, Sighting, SizePx, Stage, Workspace, register,
    register_all,
};

use super::clock::Rounds;
use super::stages::StageTime;
use super::{imageproc_peer, scene};

/// Selects lines.
type Wanted<'w> = dyn Fn(&str) -> bool + 'w;

/// Sides of the windows measured, on the doubled grid.
const WINDOWS: [u16; 4] = [6, 12, 13, 24];
/// Pixels on a side of the gates and objects that the growth with an object's size is told from.
const OBJECTS_PX: [u32; 5] = [12, 24, 48, 96, 192];

pub(crate) fn add_all(rounds: &mut Rounds<'_>, wanted: &Wanted<'_>) {
    for size in scene::SIZES {
        peers(rounds, wanted, size);
        contents(rounds, wanted, size);
        landmarks(rounds, wanted, size);
        gate(rounds, wanted, size);
        stages(rounds, wanted, size);
    }
    OBJECTS_PX.into_iter().for_each(|side| object(rounds, wanted, side));
}

fn line(figure: &str, content: &str, size: SizePx, window: u16, count: u32) -> String {
    format!("{figure}\t{content}\t{}\t{}\t{window}\t{count}", size.width, size.height)
}

fn add<'a>(rounds: &mut Rounds<'a>, wanted: &Wanted<'_>, line: String, run: impl FnMut() + 'a) {
    if wanted(&line) {
        rounds.add(line, run);
    }
}

/// Decoding the frame from JPEG, and the 14 steps with imageproc.
fn peers(rounds: &mut Rounds<'_>, wanted: &Wanted<'_>, size: SizePx) {
    let frame = scene::rink(size);
    let jpeg = encode_jpeg(&frame, Quality::new(90).expect("a quality")).expect("it encodes");
    let mut storage = Vec::new();
    add(rounds, wanted, line("decode", "rink", size, 0, 0), move || {
        let frame = decode_into(&jpeg, &DecodeLimits::default(), std::mem::take(&mut storage));
        storage = frame.expect("it was encoded above").into_rgb();
    });
    let picture =
        RgbImage::from_raw(size.width, size.height, frame.rgb().to_vec()).expect("three levels a pixel");
    add(rounds, wanted, line("imageproc", "rink", size, 12, 1), move || {
        let found = imageproc_peer::register(black_box(&picture), &scene::red(12));
        black_box((found.largest_pixels, found.contours.len(), found.lines.len()));
    });
}

/// All steps and the mask alone, for what a frame may hold, with each set of instructions.
fn contents(rounds: &mut Rounds<'_>, wanted: &Wanted<'_>, size: SizePx) {
    for window in WINDOWS {
        for (content, frame, landmark) in scene::contents(size, window) {
            let (frame, landmark) = (Rc::new(frame), Rc::new(landmark));
            for lanes in Lanes::available() {
                let name = |figure| line(&format!("{figure}-{}", lanes.name()), content, size, window, 1);
                mask(rounds, wanted, name("mask"), (Rc::clone(&frame), Rc::clone(&landmark)), lanes);
                all_steps(rounds, wanted, name("register"), (Rc::clone(&frame), Rc::clone(&landmark)), lanes);
            }
        }
    }
}

fn mask(
    rounds: &mut Rounds<'_>,
    wanted: &Wanted<'_>,
    line: String,
    (frame, landmark): (Rc<Frame>, Rc<Landmark>),
    lanes: Lanes,
) {
    let grid = DoubledGrid::new(RectPx::whole(frame.size()), landmark.window_px).expect("windows fit");
    let (mut masker, mut mask) = (Masker::with_lanes(lanes), BitMask::default());
    add(rounds, wanted, line, move || {
        masker.find(black_box(&frame), &grid, &landmark, &mut mask, &mut NoProbe);
    });
}

fn all_steps(
    rounds: &mut Rounds<'_>,
    wanted: &Wanted<'_>,
    line: String,
    (frame, landmark): (Rc<Frame>, Rc<Landmark>),
    lanes: Lanes,
) {
    let mut workspace = Workspace::with_masker(Masker::with_lanes(lanes));
    add(rounds, wanted, line, move || {
        let found = register(black_box(&frame), &landmark, &Request::default(), &mut workspace, &mut NoProbe);
        found.into_iter().for_each(|sightings| workspace.recycle(sightings));
    });
}

/// Many landmarks: of colours spread over the cube, as a fleet would choose them, and of the frame's own colours, which all
/// match somewhere; together, and those of the first kind each by itself.
fn landmarks(rounds: &mut Rounds<'_>, wanted: &Wanted<'_>, size: SizePx) {
    let frame = Rc::new(scene::rink(size));
    for count in [1, 8, 64] {
        let distinct = scene::distinct(count);
        together(rounds, wanted, line("landmarks", "distinct", size, 12, count), &frame, distinct);
        let learned = scene::learned(&frame, count);
        together(rounds, wanted, line("landmarks", "learned", size, 12, count), &frame, learned);
    }
    let (landmarks, mut workspace) = (scene::distinct(64), Workspace::default());
    add(rounds, wanted, line("landmarks alone", "distinct", size, 12, 64), move || {
        for landmark in &landmarks {
            let request = Request::default();
            let found = register(black_box(&frame), landmark, &request, &mut workspace, &mut NoProbe);
            found.into_iter().for_each(|sightings| workspace.recycle(sightings));
        }
    });
}

fn together(
    rounds: &mut Rounds<'_>,
    wanted: &Wanted<'_>,
    line: String,
    frame: &Rc<Frame>,
    landmarks: Vec<Landmark>,
) {
    let (frame, mut workspace) = (Rc::clone(frame), Workspace::default());
    add(rounds, wanted, line, move || {
        let request = Request::default();
        let each = |_, found: Result<Vec<Sighting>, Miss>, workspace: &mut Workspace| {
            found.into_iter().for_each(|sightings| workspace.recycle(sightings));
        };
        register_all(black_box(&frame), landmarks.iter(), &request, &mut workspace, &mut NoProbe, each);
    });
}

/// A block of 24 pixels in a gate of twice its side, all steps.
fn gate(rounds: &mut Rounds<'_>, wanted: &Wanted<'_>, size: SizePx) {
    let (frame, region) = scene::one_block(size, 24);
    gated(rounds, wanted, &line("gated", "block 24 px", size, 12, 1), frame, region);
}

/// A block of that side in a gate of twice its side, all steps.
fn object(rounds: &mut Rounds<'_>, wanted: &Wanted<'_>, side: u32) {
    let size = scene::SIZES[1];
    let (frame, region) = scene::one_block(size, side);
    gated(rounds, wanted, &line("object", "block", size, 12, side), frame, region);
}

fn gated(rounds: &mut Rounds<'_>, wanted: &Wanted<'_>, line: &str, frame: Frame, region: RectPx) {
    let frame = Rc::new(frame);
    for lanes in Lanes::available() {
        let mut workspace = Workspace::with_masker(Masker::with_lanes(lanes));
        let (frame, line) = (Rc::clone(&frame), line.replacen('\t', &format!("-{}\t", lanes.name()), 1));
        add(rounds, wanted, line, move || {
            let request = Request { region: Some(region), ..Request::default() };
            let found = register(black_box(&frame), &scene::red(12), &request, &mut workspace, &mut NoProbe);
            found.into_iter().for_each(|sightings| workspace.recycle(sightings));
        });
    }
}

/// Each stage of one registration on its own.
fn stages(rounds: &mut Rounds<'_>, wanted: &Wanted<'_>, size: SizePx) {
    let frame = Rc::new(scene::rink(size));
    for stage in Stage::ALL {
        let line = line(stage.name(), "match", size, 12, 1);
        if wanted(&line) {
            let (frame, mut workspace) = (Rc::clone(&frame), Workspace::default());
            rounds.add_timed(line, move || {
                let mut probe = StageTime::of(stage);
                let found =
                    register(&frame, &scene::red(12), &Request::default(), &mut workspace, &mut probe);
                found.into_iter().for_each(|sightings| workspace.recycle(sightings));
                probe.spent_us()
            });
        }
    }
}
