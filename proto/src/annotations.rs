//! An outcome as `foxglove.ImageAnnotations`: what a viewer draws over the picture.
//!
//! Coordinates need no conversion: annotations count from the picture's top-left corner, as the domain does.

use std::f64::consts::TAU;

use vision::{Gate, LandmarkOutcome, Miss, Outcome, PointPx, Prediction, Sighting};

use crate::foxglove as fox;
use crate::foxglove::points_annotation::Type;
use crate::images::foxglove_time;

const OUTLINE: fox::Color = color(0.10, 0.95, 0.30);
const SEGMENTS: fox::Color = color(1.00, 0.85, 0.10);
const VECTOR: fox::Color = color(0.25, 0.65, 1.00);
const PREDICTION: fox::Color = color(0.85, 0.45, 1.00);
const GATE: fox::Color = color(0.70, 0.70, 0.70);
const MISSED: fox::Color = color(1.00, 0.35, 0.25);
const LABEL_BACKGROUND: fox::Color = fox::Color { r: 0.0, g: 0.0, b: 0.0, a: 0.6 };

const THICKNESS_PX: f64 = 2.0;
const FONT_SIZE_PX: f64 = 14.0;
const PREDICTION_DIAMETER_PX: f64 = 6.0;
/// Vertices of the polygon that stands for the gate's ellipse: within 0.5 % of it.
const GATE_VERTICES: u32 = 32;

/// Everything that a frame's outcome lets one draw. Every part carries the image's own time, so that viewers pair
/// them exactly; older ones look at the parts, newer ones at the whole.
#[must_use]
pub fn annotations(outcome: &Outcome) -> fox::ImageAnnotations {
    let mut drawing = Drawing { time: foxglove_time(outcome.captured_at), ..Default::default() };
    for (row, landmark) in outcome.landmarks.iter().enumerate() {
        drawing.draw(landmark, row);
    }
    fox::ImageAnnotations {
        timestamp: drawing.time,
        circles: drawing.circles,
        points: drawing.points,
        texts: drawing.texts,
        metadata: Vec::new(),
    }
}

#[derive(Default)]
struct Drawing {
    time: Option<fox::Timestamp>,
    circles: Vec<fox::CircleAnnotation>,
    points: Vec<fox::PointsAnnotation>,
    texts: Vec<fox::TextAnnotation>,
}

impl Drawing {
    fn draw(&mut self, landmark: &LandmarkOutcome, row: usize) {
        if let Some(gate) = &landmark.gate {
            self.lines(Type::LineLoop, ellipse(gate), GATE);
        }
        if let Some(prediction) = &landmark.prediction {
            self.predicted(prediction);
        }
        match &landmark.result {
            Ok(sighting) => self.sighted(landmark, sighting),
            Err(miss) => self.missed(landmark, miss, row),
        }
    }

    fn predicted(&mut self, prediction: &Prediction) {
        self.circles.push(fox::CircleAnnotation {
            timestamp: self.time,
            position: Some(point(prediction.centroid)),
            diameter: PREDICTION_DIAMETER_PX,
            thickness: THICKNESS_PX,
            outline_color: Some(PREDICTION),
            ..Default::default()
        });
    }

    fn sighted(&mut self, landmark: &LandmarkOutcome, sighting: &Sighting) {
        self.lines(Type::LineLoop, sighting.outline.iter().copied().map(point).collect(), OUTLINE);
        let ends = sighting.segments.iter().flat_map(|segment| [point(segment.from), point(segment.to)]);
        self.lines(Type::LineList, ends.collect(), SEGMENTS);
        // Thesis Fig. 4.5: the landmark's place as a vector from the picture's origin.
        self.lines(Type::LineList, vec![point(PointPx::default()), point(sighting.centroid)], VECTOR);
        let figures = format!("{:.0} px² {:.2}", sighting.area_px2, sighting.score);
        self.label(sighting.centroid, format!("{} {figures}", name(landmark)), OUTLINE);
    }

    fn missed(&mut self, landmark: &LandmarkOutcome, miss: &Miss, row: usize) {
        let listed = PointPx::new(4.0, 1.5 * FONT_SIZE_PX as f32 * (row as f32 + 1.0));
        let at = landmark.prediction.map_or(listed, |prediction| prediction.centroid);
        self.label(at, format!("{}: {}", name(landmark), miss.name()), MISSED);
    }

    fn lines(&mut self, kind: Type, points: Vec<fox::Point2>, color: fox::Color) {
        if points.is_empty() {
            return;
        }
        self.points.push(fox::PointsAnnotation {
            timestamp: self.time,
            r#type: kind.into(),
            points,
            outline_color: Some(color),
            thickness: THICKNESS_PX,
            ..Default::default()
        });
    }

