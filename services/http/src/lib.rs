//! The web face that leader and follower share: a hardened accept loop, problem details, picture and event streams,
//! the embedded page.
//!
//! It knows bytes and sequences, not landmarks: pictures are drawn by a function its owner hands in, events and
//! documents are JSON that its owner makes. A service puts a router together from [`page`], [`Cameras::routes`] and
//! routes of its own, and hands it to [`serve`]:
//!
//! ```no_run
//! # async fn example(stop: impl Future<Output = ()>) -> std::io::Result<()> {
//! use axum::routing::get;
//! use http_face::{Check, Policy, health, page, serve};
//!
//! let router = page().route("/livez", get(|| async { health(&[Check::pass("process", "answers")]) }));
//! let listener = tokio::net::TcpListener::bind("127.0.0.1:8080").await?;
//! let report = serve(listener, router, Policy::default(), stop).await;
//! # let _ = report; Ok(()) }
//! ```
//!
//! What was turned away is counted by reason in [`Counters`], which routes find as `Extension<Arc<Counters>>`.
//! Every answer carries `X-Waymark-Access`: `open`, `token` or `read_only` (see [`Access`]).

mod bare_answer;
mod cameras;
mod conditional;
mod connection;
mod counters;
mod documents;
mod events;
mod guard;
mod health;
mod metrics_text;
mod mjpeg;
mod page;
mod parameters;
mod pictures;
mod policy;
mod problem;
mod renditions;
mod serve;
mod settings;
mod shell;
mod stall;

pub use cameras::Cameras;
pub use conditional::{conditional, entity_tag};
pub use counters::{Counters, Refusal};
pub use documents::documents;
pub use events::Events;
pub use health::{Check, health};
pub use metrics_text::metrics_text;
pub use page::page;
pub use parameters::Parameters;
pub use pictures::{Picture, PictureFeed, STALE_AFTER};
pub use policy::{Access, Policy, Token, TokenError};
pub use problem::{PROBLEM_JSON, Problem};
pub use renditions::{Format, PictureRequest, Render};
pub use serve::{ServeReport, serve};
pub use settings::HttpSettings;
