//! Signs that overlap, stand behind posts and before bushes, in drawn frames.

#[path = "../../../tests/scene/fine.rs"]
mod fine;

use crate::adaptive::memory::{List, Memory};
use crate::adaptive::{Candidate, Finder, Light, Likeness, Search};
use crate::frame::Frame;
use crate::geometry::{PointPx, RectPx};
use crate::landmark::{Landmark, ShapeClass};
use crate::learn::{LearnOptions, learn};

const WIDTH: u32 = 240;
const HEIGHT: u32 = 120;
const GREEN: [f32; 3] = [10.0, 84.0, 54.0];
const WHITE: [f32; 3] = [190.0, 194.0, 190.0];
/// A mixture of both colours of the sign.
const BUSH: [f32; 3] = [46.0, 106.0, 81.0];
const POST: [f32; 3] = [110.0, 112.0, 114.0];

/// A sign of that size around a centre, leaning by a slope.
struct Sign {
    centre: (f32, f32),
    size: (f32, f32),
    slope: f32,
}

impl Sign {
    fn new(centre: (f32, f32), size: (f32, f32)) -> Self {
        Self { centre, size, slope: 0.0 }
    }

    /// Its colour at a place, if that lies on it: a border, and two lines of letters that are stems.
    fn color_at(&self, x: f32, y: f32) -> Option<[f32; 3]> {
        let (dx, dy) = (x - self.centre.0, y - self.centre.1);
        let (dx, dy) = (dx + self.slope * dy, dy - self.slope * dx);
        let (u, v) = (dx / self.size.0 + 0.5, dy / self.size.1 + 0.5);
        if !((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v)) {
            return None;
        }
        let border = !(0.024..0.976).contains(&u) || !(0.048..0.952).contains(&v);
        let line = (0.2..0.42).contains(&v) || (0.6..0.82).contains(&v);
        let stem = (0.15..0.85).contains(&u) && (u * 14.0).fract() < 0.45;
        Some(if border || (line && stem) { WHITE } else { GREEN })
    }
}

/// Signs, the first in front, with whatever `others` draw before all of them; the sky above, and grass.
fn drawn(signs: &[Sign], others: impl Fn(f32, f32) -> Option<[f32; 3]>) -> Frame {
    let sample = |x: f32, y: f32| {
        let sign = || signs.iter().find_map(|sign| sign.color_at(x, y));
        let ground = if y < 70.0 { [150.0, 178.0, 220.0] } else { [92.0, 112.0, 58.0] };
        others(x, y).or_else(sign).unwrap_or(ground)
    };
    Frame::from_rgb(WIDTH, HEIGHT, fine::rgb(WIDTH, HEIGHT, sample)).unwrap()
}

fn learned() -> Landmark {
    let frame = drawn(&[Sign::new((120.0, 60.0), (60.0, 30.0))], |_, _| None);
    let region = RectPx { x: 90, y: 45, width: 60, height: 30 };
    let options =
        LearnOptions { id: "signs".into(), shape: ShapeClass::Rectangle, ..LearnOptions::default() };
    learn(&[(&frame, region)], &options).unwrap()
}

/// What is found anywhere, with at least the score that one more sign needs.
fn found<'m>(memory: &'m Memory, frame: &Frame) -> List<'m, Candidate<'m>> {
    let landmark = learned();
    let likeness = Likeness::anywhere(memory, &landmark, Light::AS_LEARNED, [1.0; 3]);
    let search = Search {
        frame,
        region: RectPx::whole(frame.size()),
        landmark: &landmark,
        likeness,
        light: Light::AS_LEARNED,
        noise_variance: [1.0; 3],
        blur_px: 0.5,
        limit: 24,
    };
    let mut all = Finder::default().candidates(&search, memory);
    all.retain(|candidate| candidate.score >= 0.5);
    all
}

#[track_caller]
fn assert_found(frame: &Frame, centres: &[(f32, f32)], within_px: f32) {
    let memory = Memory::new();
    let found = found(&memory, frame);
    let places: Vec<PointPx> = found.iter().map(|candidate| candidate.centroid).collect();
    assert_eq!(places.len(), centres.len(), "{places:?}");
    for &(x, y) in centres {
        let nearest =
            places.iter().map(|place| place.distance_px(PointPx::new(x, y))).fold(f32::MAX, f32::min);
        assert!(nearest <= within_px, "none within {within_px} px of {x}, {y}: {places:?}");
    }
}

#[test]
fn signs_that_overlap_are_found_one_by_one() {
    let signs = [
        Sign::new((150.0, 45.0), (60.0, 30.0)),
        Sign::new((108.3, 51.2), (28.0, 14.0)),
        Sign::new((86.4, 53.5), (16.0, 8.0)),
    ];
    assert_found(&drawn(&signs, |_, _| None), &[(150.0, 45.0), (107.2, 51.2), (86.2, 53.5)], 1.0);
}

#[test]
fn a_bush_of_a_mixture_of_its_colours_is_no_sign() {
    let bush = |x: f32, y: f32| {
        ((x - 130.0).hypot(y - 70.0) < 12.0 || (x - 60.0).hypot(y - 80.0) < 20.0).then_some(BUSH)
    };
    let signs = [Sign::new((130.0, 43.0), (60.0, 30.0))];
    assert_found(&drawn(&signs, bush), &[(130.0, 43.0)], 0.5);
}

#[test]
fn a_sign_behind_a_post_is_one_sign() {
    let post = |x: f32, _: f32| (148.0..153.0).contains(&x).then_some(POST);
    let signs = [Sign::new((150.5, 45.0), (60.0, 30.0))];
    assert_found(&drawn(&signs, post), &[(150.5, 45.0)], 0.5);
}

#[test]
fn a_sign_that_leans_a_little_is_found() {
    let sign = Sign { slope: 0.07, ..Sign::new((120.0, 45.0), (60.0, 30.0)) };
    assert_found(&drawn(&[sign], |_, _| None), &[(120.0, 45.0)], 0.7);
}

#[test]
fn a_sign_is_measured_with_its_border() {
    // Before the sky it cannot be seen, before the grass it can.
    let frame = drawn(&[Sign::new((120.3, 60.4), (60.0, 30.0))], |_, _| None);
    let memory = Memory::new();
    let found = found(&memory, &frame);
    let [sign] = &found[..] else { panic!("{} signs", found.len()) };
    assert!(sign.centroid.distance_px(PointPx::new(120.3, 60.4)) < 0.3, "{:?}", sign.centroid);
    assert!((sign.area_px2 / 1800.0 - 1.0).abs() < 0.08, "{} px²", sign.area_px2);
    assert!((sign.light.gain - 1.0).abs() < 0.1, "gain {}", sign.light.gain);
}
