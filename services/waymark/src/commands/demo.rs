//! `waymark demo`: a whole convoy in one process, every part with a Zenoh session of its own over loopback TCP.

mod convoy;
mod score;
mod summary;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use analysis::lesson;
use anyhow::Context;
use runtime::Shutdown;
use runtime::telemetry::{LogSettings, start_logging};
use simulator::SceneKind;

use crate::commands::follower::ending;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Watch a convoy on this machine: router, simulated cameras, leader and follower
///
/// The leader learns its landmarks from its own camera and publishes them; the follower looks for them in its own,
/// under other light, records to `recordings/` and shows everything on its page. Nothing is opened to other machines.
/// Ends after --duration, or with Ctrl-C, and says how well the follower did against what the simulator really
/// showed.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Scene: rink, stop-sign or green-signs
    #[arg(long, default_value = "rink")]
    scene: SceneKind,

    /// How long, as in 20s, 5m or 1h; until Ctrl-C when not given
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration)]
    duration: Option<Duration>,

    /// No invitation to look at the page; only its address
    #[arg(long)]
    headless: bool,

    /// One JSON object at the end instead of the table
    #[arg(long)]
    json: bool,

    /// Positions, colours, light and noise of the scene
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Address of the follower's page
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080")]
    listen: SocketAddr,

    /// Address of the leader's page
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8081")]
    leader_listen: SocketAddr,

    /// Where the recording goes
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    recordings: PathBuf,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let lesson = lesson::learn_from(args.scene, args.seed)
        .context("the leader could not learn its landmarks")
        .or_usage()?;
    start_logging(&LogSettings { filter: "warn,zenoh=error".to_owned(), ..LogSettings::default() })
        .or_usage()?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let driven = runtime.block_on(async {
        let shutdown = Shutdown::on_signals()?;
        let convoy = convoy::Convoy::start(args, lesson, &shutdown).await?;
        console.note(&convoy.greeting(args.headless));
        convoy.drive(args.duration, &shutdown).await
    })?;
    summary::write(&driven, args.json)?;
    Ok(ending(&driven.follower))
}
