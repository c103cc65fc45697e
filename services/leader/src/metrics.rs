//! `/metrics`: counted where things happen, put together when somebody asks, in a recorder of its own for each scrape: two
//! services in one process never mix their figures.

use http_face::Counters;
use metrics::{counter, describe_counter, gauge};
use metrics_exporter_prometheus::PrometheusBuilder;

use crate::status::LeaderStatus;

/// What each figure is.
const HELP: [(&str, &str); 10] = [
    ("waymark_uptime_seconds", "Time since the start."),
    ("waymark_landmarks", "Landmarks in force."),
    ("waymark_landmark_set_epoch", "Starts of this leader."),
    ("waymark_landmark_set_version", "Changes of the set within the epoch."),
    ("waymark_router_connected", "1 when at least one router is connected."),
    ("waymark_landmark_edits_total", "Changes asked for, by what came of them."),
    ("waymark_puts_total", "Puts of its own."),
    ("waymark_put_seconds_median", "Median time that a put takes."),
    ("waymark_put_seconds_longest", "Longest time that a put took."),
    ("waymark_http_refused_total", "Requests and connections turned away or cut off, by reason."),
];

/// Everything in the Prometheus text format.
pub(crate) fn exposition(status: &LeaderStatus, refusals: &Counters) -> String {
    let recorder = PrometheusBuilder::new().build_recorder();
    metrics::with_local_recorder(&recorder, || {
        for (name, help) in HELP {
            describe_counter!(name, help);
        }
        gauge!("waymark_uptime_seconds").set(status.uptime_s);
        gauge!("waymark_landmarks").set(status.landmarks as f64);
        gauge!("waymark_landmark_set_epoch").set(status.set.epoch as f64);
        gauge!("waymark_landmark_set_version").set(status.set.version as f64);
        gauge!("waymark_router_connected").set(f64::from(u8::from(status.router.connected)));
        counter!("waymark_landmark_edits_total", "result" => "made").absolute(status.edits.made);
        counter!("waymark_landmark_edits_total", "result" => "refused").absolute(status.edits.refused);
        counter!("waymark_puts_total").absolute(status.puts.count);
        gauge!("waymark_put_seconds_median").set(status.puts.median_ms * 1e-3);
        gauge!("waymark_put_seconds_longest").set(status.puts.longest_ms * 1e-3);
        for (reason, count) in refusals.by_reason() {
            counter!("waymark_http_refused_total", "reason" => reason).absolute(count);
        }
    });
    recorder.handle().render()
}
