//! Draws an outcome over its frame: what was found and where, what was expected, and why something was not found.
//!
//! A found landmark has a solid outline, a dot at its centroid and the vector from the picture's origin to it (thesis
//! Fig 4.5); a missed one has a dashed cross where it was expected, and its reason in words. Colours tell landmarks
//! apart and are safe for colour-blind eyes; shape and words carry the rest. Every line has a dark rim, so that it
//! can be read on any background.

mod layers;
mod lettering;
mod pen;
mod tint;

pub use layers::{Layers, UnknownLayer};
pub use tint::{adapted, tint};

use lettering::Lettering;
use pen::{Ink, Pen, StrokeKind};

use crate::frame::Frame;
use crate::geometry::{PointPx, RectPx, SizePx};
use crate::outcome::{LandmarkOutcome, Miss, Outcome, Sighting};

/// Okabe and Ito's colours for colour-blind readers, without black; landmarks take them in the order of the set.
const PALETTE: [[u8; 3]; 7] = [
    [240, 228, 66],
    [86, 180, 233],
    [230, 159, 0],
    [0, 198, 148],
    [224, 150, 190],
    [240, 120, 40],
    [200, 200, 255],
];

/// Room for the marks at a centroid, px.
const LEAST_HALF_EXTENT_PX: f32 = 9.0;

/// Draws the wanted `layers` of `outcome` over `frame`, which it was made from.
pub fn draw(frame: &mut Frame, outcome: &Outcome, layers: Layers) {
    let Some(mut pen) = Pen::over(frame) else { return };
    let keep_clear = outcome.landmarks.iter().filter_map(|landmark| extent(landmark, frame.size())).collect();
    let mut lettering = Lettering::new(frame.size(), keep_clear);
    let mut colour_of = ColourOrder::default();
    for landmark in &outcome.landmarks {
        let ink = Ink(colour_of.landmark(&landmark.landmark));
        draw_expectation(&mut pen, landmark, layers, ink);
        if let Ok(sighting) = &landmark.result {
            draw_sighting(&mut pen, sighting, layers, ink);
        }
        if layers.contains(Layers::LABELS) {
            lettering.place(label(landmark), extent(landmark, frame.size()), ink);
        }
    }
    pen.write_to(frame);
    lettering.write_to(frame);
}

/// Gives each landmark id, instances included, the next colour.
#[derive(Default)]
struct ColourOrder<'a> {
    seen: Vec<&'a str>,
}

impl<'a> ColourOrder<'a> {
    fn landmark(&mut self, id: &'a str) -> [u8; 3] {
        let index = self.seen.iter().position(|seen| *seen == id).unwrap_or_else(|| {
            self.seen.push(id);
            self.seen.len() - 1
        });
        PALETTE[index % PALETTE.len()]
    }
}

fn draw_expectation(pen: &mut Pen, landmark: &LandmarkOutcome, layers: Layers, ink: Ink) {
    if let Some(gate) = landmark.gate.filter(|_| layers.contains(Layers::GATE)) {
        pen.ellipse(gate.centre, [gate.radius_x_px, gate.radius_y_px], StrokeKind::Dashed, ink);
    }
    let Some(prediction) = landmark.prediction.filter(|_| layers.contains(Layers::PREDICTION)) else {
        return;
    };
    match landmark.result {
        Ok(_) => pen.diamond(prediction.centroid, ink),
        Err(_) => pen.cross(prediction.centroid, prediction.area_px2.max(0.0).sqrt() / 2.0, ink),
    }
}

fn draw_sighting(pen: &mut Pen, sighting: &Sighting, layers: Layers, ink: Ink) {
    if layers.contains(Layers::VECTOR) {
        pen.arrow(PointPx::new(0.0, 0.0), sighting.centroid, ink);
    }
    if layers.contains(Layers::OUTLINE) {
        pen.polygon(&sighting.outline, StrokeKind::Thin, ink);
    }
    if layers.contains(Layers::SEGMENTS) {
        for segment in &sighting.segments {
            pen.line(segment.from, segment.to, StrokeKind::Thick, ink);
        }
    }
    if layers.contains(Layers::OUTLINE) || layers.contains(Layers::VECTOR) {
        pen.dot(sighting.centroid, ink);
    }
}

