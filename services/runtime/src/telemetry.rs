//! Logs on standard error and metrics for `/metrics`.

use std::time::Duration;

use metrics_exporter_prometheus::{BuildError, Matcher, PrometheusBuilder, PrometheusHandle};
use serde::{Deserialize, Serialize};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::filter::ParseError;
use tracing_subscriber::util::{SubscriberInitExt, TryInitError};

use crate::shutdown::Shutdown;

/// Upper bounds of histogram buckets for durations, in seconds: a registration stage to a slow disk.
const DURATION_BUCKETS_S: [f64; 14] =
    [1e-4, 2.5e-4, 5e-4, 1e-3, 2.5e-3, 5e-3, 1e-2, 2.5e-2, 5e-2, 0.1, 0.25, 0.5, 1.0, 5.0];

/// How often recorded samples are folded into their buckets when nobody scrapes.
const UPKEEP_PERIOD: Duration = Duration::from_secs(5);

/// What a line of log looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LogFormat {
    /// For people.
    #[default]
    Text,
    /// One JSON object a line.
    Json,
}

/// The `log` part of a configuration.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
    /// Something else took the process's metrics already.
    #[error("metrics cannot be recorded: {0}")]
    Metrics(#[from] BuildError),
}

/// Starts logging on standard error, for the whole process.
///
/// # Errors
/// When the filter is none, or the process logs already.
pub fn start_logging(settings: &LogSettings) -> Result<(), TelemetryError> {
    let filter = EnvFilter::try_new(&settings.filter)
        .map_err(|source| TelemetryError::Filter { filter: settings.filter.clone(), source })?;
    let lines = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    match settings.format {
        LogFormat::Text => lines.finish().try_init()?,
        LogFormat::Json => lines.json().finish().try_init()?,
    }
    Ok(())
}

/// The metrics of this process.
#[derive(Clone)]
pub struct Metrics {
    prometheus: PrometheusHandle,
}

impl Metrics {
    /// Records metrics for the whole process from now on. Names ending in `_seconds` become histograms.
    ///
    /// # Errors
    /// When the process records them already.
    pub fn install() -> Result<Self, TelemetryError> {
        let seconds = Matcher::Suffix("_seconds".to_owned());
        let builder = PrometheusBuilder::new().set_buckets_for_metric(seconds, &DURATION_BUCKETS_S)?;
        Ok(Self { prometheus: builder.install_recorder()? })
    }

    /// All metrics in the Prometheus text format.
    #[must_use]
    pub fn render(&self) -> String {
        self.prometheus.render()
    }

    /// Keeps samples from piling up when nobody scrapes, until shutdown.
    pub async fn keep_up(&self, shutdown: &Shutdown) {
        let mut period = tokio::time::interval(UPKEEP_PERIOD);
        loop {
            tokio::select! {
                () = shutdown.requested() => return,
                _ = period.tick() => self.prometheus.run_upkeep(),
            }
        }
    }
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

    #[test]
    fn durations_become_histograms() {
        let metrics = Metrics::install().unwrap();
        metrics::histogram!("waymark_test_seconds").record(0.002);
        metrics::counter!("waymark_test_total").increment(3);
        let text = metrics.render();
        assert!(text.contains("waymark_test_seconds_bucket{le=\"0.0025\"} 1"), "{text}");
        assert!(text.contains("waymark_test_total 3"), "{text}");
    }
}
