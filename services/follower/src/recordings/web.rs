//! `/api/v1/recordings`: what there is, as files, as pictures and as figures.

mod answers;
mod description;

use std::sync::Arc;

use axum::extract::{Path, RawQuery, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Json};
use http_face::{Api, ForViewers, Format, Parameters, PictureRequest, Problem, ServedFile, serve_file};
use recording::timeline::Timeline;
use recording::{FileName, RecordingError};
use tokio::sync::Semaphore;
use vision::Landmark;

use super::frame::{NotShown, RecordedFrame};
use super::landmarks::{self, RecordedLandmarks};
use super::registrations::{Registrations, page};
use super::topics::{CameraTopics, cameras};
use super::{Found, Shelf};
use crate::pictures_out::LAYERS;
use answers::{picture, shown, told};
use description::{DEFAULT_PAGE, PAGE, QUERY_PLACES};

/// Recordings read at once, so that viewers cannot take the disk and the cores from recorder and registration.
const MAX_READERS: usize = 2;

/// What the routes share.
struct Reading {
    shelf: Shelf,
    readers: Arc<Semaphore>,
}

type Shared = State<Arc<Reading>>;

/// The routes of everything that `shelf` holds.
pub(crate) fn routes(api: Api, shelf: Shelf) -> Api {
    let reading = Arc::new(Reading { shelf, readers: Arc::new(Semaphore::new(MAX_READERS)) });
    let shared = || Arc::clone(&reading);
    let one = get(download).delete(remove).with_state(shared());
    api.route("/api/v1/recordings", [description::list()], get(list).with_state(shared()))
        .route("/api/v1/recordings/{name}", [description::download(), description::remove()], one)
        .route(
            "/api/v1/recordings/{name}/frames/{frame}",
            [description::frame()],
            get(frame).with_state(shared()),
        )
        .route(
            "/api/v1/recordings/{name}/landmarks",
            [description::landmarks()],
            get(landmarks_of).with_state(shared()),
        )
        .route(
            "/api/v1/recordings/{name}/registrations",
            [description::registrations()],
            get(registrations).with_state(shared()),
        )
}

impl Reading {
    /// Does what waits for the disk where it holds up nothing else.
    async fn read<T: Send + 'static>(
        self: Arc<Self>,
        work: impl FnOnce(&Shelf) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let permit = Arc::clone(&self.readers).acquire_owned().await;
        let done = tokio::task::spawn_blocking(move || {
            let _permit = permit;
            work(&self.shelf)
        });
        done.await.map_err(|error| Problem::internal(&error))?
    }
}

impl Shelf {
    fn named(&self, name: &str) -> Result<Found, Problem> {
        let found = self.find(name).map_err(|error| Problem::internal(&error))?;
        found.ok_or_else(|| Problem::not_found(&format!("recording {name:?}")))
    }

    fn timeline(&self, found: &Found) -> Result<Arc<Timeline>, RecordingError> {
        self.timelines.of(found, || Timeline::read(&found.path))
    }

    /// The landmarks that it was made with.
    pub(super) fn landmarks(&self, found: &Found) -> Result<Arc<Vec<Arc<Landmark>>>, Problem> {
        let read = || landmarks::landmarks(found, &*self.timeline(found)?);
        self.landmarks.of(found, read).map_err(|error| unreadable(&error))
    }

    /// Picture `n` as it is asked for, or else what was seen in it.
    fn frame(
        &self,
        name: &str,
        camera: Option<&str>,
        n: usize,
        request: Option<&PictureRequest>,
    ) -> Result<Response, Problem> {
        let found = self.named(name)?;
        let (timeline, topics) = self.camera(&found, camera)?;
        let frame = RecordedFrame::read(&found, &timeline, &topics, n).map_err(|error| not_shown(&error))?;
        let Some(request) = request else { return Ok(told(&frame, n, timeline.of(&topics.image))) };
        if request.is_met_by_own_jpeg()
            && let Some(jpeg) = frame.own_jpeg()
        {
            return Ok(picture(&frame, Format::Jpeg, jpeg));
        }
        let pixels = frame.decode(&found, &timeline, &topics).map_err(|error| not_shown(&error))?;
        shown(&frame, pixels, request, &self.landmarks(&found)?)
    }

    /// The camera asked for, or the only one.
    pub(super) fn camera(
        &self,
        found: &Found,
        asked: Option<&str>,
    ) -> Result<(Arc<Timeline>, CameraTopics), Problem> {
        let timeline = self.timeline(found).map_err(|error| unreadable(&error))?;
        let mut all = cameras(timeline.topics());
        let chosen = match asked {
            Some(id) => all.iter().position(|topics| topics.camera == id),
            None => (all.len() == 1).then_some(0),
        };
        match chosen {
            Some(at) => Ok((timeline, all.swap_remove(at))),
            None if all.is_empty() => Err(Problem::not_found("picture in this recording")),
            None => {
                let ids: Vec<_> = all.iter().map(|topics| topics.camera.as_str()).collect();
                let asked = asked.map_or_else(|| "camera named".to_owned(), |id| format!("camera {id:?}"));
                Err(Problem::not_found(&format!("{asked} in this recording; it has {}", ids.join(", "))))
            }
        }
    }
}

