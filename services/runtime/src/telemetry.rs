//! Logs on standard error.

use std::io::IsTerminal;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tracing::Level;
use tracing_subscriber::filter::{ParseError, Targets};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::{SubscriberInitExt, TryInitError};
use tracing_subscriber::{EnvFilter, Layer, fmt};

use crate::link_trouble::{self, LinkTrouble};

/// What a line of log looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LogFormat {
    /// For people.
    #[default]
    Text,
    /// One JSON object a line.
    Json,
}

/// The `log` part of a configuration.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LogSettings {
    /// What a line looks like.
    pub format: LogFormat,
    /// What is logged, as in `info,leader=debug`.
    pub filter: String,
}

impl Default for LogSettings {
    fn default() -> Self {
        // Zenoh tells of every connection attempt; ours say what matters.
        Self { format: LogFormat::Text, filter: "info,zenoh=warn,zenoh_transport=error".to_owned() }
    }
}

/// Why telemetry could not start.
#[derive(Debug, thiserror::Error)]
pub enum TelemetryError {
    /// The filter is none.
    #[error("log.filter is {filter:?}: {source}; write it like \"info,leader=debug\"")]
    Filter {
        /// The filter.
        filter: String,
        /// What is wrong with it.
        source: ParseError,
    },
    /// Something else took the process's log already.
    #[error("logging was started twice in this process: {0}")]
    LoggingTwice(#[from] TryInitError),
}

impl LogSettings {
    /// Looks whether the filter is one.
    ///
    /// # Errors
    /// When it is none.
    pub fn check(&self) -> Result<(), TelemetryError> {
        self.env_filter().map(drop)
    }

    fn env_filter(&self) -> Result<EnvFilter, TelemetryError> {
        EnvFilter::try_new(&self.filter)
            .map_err(|source| TelemetryError::Filter { filter: self.filter.clone(), source })
    }
}

/// Starts logging on standard error, for the whole process. What Zenoh says about failed connections is kept for
/// [`link_trouble::newest`], whether or not the filter lets it through.
///
/// # Errors
/// When the filter is none, or the process logs already.
pub fn start_logging(settings: &LogSettings) -> Result<(), TelemetryError> {
    let lines = fmt::layer().with_ansi(std::io::stderr().is_terminal()).with_writer(std::io::stderr);
    let lines = match settings.format {
        LogFormat::Text => lines.boxed(),
        LogFormat::Json => lines.json().boxed(),
    };
    let of_connecting = Targets::new().with_target(link_trouble::SPEAKER, Level::DEBUG);
    tracing_subscriber::registry()
        .with(lines.with_filter(settings.env_filter()?))
        .with(LinkTrouble::default().with_filter(of_connecting))
        .try_init()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_that_is_none_is_named() {
        let settings = LogSettings { filter: "leader=loud".into(), ..LogSettings::default() };
        let error = start_logging(&settings).unwrap_err().to_string();
        assert!(error.contains("log.filter is \"leader=loud\""), "{error}");
    }
}
