//! `waymark leader`.

use ::leader::LeaderConfig;

use crate::commands::service::{ConfigArgs, run_until_signal};
use crate::exit::{Ending, Failure};

/// Publish a vehicle's landmarks
///
/// Publishes the landmarks of its files, answers late joiners, takes changes from `waymark landmark publish` and
/// `retire`, and serves a page on http.listen (127.0.0.1:8081).
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    config: ConfigArgs,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let config: LeaderConfig = args.config.read()?;
    let (zenoh, log) = (config.zenoh.clone(), config.log.clone());
    run_until_signal(&zenoh, &log, async |session, shutdown| {
        ::leader::run(config, session, shutdown).await?;
        Ok(Ending::Fine)
    })
}
