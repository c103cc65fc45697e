//! The player's routes on the shared web face: what it does, and what may be asked of it.

use std::time::Duration;

use axum::extract::{Path, RawQuery, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use http_face::{Check, Parameters, Problem, health};

use crate::control::{Command, Control};
use crate::tempo::Rate;

/// All routes of a player.
pub fn routes(control: Control) -> Router {
    Router::new()
        .route("/livez", get(|| async { health(vec![Check::pass("process", "answers")]) }))
        .route("/api/v1/player", get(status))
        .route("/api/v1/player/{command}", post(command))
        .with_state(control)
}

async fn status(State(control): State<Control>) -> Response {
    Json(control.status()).into_response()
}

async fn command(
    State(control): State<Control>,
    Path(name): Path<String>,
    RawQuery(query): RawQuery,
) -> Result<Response, Problem> {
    let mut parameters = Parameters::parse(query.as_deref())?;
    let asked = match name.as_str() {
        "pause" => Command::Pause,
        "resume" => Command::Resume,
        "seek" => Command::Seek(Duration::from_secs_f64(required(&mut parameters, "to_s", 0.0..=1e9)?)),
        "rate" => {
            let rate = required(&mut parameters, "value", 0.0..=1000.0)?;
            let refused = |_| Problem::parameter("value", &rate.to_string(), "0, or 0.01 to 1000");
            Command::Rate(Rate::new(rate).map_err(refused)?)
        }
        "stop" => Command::Stop,
        other => {
            return Err(Problem::not_found(&format!(
                "command {other:?}; there are pause, resume, seek, rate and stop"
            )));
        }
    };
    parameters.finish()?;
    if control.ask(asked) {
        Ok(StatusCode::ACCEPTED.into_response())
    } else {
        Err(Problem::unavailable(
            "the player has ended, or was asked too much at once",
            Duration::from_secs(1),
        ))
    }
}

fn required(
    parameters: &mut Parameters,
    name: &'static str,
    allowed: std::ops::RangeInclusive<f64>,
) -> Result<f64, Problem> {
    let limits = format!("a number from {} to {}", allowed.start(), allowed.end());
    parameters.number(name, allowed)?.ok_or_else(|| Problem::parameter(name, "", &limits))
}
