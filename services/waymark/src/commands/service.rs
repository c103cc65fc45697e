//! What the long-running commands share: where their configuration comes from, and how they are run to their end.

use std::future::Future;
use std::path::PathBuf;

use runtime::config::Layers;
use runtime::telemetry::{LogSettings, start_logging};
use runtime::{SessionSettings, Shutdown};
use serde::Serialize;
use serde::de::DeserializeOwned;
use zenoh::Session;

use crate::exit::{Ending, Failure, OrUsage};

/// Where a service's configuration comes from.
#[derive(Debug, clap::Args)]
pub(crate) struct ConfigArgs {
    /// Configuration file (TOML); may be given several times, later ones win
    #[arg(long = "config", short = 'c', value_name = "FILE")]
    files: Vec<PathBuf>,

    /// One setting, as in `--set http.listen=0.0.0.0:8080`; wins over files and WAYMARK__… variables
    #[arg(long = "set", value_name = "KEY=VALUE")]
    assignments: Vec<String>,
}

impl ConfigArgs {
    /// The configuration from all its layers.
    pub(crate) fn read<C: Serialize + DeserializeOwned + Default>(&self) -> Result<C, Failure> {
        self.layers::<C>()?.extract().or_usage()
    }

    /// The layers themselves, each key with the place that sets it.
    pub(crate) fn layers<C: Serialize + Default>(&self) -> Result<Layers, Failure> {
        let mut layers = Layers::of_defaults(&C::default()).or_usage()?;
        for file in &self.files {
            layers = layers.file(file).or_usage()?;
        }
        layers = layers.environment(std::env::vars()).or_usage()?;
        for assignment in &self.assignments {
            layers = layers.set(assignment).or_usage()?;
        }
        Ok(layers)
    }
}

/// Opens the session, runs `service` until SIGINT or SIGTERM, and closes the session.
pub(crate) fn run_until_signal<S, R>(
    settings: &SessionSettings,
    log: &LogSettings,
    service: S,
) -> Result<Ending, Failure>
where
    S: FnOnce(Session, Shutdown) -> R,
    R: Future<Output = anyhow::Result<Ending>>,
{
    start_logging(log).or_usage()?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    runtime.block_on(async {
        let shutdown = Shutdown::on_signals()?;
        let session = settings.open().await.map_err(anyhow::Error::from)?;
        let ended = service(session.clone(), shutdown).await;
        // Whoever is still connected sees the session end by itself should this fail.
        let _ = session.close().await;
        Ok(ended?)
    })
}
