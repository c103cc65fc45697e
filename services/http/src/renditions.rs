//! Encoded views of a picture, each made once however many look at it, and none when nobody looks.

use crate::picture_request::PictureRequest;
use crate::pictures::Picture;
use crate::problem::Problem;
use axum::body::Bytes;
use axum::http::StatusCode;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::{OnceCell, Semaphore};

/// Draws and encodes one view; runs on a thread that may block. The error is told to the viewer.
pub type Render<T> = dyn Fn(&T, &PictureRequest) -> Result<Vec<u8>, String> + Send + Sync;

/// Tells what was seen in a picture, as JSON; made at once, so it must be cheap.
pub type Tell<T> = dyn Fn(&T) -> serde_json::Result<String> + Send + Sync;

/// How an owner shows its pictures.
pub struct Depiction<T> {
    /// Draws and encodes.
    pub render: Arc<Render<T>>,
    /// The picture as it came, where it is a JPEG: shown without being decoded when that is all that is asked for.
    pub own_jpeg: fn(&T) -> Option<Bytes>,
    /// What was seen in it, where something is looked for.
    pub told: Option<Arc<Tell<T>>>,
}

/// Views kept of the newest picture; further ones are made but not kept.
const MAX_KEPT: usize = 16;

/// Encodes under way at once for one camera, so that viewers cannot take the registration's cores.
const MAX_ENCODES: usize = 1;

type Cell = Arc<OnceCell<Bytes>>;

/// The views of one picture, known by sequence and capture time: a camera that starts anew counts anew.
#[derive(Default)]
struct Kept {
    picture: (u64, i64),
    views: HashMap<PictureRequest, Cell>,
}

/// Makes views of one camera's pictures.
pub(crate) struct Renditions<T> {
    depiction: Arc<Depiction<T>>,
    encodes: Arc<Semaphore>,
    encoded: AtomicU64,
    kept: Mutex<Kept>,
}