/// The words beside a landmark, such as `red  x 458.5 y 325.6  589 px²` or `blue: no colour`.
fn label(landmark: &LandmarkOutcome) -> String {
    let instance = match landmark.instance {
        0 => String::new(),
        number => format!("#{number}"),
    };
    let name = format!("{}{instance}", landmark.landmark);
    match &landmark.result {
        Ok(Sighting { centroid: PointPx { x, y }, area_px2, .. }) => {
            format!("{name}  x {x:.1} y {y:.1}  {area_px2:.0} px²")
        }
        Err(miss) => format!("{name}: {}", reason(miss)),
    }
}

fn reason(miss: &Miss) -> String {
    let words = miss.name().replace('_', " ");
    match miss {
        Miss::WrongShape { score } => format!("{words} ({score:.2})"),
        Miss::OutsideGate { innovation_px } => format!("{words} ({innovation_px:.0} px off)"),
        Miss::Occluded { visible } => format!("{words} ({:.0} % seen)", 100.0 * visible),
        Miss::OutsideFrame | Miss::NoColour { .. } | Miss::TooSmall | Miss::Skipped => words,
    }
}

/// The square that the object, or the place where it was expected, takes; `None` where that is not in the picture.
fn extent(landmark: &LandmarkOutcome, frame: SizePx) -> Option<RectPx> {
    let (centre, area_px2) = match (&landmark.result, landmark.prediction) {
        (Ok(sighting), _) => (sighting.centroid, sighting.area_px2),
        (Err(Miss::OutsideFrame), _) | (Err(_), None) => return None,
        (Err(_), Some(prediction)) => (prediction.centroid, prediction.area_px2),
    };
    let half_px = (area_px2.max(0.0).sqrt() * 0.6).max(LEAST_HALF_EXTENT_PX);
    let from = |at: f32| (at - half_px).max(0.0) as u32;
    let to = |at: f32| (at + half_px).clamp(0.0, 1e6) as u32;
    let (x, y) = (from(centre.x), from(centre.y));
    let width = to(centre.x).saturating_sub(x);
    let height = to(centre.y).saturating_sub(y);
    RectPx { x, y, width, height }.clipped_to(frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landmark::Digest;

    fn outcome_of(landmark: &str, instance: u32, result: Result<Sighting, Miss>) -> LandmarkOutcome {
        LandmarkOutcome {
            landmark: landmark.to_owned(),
            digest: Digest::default(),
            instance,
            prediction: None,
            gate: None,
            result,
            innovation_px: None,
            adaptation: None,
        }
    }

    #[test]
    fn labels_say_what_was_measured_or_why_not() {
        let centroid = PointPx::new(458.46, 325.64);
        let sighting = Sighting { centroid, area_px2: 588.6, ..Sighting::default() };
        assert_eq!(label(&outcome_of("red", 0, Ok(sighting.clone()))), "red  x 458.5 y 325.6  589 px²");
        assert_eq!(label(&outcome_of("sign", 2, Ok(sighting))), "sign#2  x 458.5 y 325.6  589 px²");
        assert_eq!(label(&outcome_of("blue", 0, Err(Miss::NoColour { best: None }))), "blue: no colour");
        let far = Err(Miss::OutsideGate { innovation_px: 34.4 });
        assert_eq!(label(&outcome_of("blue", 1, far)), "blue#1: outside gate (34 px off)");
    }

    #[test]
    fn nothing_wanted_changes_nothing() {
        let original = Frame::from_rgb(40, 30, vec![90; 3 * 40 * 30]).unwrap();
        let mut frame = original.clone();
        let landmarks = vec![outcome_of("red", 0, Ok(Sighting::default()))];
        draw(&mut frame, &Outcome { landmarks, ..Outcome::default() }, Layers::NONE);
        assert_eq!(frame, original);
    }

    #[test]
    fn numbers_that_are_none_draw_nothing_and_harm_nothing() {
        let nowhere = PointPx::new(f32::NAN, f32::INFINITY);
        let sighting = Sighting {
            centroid: nowhere,
            area_px2: f32::NAN,
            outline: vec![nowhere, PointPx::new(1e30, -1e30), PointPx::new(3.0, 4.0)],
            ..Sighting::default()
        };
        let landmarks = vec![outcome_of("red", 0, Ok(sighting))];
        for (width, height) in [(40, 30), (1, 1), (0, 0)] {
            let mut frame = Frame::from_rgb(width, height, vec![90; (3 * width * height) as usize]).unwrap();
            draw(&mut frame, &Outcome { landmarks: landmarks.clone(), ..Outcome::default() }, Layers::ALL);
        }
    }
}
