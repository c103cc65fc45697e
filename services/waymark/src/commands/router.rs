//! `waymark router`.

use std::path::PathBuf;

use leader::store::Store;
use runtime::SessionSettings;
use runtime::telemetry::LogSettings;

use crate::commands::service::run_until_signal;
use crate::exit::{Ending, Failure};

/// Connect leaders, followers and cameras with each other
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Endpoint to listen on; several machines need one that they can reach, as in tcp/0.0.0.0:7447
    #[arg(long, value_name = "ENDPOINT", default_value = "tcp/127.0.0.1:7447")]
    listen: String,

    /// Zenoh configuration (JSON5) to be used as it is, for TLS, users and access control
    #[arg(long, value_name = "FILE", conflicts_with = "listen")]
    zenoh: Option<PathBuf>,

    /// Directory in which every leader's landmarks are kept, to answer for leaders that are gone
    #[arg(long, value_name = "DIR")]
    store: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let settings = SessionSettings { file: args.zenoh.clone(), ..SessionSettings::router(&args.listen) };
    run_until_signal(&settings, &LogSettings::default(), async |session, shutdown| {
        tracing::info!(listen = args.listen, "router");
        match &args.store {
            Some(directory) => Store::open(&session, directory).await?.run(shutdown).await,
            None => shutdown.requested().await,
        }
        Ok(Ending::Fine)
    })
}
