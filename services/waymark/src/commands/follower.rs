//! `waymark follower`.

use ::follower::{FollowerConfig, FollowerReport};

use crate::commands::service::{ConfigArgs, run_until_signal};
use crate::exit::{Ending, Failure};

/// Look for the leader's landmarks in this vehicle's cameras
///
/// Takes pictures and landmarks from Zenoh, publishes and records what it sees, and serves a page on http.listen
/// (127.0.0.1:8080).
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    config: ConfigArgs,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let config: FollowerConfig = args.config.read()?;
    let (zenoh, log) = (config.zenoh.clone(), config.log.clone());
    run_until_signal(&zenoh, &log, async |session, shutdown| {
        Ok(ending(&::follower::run(config, session, shutdown).await?))
    })
}

/// Whether everything that was offered to the recorder is on disk, and every camera was looked through to the end.
pub(crate) fn ending(report: &FollowerReport) -> Ending {
    let lost = report.recorder.ledger.total().lost();
    let sound = lost == 0 && report.recorder.in_time && report.failed_cameras.is_empty();
    if sound { Ending::Fine } else { Ending::DataLost }
}