impl<T: Send + Sync + 'static> Renditions<T> {
    /// Views made as `depiction` says.
    pub(crate) fn new(depiction: Arc<Depiction<T>>) -> Self {
        let encodes = Arc::new(Semaphore::new(MAX_ENCODES));
        Self { depiction, encodes, encoded: AtomicU64::new(0), kept: Mutex::default() }
    }

    /// Views encoded since the start.
    pub(crate) fn encoded(&self) -> u64 {
        self.encoded.load(Ordering::Relaxed)
    }

    /// What was seen in this picture, where something is looked for.
    ///
    /// # Errors
    /// 500 when it has no JSON form.
    pub(crate) fn told(&self, picture: &Picture<T>) -> Result<Option<String>, Problem> {
        let told = self.depiction.told.as_ref().map(|told| told(&picture.source));
        told.transpose().map_err(|error| Problem::internal(&error))
    }

    /// The view of this picture: as it came if that is what is asked for, else made now unless another viewer had it
    /// made already.
    ///
    /// # Errors
    /// 500 when the picture cannot be drawn or encoded.
    pub(crate) async fn view(
        &self,
        picture: &Picture<T>,
        request: &PictureRequest,
    ) -> Result<Bytes, Problem> {
        if request.is_met_by_own_jpeg()
            && let Some(jpeg) = (self.depiction.own_jpeg)(&picture.source)
        {
            return Ok(jpeg);
        }
        let cell = self.cell(picture, request);
        cell.get_or_try_init(|| self.encode(Arc::clone(&picture.source), request.clone())).await.cloned()
    }

    fn cell(&self, picture: &Picture<T>, request: &PictureRequest) -> Cell {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let identity = (picture.sequence, picture.captured_at_ns);
        if kept.picture != identity {
            *kept = Kept { picture: identity, views: HashMap::new() };
        }
        if kept.views.len() >= MAX_KEPT && !kept.views.contains_key(request) {
            return Cell::default();
        }
        Arc::clone(kept.views.entry(request.clone()).or_default())
    }

    async fn encode(&self, source: Arc<T>, request: PictureRequest) -> Result<Bytes, Problem> {
        let failed = |detail: String| Problem::new(StatusCode::INTERNAL_SERVER_ERROR, detail);
        let permit =
            Arc::clone(&self.encodes).acquire_owned().await.map_err(|error| failed(error.to_string()))?;
        let render = Arc::clone(&self.depiction.render);
        self.encoded.fetch_add(1, Ordering::Relaxed);
        let encoded = tokio::task::spawn_blocking(move || {
            let _permit = permit;
            render(&source, &request)
        });
        match encoded.await {
            Ok(Ok(bytes)) => Ok(Bytes::from(bytes)),
            Ok(Err(reason)) => Err(failed(format!("the picture cannot be shown: {reason}"))),
            Err(_) => Err(failed("drawing the picture failed".to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture_request::Format;
    use tokio::time::Instant;

    fn request(quality: u8) -> PictureRequest {
        PictureRequest { format: Format::Jpeg, layers: None, width_px: None, quality: Some(quality) }
    }

    fn drawn_by(
        render: impl Fn(&u8, &PictureRequest) -> Result<Vec<u8>, String> + Send + Sync + 'static,
    ) -> Renditions<u8> {
        let own_jpeg = |_: &u8| Some(Bytes::from_static(b"own"));
        Renditions::new(Arc::new(Depiction { render: Arc::new(render), own_jpeg, told: None }))
    }

    fn picture(sequence: u64) -> Picture<u8> {
        Picture { sequence, captured_at_ns: 0, received_at: Instant::now(), source: Arc::new(9) }
    }

    #[tokio::test]
    async fn many_viewers_cost_one_encode_and_none_cost_nothing() {
        let views = drawn_by(|source, request| Ok(vec![*source, request.quality.unwrap()]));
        assert_eq!(views.encoded(), 0);
        let (picture, request) = (picture(1), request(80));
        let all = futures_util::future::join_all((0..50).map(|_| views.view(&picture, &request))).await;
        assert!(all.iter().all(|view| view.as_ref().unwrap().as_ref() == [9, 80]));
        assert_eq!(views.encoded(), 1);
    }

    #[tokio::test]
    async fn other_parameters_and_other_pictures_are_made_anew_and_memory_is_bounded() {
        let views = drawn_by(|_, request| Ok(vec![request.quality.unwrap()]));
        for quality in 1..=100 {
            assert_eq!(views.view(&picture(1), &request(quality)).await.unwrap().as_ref(), [quality]);
        }
        assert_eq!(views.kept.lock().unwrap().views.len(), MAX_KEPT);
        views.view(&picture(2), &request(1)).await.unwrap();
        assert_eq!(views.kept.lock().unwrap().views.len(), 1);
    }

    #[tokio::test]
    async fn a_jpeg_is_shown_as_it_came_unless_something_else_is_asked_for() {
        let views = drawn_by(|_, _| Ok(b"made".to_vec()));
        let whole = PictureRequest { quality: None, ..request(80) };
        let with = |layers| PictureRequest { layers: Some(layers), ..whole.clone() };
        for as_it_came in [whole.clone(), with(Vec::new())] {
            assert_eq!(views.view(&picture(1), &as_it_came).await.unwrap(), "own");
        }
        assert_eq!(views.encoded(), 0);
        let exact = PictureRequest { format: Format::Png, ..whole.clone() };
        let smaller = PictureRequest { width_px: Some(64), ..whole.clone() };
        for other in [request(80), exact, smaller, with(vec!["mask"])] {
            assert_eq!(views.view(&picture(1), &other).await.unwrap(), "made");
        }
        assert_eq!(views.encoded(), 4);
    }

    #[tokio::test]
    async fn a_picture_that_cannot_be_drawn_is_a_problem() {
        let views = drawn_by(|_, _| Err("no decoder".to_owned()));
        let problem = views.view(&picture(1), &request(80)).await.unwrap_err();
        assert_eq!(problem.status(), 500);
        assert!(problem.to_string().contains("no decoder"));
    }
}