    fn label(&mut self, at: PointPx, text: String, color: fox::Color) {
        self.texts.push(fox::TextAnnotation {
            timestamp: self.time,
            position: Some(point(at)),
            text,
            font_size: FONT_SIZE_PX,
            text_color: Some(color),
            background_color: Some(LABEL_BACKGROUND),
            ..Default::default()
        });
    }
}

fn name(landmark: &LandmarkOutcome) -> String {
    match landmark.instance {
        0 => landmark.landmark.clone(),
        instance => format!("{}#{instance}", landmark.landmark),
    }
}

fn ellipse(gate: &Gate) -> Vec<fox::Point2> {
    let vertex = |at| {
        let (sin, cos) = (TAU * f64::from(at) / f64::from(GATE_VERTICES)).sin_cos();
        fox::Point2 {
            x: f64::from(gate.centre.x) + f64::from(gate.radius_x_px) * cos,
            y: f64::from(gate.centre.y) + f64::from(gate.radius_y_px) * sin,
        }
    };
    (0..GATE_VERTICES).map(vertex).collect()
}

fn point(point: PointPx) -> fox::Point2 {
    fox::Point2 { x: point.x.into(), y: point.y.into() }
}

const fn color(r: f64, g: f64, b: f64) -> fox::Color {
    fox::Color { r, g, b, a: 1.0 }
}

#[cfg(test)]
mod tests {
    use vision::{Digest, Segment, Timestamp};

    use super::*;

    fn outcome(results: Vec<Result<Sighting, Miss>>) -> Outcome {
        let landmarks = results.into_iter().enumerate().map(|(instance, result)| LandmarkOutcome {
            landmark: "red".into(),
            digest: Digest::default(),
            instance: instance as u32,
            prediction: None,
            gate: None,
            result,
            innovation_px: None,
            adaptation: None,
        });
        Outcome {
            captured_at: Timestamp::from_nanos(5_000_000_007),
            landmarks: landmarks.collect(),
            ..Default::default()
        }
    }

    fn sighting() -> Sighting {
        let corner = |x, y| PointPx { x, y };
        Sighting {
            centroid: corner(20.0, 10.0),
            outline: vec![corner(10.0, 5.0), corner(30.0, 5.0), corner(30.0, 15.0), corner(10.0, 15.0)],
            segments: vec![Segment { from: corner(10.0, 5.0), to: corner(30.0, 5.0) }; 2],
            ..Default::default()
        }
    }

    #[test]
    fn a_sighting_shows_outline_segments_and_vector() {
        let drawn = annotations(&outcome(vec![Ok(sighting())]));
        let [outline, segments, vector] = drawn.points.as_slice() else { panic!("{:?}", drawn.points) };
        assert_eq!((outline.r#type(), outline.points.len()), (Type::LineLoop, 4));
        assert_eq!((segments.r#type(), segments.points.len()), (Type::LineList, 4));
        assert_eq!(vector.points, [fox::Point2 { x: 0.0, y: 0.0 }, fox::Point2 { x: 20.0, y: 10.0 }]);
        assert!(drawn.texts[0].text.starts_with("red 0 px²"), "{}", drawn.texts[0].text);
    }

    #[test]
    fn a_miss_is_said_where_the_landmark_was_expected() {
        let mut missed = outcome(vec![Err(Miss::TooSmall), Err(Miss::OutsideFrame)]);
        let expected = Prediction { centroid: PointPx::new(50.0, 60.0), ..Default::default() };
        missed.landmarks[1].prediction = Some(expected);
        missed.landmarks[1].gate =
            Some(Gate { centre: expected.centroid, radius_x_px: 8.0, radius_y_px: 4.0 });
        let drawn = annotations(&missed);
        assert_eq!(drawn.texts[0].text, "red: too_small");
        assert_eq!(drawn.texts[1].text, "red#1: outside_frame");
        assert_eq!(drawn.texts[1].position, Some(fox::Point2 { x: 50.0, y: 60.0 }));
        assert_eq!(drawn.circles[0].position, Some(fox::Point2 { x: 50.0, y: 60.0 }));
        assert_eq!(drawn.points[0].points.len(), 32);
        assert_eq!(drawn.points[0].points[0], fox::Point2 { x: 58.0, y: 60.0 });
    }

    #[test]
    fn every_part_carries_the_images_time() {
        let drawn = annotations(&outcome(vec![Ok(sighting()), Err(Miss::Skipped)]));
        let time = fox::Timestamp::new_checked(5, 7);
        assert_eq!(drawn.timestamp, time);
        assert!(drawn.points.iter().all(|part| part.timestamp == time));
        assert!(drawn.texts.iter().all(|part| part.timestamp == time));
    }
}
