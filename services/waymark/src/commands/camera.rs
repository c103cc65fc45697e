//! `waymark camera` and `waymark simulate`.

use ::camera::CameraConfig;

use crate::commands::service::{ConfigArgs, run_until_signal};
use crate::exit::{Ending, Failure};

/// Publish pictures from files, a recording or the simulator as a vehicle's camera
///
/// `source` names where they come from: a directory or glob of pictures, mcap:FILE#TOPIC, or sim:SCENE?seed=N.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    config: ConfigArgs,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let config: CameraConfig = args.config.read()?;
    let (zenoh, log) = (config.zenoh.clone(), config.log.clone());
    run_until_signal(&zenoh, &log, async |session, shutdown| {
        ::camera::run(config, session, shutdown).await?;
        Ok(Ending::Fine)
    })
}
