//! The pictures of every camera over HTTP: single ones by long-poll and streams.

use crate::mjpeg::{StreamSlots, stream};
use crate::parameters::Parameters;
use crate::pictures::{Picture, PictureFeed};
use crate::problem::Problem;
use crate::renditions::{Format, PictureRequest, Render, Renditions};
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Uri};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Json, Router};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// How long a request with `after` waits for a newer picture.
const LONG_POLL: Duration = Duration::from_secs(5);

const DEFAULT_QUALITY: u8 = 80;

/// Every camera's newest picture and its views.
pub struct Cameras<T> {
    cameras: BTreeMap<String, Arc<Camera<T>>>,
    layers: &'static [&'static str],
    slots: StreamSlots,
}

pub(crate) struct Camera<T> {
    pub(crate) feed: PictureFeed<T>,
    pub(crate) views: Renditions<T>,
}

impl<T: Send + Sync + 'static> Cameras<T> {
    /// Cameras by id; `layers` are the names that `render` can draw, all of them drawn unless asked otherwise.
    pub fn new(
        ids: impl IntoIterator<Item = String>,
        layers: &'static [&'static str],
        render: &Arc<Render<T>>,
    ) -> Self {
        let camera = || Camera { feed: PictureFeed::default(), views: Renditions::new(Arc::clone(render)) };
        let cameras = ids.into_iter().map(|id| (id, Arc::new(camera()))).collect();
        Self { cameras, layers, slots: StreamSlots::default() }
    }

    /// Where a camera's owner publishes its pictures.
    #[must_use]
    pub fn feed(&self, id: &str) -> Option<&PictureFeed<T>> {
        self.cameras.get(id).map(|camera| &camera.feed)
    }

    /// Views encoded since the start, by camera: none while nobody looks.
    pub fn encoded(&self) -> impl Iterator<Item = (&str, u64)> {
        self.cameras.iter().map(|(id, camera)| (id.as_str(), camera.views.encoded()))
    }

    /// `/api/v1/cameras`, and below it for each camera `frame.jpg`, `overlay.jpg`, `overlay.png` and `stream.mjpeg`.
    pub fn routes(self: &Arc<Self>) -> Router {
        Router::new()
            .route("/api/v1/cameras", get(index::<T>))
            .route("/api/v1/cameras/{camera}/frame.jpg", get(frame::<T>))
            .route("/api/v1/cameras/{camera}/overlay.jpg", get(overlay_jpeg::<T>))
            .route("/api/v1/cameras/{camera}/overlay.png", get(overlay_png::<T>))
            .route("/api/v1/cameras/{camera}/stream.mjpeg", get(motion::<T>))
            .with_state(Arc::clone(self))
    }

    fn camera(&self, id: &str) -> Result<&Arc<Camera<T>>, Problem> {
        self.cameras.get(id).ok_or_else(|| Problem::not_found(&format!("camera {id:?}")))
    }
}

type Shared<T> = State<Arc<Cameras<T>>>;

/// Which cameras there are and which layers can be drawn.
async fn index<T: Send + Sync + 'static>(State(cameras): Shared<T>) -> Json<Value> {
    Json(json!({ "cameras": cameras.cameras.keys().collect::<Vec<_>>(), "layers": cameras.layers }))
}

async fn frame<T: Send + Sync + 'static>(
    State(cameras): Shared<T>,
    Path(id): Path<String>,
    uri: Uri,
) -> Result<Response, Problem> {
    single(&cameras, &id, &uri, Format::Jpeg, &[]).await
}

async fn overlay_jpeg<T: Send + Sync + 'static>(
    State(cameras): Shared<T>,
    Path(id): Path<String>,
    uri: Uri,
) -> Result<Response, Problem> {
    single(&cameras, &id, &uri, Format::Jpeg, cameras.layers).await
}

async fn overlay_png<T: Send + Sync + 'static>(
    State(cameras): Shared<T>,
    Path(id): Path<String>,
    uri: Uri,
) -> Result<Response, Problem> {
    single(&cameras, &id, &uri, Format::Png, cameras.layers).await
}

async fn single<T: Send + Sync + 'static>(
    cameras: &Cameras<T>,
    id: &str,
    uri: &Uri,
    format: Format,
    layers: &[&'static str],
) -> Result<Response, Problem> {
    let camera = cameras.camera(id)?;
    let mut query = Parameters::parse(uri.query())?;
    let after = query.number("after", 0..=u64::MAX)?;
    let request = view_asked(&mut query, format, layers)?;
    query.finish()?;
    let picture = match after {
        Some(sequence) => camera.feed.after(sequence, LONG_POLL).await?,
        None => camera.feed.latest()?,
    };
    let bytes = camera.views.view(&picture, &request).await?;
    Ok(with_provenance(&picture, format, bytes))
}

async fn motion<T: Send + Sync + 'static>(
    State(cameras): Shared<T>,
    Path(id): Path<String>,
    uri: Uri,
) -> Result<Response, Problem> {
    let camera = cameras.camera(&id)?;
    let mut query = Parameters::parse(uri.query())?;
    let fps = query.number("fps", 1..=60_u32)?.unwrap_or(30);
    let layers = match query.text("overlay").as_deref() {
        None | Some("true") => cameras.layers,
        Some("false") => &[],
        Some(other) => return Err(Problem::parameter("overlay", other, "true or false")),
    };
    let request = view_asked(&mut query, Format::Jpeg, layers)?;
    query.finish()?;
    camera.feed.latest()?;
    let slot = cameras.slots.take()?;
    Ok(stream(Arc::clone(camera), request, Duration::from_secs(1) / fps, slot))
}

/// Reads `width`, `quality` and, where there are layers to choose from, `layers`.
fn view_asked(
    query: &mut Parameters,
    format: Format,
    layers: &[&'static str],
) -> Result<PictureRequest, Problem> {
    let width_px = query.number("width", 16..=3840_u32)?;
    let quality = match format {
        Format::Jpeg => query.number("quality", 1..=100_u8)?.unwrap_or(DEFAULT_QUALITY),
        Format::Png => DEFAULT_QUALITY,
    };
    let layers = if layers.is_empty() {
        None
    } else {
        Some(query.choice("layers", layers)?.unwrap_or_else(|| layers.to_vec()))
    };
    Ok(PictureRequest { format, layers, width_px, quality })
}

fn with_provenance<T>(picture: &Picture<T>, format: Format, bytes: Bytes) -> Response {
    let mut headers = HeaderMap::new();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(format.content_type()));
    for (name, value) in provenance(picture) {
        headers.insert(HeaderName::from_static(name), value);
    }
    (headers, bytes).into_response()
}

/// Which frame a picture shows: sequence, capture time in ns since the Unix epoch, age in ms since it was received.
pub(crate) fn provenance<T>(picture: &Picture<T>) -> [(&'static str, HeaderValue); 3] {
    let age_ms = u64::try_from(picture.age().as_millis()).unwrap_or(u64::MAX);
    [
        ("x-waymark-sequence", HeaderValue::from(picture.sequence)),
        ("x-waymark-captured-at", HeaderValue::from(picture.captured_at_ns)),
        ("x-waymark-age-ms", HeaderValue::from(age_ms)),
    ]
}
