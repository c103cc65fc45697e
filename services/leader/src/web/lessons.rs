//! `/api/v1/lessons`: learning a landmark from a box that somebody draws.

use std::sync::Arc;

use axum::Json;
use axum::extract::{Path, RawQuery, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use http_face::{Api, Format, Operation, Parameters, PictureRequest, Problem, integer, picture_answer};
use ingest::{camera_thread, view};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::json;
use vision::learn::LearnOptions;
use vision::outcome::NearestMatch;
use vision::overlay::tint;
use vision::{RectPx, ShapeClass};
use waymark_proto::documents::LandmarkDocument;

use super::{Face, Shared};
use crate::lessons::{Learned, Lesson};

/// Coordinates and sides that may be asked for, frame pixels.
const PIXELS: std::ops::RangeInclusive<u32> = 0..=65_535;

/// Widths of objects, metres.
const SIZES_M: std::ops::RangeInclusive<f64> = 0.001..=1000.0;

const SHAPES: &[&str] = &["any", "block", "rectangle", "octagon", "triangle", "circle"];

/// A picture that is kept to learn from.
#[derive(Serialize, JsonSchema)]
struct LessonEntry {
    /// Names it in the addresses of what is learned from it.
    lesson: u64,
    /// The camera's id.
    camera: String,
    /// The frame's number in its stream.
    sequence: u64,
    /// When it was captured, ns since the Unix epoch.
    captured_at_ns: i64,
    /// Columns.
    width_px: u32,
    /// Rows.
    height_px: u32,
}

/// What was learned from a box.
#[derive(Serialize, JsonSchema)]
struct LearnedEntry {
    /// The landmark; publish it with PUT.
    landmark: LandmarkDocument,
    /// How many tolerances everything else in the picture is off: above 1 nothing else matches, and the more the
    /// better. Null where there is nothing else.
    separation: Option<f32>,
    /// Where in the rest of the picture it comes nearest.
    nearest: Option<PlaceEntry>,
    /// How many tolerances the object itself is off at its best place; null where it is smaller than the window.
    object: Option<f32>,
    /// What registration finds in this picture; null where it finds nothing.
    seen: Option<SeenEntry>,
}

/// A place in the picture.
#[derive(Serialize, JsonSchema)]
struct PlaceEntry {
    /// Frame pixels.
    x_px: f32,
    /// Frame pixels.
    y_px: f32,
}

/// What registration finds.
#[derive(Serialize, JsonSchema)]
struct SeenEntry {
    /// Centre, frame pixels.
    x_px: f32,
    /// Centre, frame pixels.
    y_px: f32,
    /// Area, frame pixels².
    area_px2: f32,
    /// Belief, 0..1.
    score: f32,
    /// Whether the centre lies in the box.
    is_in_box: bool,
}

pub(super) fn routes(api: Api, face: &Arc<Face>) -> Api {
    let shared = || Arc::clone(face);
    let camera = json!({ "type": "string" });
    let begin_of = Operation::post("Keeps the newest picture of a camera to learn from")
        .required("camera", "Whose picture", camera)
        .gives_with::<LessonEntry>(201)
        .problem(404, "There is no such camera")
        .problem(503, "It has sent no picture lately");
    let picture_of =
        PictureRequest::described(of_lesson("The picture, without loss").binary("image/png"), &[]);
    let learned_of = with_box(of_lesson("The landmark of the object in a box, and how well it stands out"))
        .gives::<LearnedEntry>();
    let mask_of = PictureRequest::described(
        with_box(of_lesson("The picture with every place tinted that matches it")).binary("image/png"),
        &[],
    );
    api.route("/api/v1/lessons", [begin_of], post(begin).with_state(shared()))
        .route("/api/v1/lessons/{lesson}/picture.png", [picture_of], get(picture).with_state(shared()))
        .route("/api/v1/lessons/{lesson}/landmark", [learned_of], get(learned).with_state(shared()))
        .route("/api/v1/lessons/{lesson}/mask.png", [mask_of], get(mask).with_state(shared()))
}

fn of_lesson(summary: &'static str) -> Operation {
    let number = json!({ "type": "integer", "minimum": 1 });
    Operation::get(summary)
        .path("lesson", "The picture's number", number)
        .problem(404, "The picture is not kept any more")
}

fn with_box(operation: Operation) -> Operation {
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

async fn begin(State(face): Shared, RawQuery(query): RawQuery) -> Result<Response, Problem> {
    let mut query = Parameters::parse(query.as_deref())?;
    let camera = query.text("camera").ok_or_else(|| Problem::parameter("camera", "", "a camera's id"))?;
    query.finish()?;
    let feed = face.cameras.feed(&camera).ok_or_else(|| Problem::not_found(&format!("camera {camera:?}")))?;
    let newest = feed.latest()?;
    let kept = face.work(move |face| {
        let frame = camera_thread::decode(&newest.source).map_err(|error| Problem::internal(&error))?;
        Ok(face.lessons.keep(camera, newest.sequence, newest.captured_at_ns, frame))
    });
    let lesson = kept.await?;
    let entry = LessonEntry {
        lesson: lesson.number,
        camera: lesson.camera.clone(),
        sequence: lesson.sequence,
        captured_at_ns: lesson.captured_at_ns,
        width_px: lesson.frame.width(),
        height_px: lesson.frame.height(),
    };
    Ok((StatusCode::CREATED, Json(entry)).into_response())
}

async fn picture(
    State(face): Shared,
    Path(lesson): Path<String>,
    RawQuery(query): RawQuery,
) -> Result<Response, Problem> {
    let lesson = face.lesson(&lesson)?;
    let mut query = Parameters::parse(query.as_deref())?;
    let request = PictureRequest::asked(&mut query, Format::Png, &[])?;
    query.finish()?;
    face.work(move |_| answer(&lesson, lesson.frame.clone(), &request)).await
}

async fn learned(
    State(face): Shared,
    Path(lesson): Path<String>,
    RawQuery(query): RawQuery,
) -> Result<Json<LearnedEntry>, Problem> {
    let lesson = face.lesson(&lesson)?;
    let mut query = Parameters::parse(query.as_deref())?;
    let (region, options) = box_asked(&mut query)?;
    query.finish()?;
    face.work(move |_| {
        Ok(Json(entry(&lesson.learn(region, &options).map_err(|error| unlearnable(&error))?, region)))
    })
    .await
}

async fn mask(
    State(face): Shared,
    Path(lesson): Path<String>,
    RawQuery(query): RawQuery,
) -> Result<Response, Problem> {
    let lesson = face.lesson(&lesson)?;
    let mut query = Parameters::parse(query.as_deref())?;
    let (region, options) = box_asked(&mut query)?;
    let request = PictureRequest::asked(&mut query, Format::Png, &[])?;
    query.finish()?;
    face.work(move |_| {
        let landmark = lesson.landmark(region, &options).map_err(|error| unlearnable(&error))?;
        let mut frame = lesson.frame.clone();
        tint(&mut frame, &[landmark]);
        answer(&lesson, frame, &request)
    })
    .await
}

impl Face {
    fn lesson(&self, number: &str) -> Result<Arc<Lesson>, Problem> {
        let known = number.parse().ok().and_then(|number| self.lessons.get(number));
        known.ok_or_else(|| Problem::not_found(&format!("lesson {number:?} any more; begin one with POST")))
    }

    /// Does what takes a processor for a while where it holds up nothing else, one thing after the other.
    async fn work<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&Self) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let permit = Arc::clone(&self.learners).acquire_owned().await;
        let face = Arc::clone(self);
        let done = tokio::task::spawn_blocking(move || {
            let _permit = permit;
            work(&face)
        });
        done.await.map_err(|error| Problem::internal(&error))?
    }
}

