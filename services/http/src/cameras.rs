//! The pictures of every camera over HTTP: single ones by long-poll and streams.

mod description;

use crate::api::{Api, Operation};
use crate::mjpeg::{StreamSlots, stream};
use crate::parameters::Parameters;
use crate::picture_request::{Format, PictureRequest};
use crate::pictures::{Picture, PictureFeed};
use crate::problem::Problem;
use crate::renditions::{Depiction, Renditions};
use crate::told_picture::told_picture;
use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Uri};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::time::Duration;

/// How long a request with `after` waits for a newer picture.
const LONG_POLL: Duration = Duration::from_secs(5);

/// Pictures per second of a stream.
const RATES_HZ: RangeInclusive<u32> = 1..=60;

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
    /// Cameras by id; `layers` are the names that can be drawn, all of them in an overlay unless asked otherwise.
    pub fn new(
        ids: impl IntoIterator<Item = String>,
        layers: &'static [&'static str],
        depiction: Depiction<T>,
    ) -> Self {
        let depiction = Arc::new(depiction);
        let camera =
            || Camera { feed: PictureFeed::default(), views: Renditions::new(Arc::clone(&depiction)) };
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

    /// `/api/v1/cameras`, and below it for each camera `frame.jpg`, `overlay.jpg`, `overlay.png`, `seen` and
    /// `stream.mjpeg`.
    #[must_use]
    pub fn routes(self: &Arc<Self>, api: Api) -> Api {
        let shared = || Arc::clone(self);
        let index_of =
            Operation::get("Which cameras there are, and which layers can be drawn over their pictures");
        let bare = description::jpeg("The newest frame", &[]);
        let drawn = description::jpeg("The newest frame, with what was seen in it", self.layers);
        let exact = description::png("The same without loss", self.layers);
        let seen_of = description::seen(self.layers);
        let motion_of = description::stream(self.layers);
        let at = |name: &str| format!("/api/v1/cameras/{{camera}}/{name}");
        api.route("/api/v1/cameras", [index_of.gives::<Index>()], get(index::<T>).with_state(shared()))
            .route(&at("frame.jpg"), [bare], get(frame::<T>).with_state(shared()))
            .route(&at("overlay.jpg"), [drawn], get(overlay_jpeg::<T>).with_state(shared()))
            .route(&at("overlay.png"), [exact], get(overlay_png::<T>).with_state(shared()))
            .route(&at("seen"), [seen_of], get(seen::<T>).with_state(shared()))
            .route(&at("stream.mjpeg"), [motion_of], get(motion::<T>).with_state(shared()))
    }

    fn camera(&self, id: &str) -> Result<&Arc<Camera<T>>, Problem> {
        self.cameras.get(id).ok_or_else(|| Problem::not_found(&format!("camera {id:?}")))
    }
}

type Shared<T> = State<Arc<Cameras<T>>>;

/// Which cameras there are and which layers can be drawn.
#[derive(Serialize, JsonSchema)]
struct Index {
    /// Ids.
    cameras: Vec<String>,
    /// Names for `layers`.
    layers: &'static [&'static str],
}

async fn index<T: Send + Sync + 'static>(State(cameras): Shared<T>) -> Json<Index> {
    Json(Index { cameras: cameras.cameras.keys().cloned().collect(), layers: cameras.layers })
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
    let request = PictureRequest::asked(&mut query, format, layers)?;
    query.finish()?;
    let picture = camera.wait(after).await?;
    let bytes = camera.views.view(&picture, &request).await?;
    let response = ([(CONTENT_TYPE, format.content_type())], bytes).into_response();
    Ok(with_provenance(&picture, response))
}

/// A picture and what was seen in it, in one answer: neither can be of another frame.
async fn seen<T: Send + Sync + 'static>(
    State(cameras): Shared<T>,
    Path(id): Path<String>,
    uri: Uri,
) -> Result<Response, Problem> {
    let camera = cameras.camera(&id)?;
    let mut query = Parameters::parse(uri.query())?;
    let after = query.number("after", 0..=u64::MAX)?;
    let format = match query.text("format").as_deref() {
        None | Some("jpg") => Format::Jpeg,
        Some("png") => Format::Png,
        Some(other) => return Err(Problem::parameter("format", other, "jpg or png")),
    };
    let request = PictureRequest::bare_unless_asked(&mut query, format, cameras.layers)?;
    query.finish()?;
    let picture = camera.wait(after).await?;
    let bytes = camera.views.view(&picture, &request).await?;
    let told = camera.views.told(&picture)?;
    Ok(with_provenance(&picture, told_picture(format, &bytes, told.as_deref())))
}

impl<T: Send + Sync + 'static> Camera<T> {
    /// The newest picture, or the first that is not `after`.
    async fn wait(&self, after: Option<u64>) -> Result<Picture<T>, Problem> {
        match after {
            Some(sequence) => self.feed.after(sequence, LONG_POLL).await,
            None => self.feed.latest(),
        }
    }
}

async fn motion<T: Send + Sync + 'static>(
    State(cameras): Shared<T>,
    Path(id): Path<String>,
    uri: Uri,
) -> Result<Response, Problem> {
    let camera = cameras.camera(&id)?;
    let mut query = Parameters::parse(uri.query())?;
    let fps = query.number("fps", RATES_HZ)?.unwrap_or(30);
    let layers = match query.text("overlay").as_deref() {
        None | Some("true") => cameras.layers,
        Some("false") => &[],
        Some(other) => return Err(Problem::parameter("overlay", other, "true or false")),
    };
    let request = PictureRequest::asked(&mut query, Format::Jpeg, layers)?;
    query.finish()?;
    camera.feed.latest()?;
    let slot = cameras.slots.take()?;
    Ok(stream(Arc::clone(camera), request, Duration::from_secs(1) / fps, slot))
}

fn with_provenance<T>(picture: &Picture<T>, mut response: Response) -> Response {
    let named = provenance(picture).map(|(name, value)| (HeaderName::from_static(name), value));
    response.headers_mut().extend(named);
    response
}

/// A picture with what it shows: the frame's number in its stream, and its capture time in ns since the Unix epoch.
#[must_use]
pub fn picture_answer(sequence: u64, captured_at_ns: i64, format: Format, bytes: Bytes) -> Response {
    let mut headers = HeaderMap::new();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(format.content_type()));
    headers.insert(HeaderName::from_static(SEQUENCE), HeaderValue::from(sequence));
    headers.insert(HeaderName::from_static(CAPTURED_AT), HeaderValue::from(captured_at_ns));
    (headers, bytes).into_response()
}

const SEQUENCE: &str = "x-waymark-sequence";
const CAPTURED_AT: &str = "x-waymark-captured-at";
const AGE: &str = "x-waymark-age-ms";

fn age_ms<T>(picture: &Picture<T>) -> u64 {
    u64::try_from(picture.age().as_millis()).unwrap_or(u64::MAX)
}

/// Which frame a picture shows: sequence, capture time in ns since the Unix epoch, age in ms since it was received.
pub(crate) fn provenance<T>(picture: &Picture<T>) -> [(&'static str, HeaderValue); 3] {
    [
        (SEQUENCE, HeaderValue::from(picture.sequence)),
        (CAPTURED_AT, HeaderValue::from(picture.captured_at_ns)),
        (AGE, HeaderValue::from(age_ms(picture))),
    ]
}
