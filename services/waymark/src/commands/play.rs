//! `waymark play`.

mod keyboard;
mod progress;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::Context;
use http_face::Policy;
use player::tempo::Rate;
use player::{Command, Control, PlayOptions, Remap, play, routes};
use runtime::telemetry::LogSettings;
use runtime::{SessionSettings, Shutdown};
use tokio::net::TcpListener;
use zenoh::Session;

use crate::commands::service::run_until_signal;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};
use keyboard::Keyboard;

const KEYS: &str = "\
Keys: space pauses and goes on, f and b go 10 s forward and back, + and - double and halve the rate, q ends.
HTTP: GET /api/v1/player; POST /api/v1/player/pause, resume, stop, seek?to_s=SECONDS, rate?value=RATE.

The landmarks, manifests and calibrations in force are published before each start and after each seek.";

/// Publish recordings again, as they were recorded: same keys, same bytes, same times
///
/// Several recordings are played one after the other, in the order of their first messages.
#[derive(Debug, clap::Args)]
#[command(after_help = KEYS)]
pub(crate) struct Args {
    /// Recordings (FILE.mcap), finished or not
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,

    /// Recorded seconds per second, 0.01 to 1000; 0 for as fast as possible
    #[arg(long, default_value_t = 1.0)]
    rate: f64,

    /// Begin again at the end
    #[arg(long = "loop")]
    repeat: bool,

    /// Where to begin, from the beginning of the first recording, as in 90s or 2m
    #[arg(long, value_name = "TIME", default_value = "0s", value_parser = humantime::parse_duration)]
    start: Duration,

    /// Keys that begin with FROM begin with TO instead; may be given several times
    #[arg(long = "remap", value_name = "FROM=TO")]
    remaps: Vec<Remap>,

    /// Wait to be resumed, by key or over HTTP
    #[arg(long)]
    paused: bool,

    /// Address of the control over HTTP
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8090")]
    listen: SocketAddr,

    /// Endpoint of the router
    #[arg(long, visible_alias = "router", value_name = "ENDPOINT", default_value = "tcp/127.0.0.1:7447")]
    connect: String,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let rate = Rate::new(args.rate).or_usage()?;
    for file in &args.recordings {
        std::fs::metadata(file).with_context(|| format!("cannot read `{}`", file.display())).or_usage()?;
    }
    let settings = SessionSettings { connect: vec![args.connect.clone()], ..SessionSettings::default() };
    let options = PlayOptions {
        files: args.recordings.clone(),
        rate,
        start: args.start,
        repeat: args.repeat,
        paused: args.paused,
        remaps: args.remaps.clone(),
    };
    let listen = args.listen;
    run_until_signal(&settings, &LogSettings::default(), async move |session, shutdown| {
        play_until_done(options, listen, console, session, shutdown).await
    })
}

async fn play_until_done(
    options: PlayOptions,
    listen: SocketAddr,
    console: Console,
    session: Session,
    shutdown: Shutdown,
) -> anyhow::Result<Ending> {
    let listener = TcpListener::bind(listen).await.with_context(|| format!("cannot listen on {listen}"))?;
    let address = listener.local_addr()?;
    let (control, thread) = play(options, session)?;
    tracing::info!(control = %address, "playing");
    let _keyboard = Keyboard::begin(control.clone());
    let shown = tokio::spawn(progress::show(control.clone(), console));
    let web = tokio::spawn(http_face::serve(listener, routes(control.clone()), Policy::default(), {
        let shutdown = shutdown.clone();
        async move { shutdown.requested().await }
    }));
    let stopper = tokio::spawn(stop_when_asked(control, shutdown.clone()));
    let played = tokio::task::spawn_blocking(move || thread.join()).await?;
    shutdown.request();
    let (_served, _stopped, _shown) = (web.await, stopper.await, shown.await);
    let report = played.map_err(|_panic| player::PlayError::Panicked)??;
    tracing::info!(published = report.status.published, "played");
    Ok(Ending::Fine)
}

async fn stop_when_asked(control: Control, shutdown: Shutdown) {
    shutdown.requested().await;
    // A player that has ended already needs no asking.
    let _ended = control.ask(Command::Stop);
}
