//! `/api/v1/lessons`: learning a landmark from a box that somebody draws.

mod drawn_box;
mod entries;

use std::sync::Arc;

use axum::Json;
use axum::extract::{Path, RawQuery, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use http_face::{Api, Format, Operation, Parameters, PictureRequest, Problem, picture_answer};
use ingest::{camera_thread, view};
use serde_json::json;
use vision::overlay::tint;

use super::{Face, Shared};
use crate::lessons::Lesson;
use drawn_box::{box_asked, with_box};
use entries::{LearnedEntry, LessonEntry};

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
    Ok((StatusCode::CREATED, Json(LessonEntry::from(lesson.as_ref()))).into_response())
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
        let learned = lesson.learn(region, &options).map_err(|error| unlearnable(&error))?;
        Ok(Json(LearnedEntry::of(&learned, region)))
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

fn unlearnable(error: &vision::LearnError) -> Problem {
    Problem::new(StatusCode::UNPROCESSABLE_ENTITY, error.to_string())
}
