//! `waymark config check`.

use ::camera::CameraConfig;
use ::follower::FollowerConfig;
use ::leader::LeaderConfig;
use runtime::SessionSettings;
use runtime::telemetry::LogSettings;

use super::Service;
use crate::commands::service::ConfigArgs;
use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Say whether a service could start with this configuration
///
/// Besides keys and kinds of values, looks at ids, the token file, landmark files, the camera's source and Zenoh's own
/// configuration file; nothing is opened on the network. Exit code 0 when all is well, 2 with the place and the remedy
/// when not. `waymark doctor` looks at the rest.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Whose configuration
    service: Service,

    #[command(flatten)]
    config: ConfigArgs,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    match args.service {
        Service::Leader => {
            let config: LeaderConfig = args.config.read()?;
            shared(&config.zenoh, &config.log)?;
            config.check().or_usage()?;
        }
        Service::Follower => {
            let config: FollowerConfig = args.config.read()?;
            shared(&config.zenoh, &config.log)?;
            config.check().or_usage()?;
        }
        Service::Camera => {
            let config: CameraConfig = args.config.read()?;
            shared(&config.zenoh, &config.log)?;
            config.check().or_usage()?;
        }
    }
    console.note("the configuration is in order");
    Ok(Ending::Fine)
}

fn shared(zenoh: &SessionSettings, log: &LogSettings) -> Result<(), Failure> {
    zenoh.check().or_usage()?;
    log.check().or_usage()
}