fn answer(lesson: &Lesson, frame: vision::Frame, request: &PictureRequest) -> Result<Response, Problem> {
    let bytes = view::encoded(frame, request).map_err(|reason| Problem::internal(&reason))?;
    Ok(picture_answer(lesson.sequence, lesson.captured_at_ns, Format::Png, bytes.into()))
}

fn box_asked(query: &mut Parameters) -> Result<(RectPx, LearnOptions), Problem> {
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

fn unlearnable(error: &vision::LearnError) -> Problem {
    Problem::new(StatusCode::UNPROCESSABLE_ENTITY, error.to_string())
}

fn entry(learned: &Learned, region: RectPx) -> LearnedEntry {
    let place = |nearest: NearestMatch| PlaceEntry { x_px: nearest.at.x, y_px: nearest.at.y };
    let contains = |x: f32, y: f32| {
        let across = region.x as f32..=(region.x + region.width) as f32;
        let down = region.y as f32..=(region.y + region.height) as f32;
        across.contains(&x) && down.contains(&y)
    };
    LearnedEntry {
        landmark: LandmarkDocument::from(&learned.landmark),
        separation: Some(learned.separation.excess()).filter(|excess| excess.is_finite()),
        nearest: learned.separation.outside.map(place),
        object: learned.separation.inside.map(|inside| inside.excess),
        seen: learned.seen.as_ref().map(|seen| SeenEntry {
            x_px: seen.centroid.x,
            y_px: seen.centroid.y,
            area_px2: seen.area_px2,
            score: seen.score,
            is_in_box: contains(seen.centroid.x, seen.centroid.y),
        }),
    }
}
