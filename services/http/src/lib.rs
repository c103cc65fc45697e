//! The web face that leader and follower share: a hardened accept loop, problem details, picture and event streams,
//! the embedded page.
//!
//! It knows bytes and sequences, not landmarks: pictures are drawn by a function its owner hands in, events and
//! documents are JSON that its owner makes. A service puts an [`Api`] together from [`Cameras::routes`] and routes of its
//! own, adds the [`page`], and hands it to [`serve`]:
//!
//! ```no_run
//! # async fn example(stop: impl Future<Output = ()>) -> std::io::Result<()> {
//! use axum::routing::get;
//! use http_face::{Api, Check, Health, Operation, Policy, health, page, serve};
//!
//! let alive = Operation::get("Whether the process answers").gives::<Health>();
//! let api = Api::new("Example", "1")
//!     .route("/livez", [alive], get(|| async { health(vec![Check::pass("process", "answers")]) }))
//!     .undescribed(page());
//! let listener = tokio::net::TcpListener::bind("127.0.0.1:8080").await?;
//! let report = serve(listener, api.finish(), Policy::default(), stop).await;
//! # let _ = report; Ok(()) }
//! ```
//!
//! What was turned away is counted by reason in [`Counters`], which routes find as `Extension<Arc<Counters>>`.
//! Every answer carries `X-Waymark-Access`: `open`, `token` or `read_only` (see [`Access`]).

mod api;
mod bare_answer;
mod cameras;
mod conditional;
mod connection;
mod counters;
mod documents;
mod events;
mod files;
mod guard;
mod health;
mod json_body;
mod metrics_text;
mod mjpeg;
mod page;
mod parameters;
mod picture_request;
mod pictures;
mod policy;
mod problem;
mod renditions;
mod serve;
mod settings;
mod shell;
mod stall;
mod told_picture;
mod viewers;

pub use api::{Api, Operation, integer};
pub use cameras::{Cameras, picture_answer};
pub use conditional::{conditional, entity_tag};
pub use counters::{Counters, Refusal};
pub use documents::{Documents, Served};
pub use events::Events;
pub use files::{ServedFile, serve_file};
pub use health::{Check, Health, health};
pub use json_body::json_body;
pub use metrics_text::metrics_text;
pub use page::page;
pub use parameters::Parameters;
pub use picture_request::{Format, PictureRequest};
pub use pictures::{Picture, PictureFeed, STALE_AFTER, camera_state};
pub use policy::{Access, Policy, Token, TokenError};
pub use problem::{PROBLEM_JSON, Problem};
pub use renditions::{Depiction, Render, Tell};
pub use serve::{ServeReport, serve};
pub use settings::HttpSettings;
pub use viewers::ForViewers;
