//! The box that somebody draws around an object, and what he says of the object: as it is asked and as it is described.

use http_face::{Operation, Parameters, Problem, integer};
use serde_json::json;
use vision::learn::LearnOptions;
use vision::{RectPx, ShapeClass};

/// Coordinates and sides that may be asked for, frame pixels.
const PIXELS: std::ops::RangeInclusive<u32> = 0..=65_535;

/// Widths of objects, metres.
const SIZES_M: std::ops::RangeInclusive<f64> = 0.001..=1000.0;

const SHAPES: &[&str] = &["any", "block", "rectangle", "octagon", "triangle", "circle"];

/// Says of an operation that it takes a box.
pub(super) fn with_box(operation: Operation) -> Operation {
    operation
        .required("x", "Left edge of the box, frame pixels", integer(&PIXELS))
        .required("y", "Upper edge, frame pixels", integer(&PIXELS))
        .required("w", "Columns", integer(&PIXELS))
        .required("h", "Rows", integer(&PIXELS))
        .query("shape", "Its outline", json!({ "type": "string", "enum": SHAPES }))
        .query(
            "size_m",
            "Its width, metres",
            json!({ "type": "number", "minimum": SIZES_M.start(), "maximum": SIZES_M.end() }),
        )
        .problem(422, "The box leaves the picture or is too small")
}

/// Reads the box.
pub(super) fn box_asked(query: &mut Parameters) -> Result<(RectPx, LearnOptions), Problem> {
    let mut side = |name| {
        let number = query.number(name, PIXELS)?;
        number.ok_or_else(|| Problem::parameter(name, "", "a number of pixels: the box needs x, y, w and h"))
    };
    let region = RectPx { x: side("x")?, y: side("y")?, width: side("w")?, height: side("h")? };
    let shape = match query.text("shape") {
        None => ShapeClass::default(),
        Some(name) => shape(&name).ok_or_else(|| Problem::parameter("shape", &name, &SHAPES.join(", ")))?,
    };
    let size_m = query.number("size_m", SIZES_M)?.map(|size_m| size_m as f32);
    Ok((region, LearnOptions { id: "learned".to_owned(), shape, size_m, ..LearnOptions::default() }))
}

fn shape(name: &str) -> Option<ShapeClass> {
    use ShapeClass::{Any, Block, Circle, Octagon, Rectangle, Triangle};
    [Any, Block, Rectangle, Octagon, Triangle, Circle].into_iter().find(|shape| shape.name() == name)
}