/// A file that cannot be read is not the client's fault, but it is no failure of the service either: the file is damaged.
fn unreadable(error: &dyn std::fmt::Display) -> Problem {
    Problem::new(StatusCode::UNPROCESSABLE_ENTITY, format!("the recording cannot be read: {error}"))
}

async fn list(State(reading): Shared, RawQuery(query): RawQuery) -> Result<Response, Problem> {
    let mut query = Parameters::parse(query.as_deref())?;
    let limit = query.number("limit", PAGE)?.unwrap_or(DEFAULT_PAGE);
    let after = query.text("after");
    query.finish()?;
    if let Some(after) = after.as_deref().filter(|after| FileName::parse(after).is_none()) {
        return Err(Problem::parameter("after", after, "the name of a recording"));
    }
    let listed = reading.read(move |shelf| {
        shelf.list(after.as_deref(), limit as usize).map_err(|error| Problem::internal(&error))
    });
    Ok(Json(listed.await?).into_response())
}

/// The whole file, or the part of it that a viewer asks for.
async fn download(
    State(reading): Shared,
    Path(name): Path<String>,
    headers: HeaderMap,
) -> Result<(Extension<ForViewers>, Response), Problem> {
    let opened = reading.read(move |shelf| {
        let found = shelf.named(&name)?;
        let file = std::fs::File::open(&found.path).map_err(|error| Problem::internal(&error))?;
        Ok((found, file))
    });
    let (found, file) = opened.await?;
    let served = ServedFile {
        file: file.into(),
        length: found.bytes,
        tag: found.tag,
        media_type: "application/octet-stream",
        name: found.name.finished(),
    };
    Ok((Extension(ForViewers), serve_file(&headers, served).await?))
}

async fn remove(State(reading): Shared, Path(name): Path<String>) -> Result<StatusCode, Problem> {
    let removed = reading.read(move |shelf| {
        let found = shelf.named(&name)?;
        if !found.is_finished {
            let detail = "it is still being written, or its writer died and it will be recovered at the next start; \
                          stop or split the recorder first";
            return Err(Problem::new(StatusCode::CONFLICT, detail));
        }
        std::fs::remove_file(&found.path).map_err(|error| Problem::internal(&error))?;
        tracing::info!(recording = %found.name, "deleted on request");
        Ok(StatusCode::NO_CONTENT)
    });
    removed.await
}

/// A picture, with what was seen in it live, or that alone as JSON.
async fn frame(
    State(reading): Shared,
    Path((name, file)): Path<(String, String)>,
    RawQuery(query): RawQuery,
) -> Result<Response, Problem> {
    let no_frame = || Problem::not_found(&format!("frame {file:?}; ask for 0.jpg, 0.png or 0.json"));
    let (n, kind) = file.split_once('.').ok_or_else(no_frame)?;
    let format = match kind {
        "jpg" => Some(Format::Jpeg),
        "png" => Some(Format::Png),
        "json" => None,
        _ => return Err(no_frame()),
    };
    let n: usize = n.parse().map_err(|_| no_frame())?;
    let mut query = Parameters::parse(query.as_deref())?;
    let camera = query.text("camera");
    let request = PictureRequest::asked(&mut query, Format::Jpeg, LAYERS)?;
    let request = format.map(|format| PictureRequest { format, ..request });
    query.finish()?;
    reading.read(move |shelf| shelf.frame(&name, camera.as_deref(), n, request.as_ref())).await
}

fn not_shown(error: &NotShown) -> Problem {
    match error {
        NotShown::Beyond { .. } => Problem::new(StatusCode::NOT_FOUND, error.to_string()),
        _ => unreadable(error),
    }
}

async fn landmarks_of(
    State(reading): Shared,
    Path(name): Path<String>,
) -> Result<Json<RecordedLandmarks>, Problem> {
    let read = reading.read(move |shelf| Ok(RecordedLandmarks::of(&shelf.landmarks(&shelf.named(&name)?)?)));
    read.await.map(Json)
}

async fn registrations(
    State(reading): Shared,
    Path(name): Path<String>,
    RawQuery(query): RawQuery,
) -> Result<Json<Registrations>, Problem> {
    let mut query = Parameters::parse(query.as_deref())?;
    let camera = query.text("camera");
    let from = query.number("after", QUERY_PLACES)?.unwrap_or(0);
    let limit = query.number("limit", PAGE)?.unwrap_or(DEFAULT_PAGE);
    query.finish()?;
    let answered = reading.read(move |shelf| {
        let found = shelf.named(&name)?;
        let (timeline, topics) = shelf.camera(&found, camera.as_deref())?;
        let (from, limit) = (usize::try_from(from).unwrap_or(usize::MAX), limit as usize);
        page(&found, &timeline, topics.camera, &topics.registration, from, limit)
            .map_err(|error| unreadable(&error))
    });
    answered.await.map(Json)
}
