//! Tables of figures.

use crate::figures::{CameraFigures, Figures, LandmarkFigures, Spread};
use crate::page::{Page, escaped, or_dash, percent, rounded};

/// How often each landmark was seen, and how well.
pub(super) fn landmarks(page: &mut Page, camera: &CameraFigures) {
    let rows = camera.landmarks.iter().map(|landmark| {
        let misses: Vec<String> = landmark
            .misses
            .iter()
            .map(|(name, count)| format!("{count} {}", name.replace('_', " ")))
            .collect();
        vec![
            landmark.id.clone(),
            landmark.frames.to_string(),
            percent(landmark.measured_rate),
            or_dash(landmark.innovation_median_px.map(rounded)),
            or_dash(landmark.innovation_p95_px.map(rounded)),
            misses.join(", "),
        ]
    });
    page.table(
        "Looked for in each registered frame; the best-scored instance stands for the frame.",
        &["landmark", "frames", "measured", "innovation median, px", "95 %, px", "missed"],
        rows,
    );
}

/// Against what the simulator really showed, if it says it.
pub(super) fn scores(page: &mut Page, camera: &CameraFigures) {
    let scored = camera.landmarks.iter().filter_map(|landmark| Some((landmark, landmark.score.as_ref()?)));
    let rows: Vec<Vec<String>> = scored
        .map(|(landmark, score)| {
            vec![
                landmark.id.clone(),
                score.frames.to_string(),
                percent(score.detection_rate),
                percent(score.false_rate),
                percent(score.miss_rate),
                or_dash(score.centre_mean_px.map(rounded)),
                or_dash(score.centre_median_px.map(rounded)),
                or_dash(score.centre_p95_px.map(rounded)),
                percent(score.area_abs_median_relative),
                format!("{} / {}", score.false_when_absent, score.absent_frames),
            ]
        })
        .collect();
    if rows.is_empty() {
        return;
    }
    page.heading(4, "Against the simulator's truth");
    page.table(
        "Frames in which at least half of the object is visible; absent: less than a twentieth.",
        &[
            "landmark",
            "frames",
            "detected",
            "false",
            "missed",
            "centre mean, px",
            "median",
            "95 %",
            "area, median",
            "false when absent",
        ],
        rows,
    );
}

/// The table of the thesis's Tables 4.4 and 4.5 for one landmark.
pub(super) fn prediction_error(page: &mut Page, landmark: &LandmarkFigures) {
    let row = |name: &str, spread: &Option<Spread>| {
        let figure = |of: fn(&Spread) -> f64| or_dash(spread.as_ref().map(|spread| rounded(of(spread))));
        vec![
            name.to_owned(),
            figure(|spread| spread.mean),
            figure(|spread| spread.variance),
            figure(|spread| spread.standard_deviation),
            figure(|spread| spread.largest),
        ]
    };
    page.table(
        "Motion prediction error, measured minus predicted (thesis Tables 4.4 and 4.5): X and Y in px, Z, the area, in px².",
        &["", "expected value", "variance", "standard deviation", "largest"],
        [
            row("X", &landmark.prediction_error_x_px),
            row("Y", &landmark.prediction_error_y_px),
            row("Z", &landmark.prediction_error_area_px2),
        ],
    );
}

/// What was lost on the way into the recording, and in it.
pub(super) fn losses(page: &mut Page, figures: &Figures) {
    page.heading(2, "Losses and gaps");
    if !figures.damage.is_empty() {
        page.paragraph(&format!("{} parts of the file are damaged.", figures.damage.len()));
        page.table("", &["damage"], figures.damage.iter().take(50).map(|damage| vec![damage.clone()]));
    }
    let rows = figures.topics.iter().map(|topic| {
        vec![
            topic.topic.clone(),
            topic.messages.to_string(),
            or_dash(topic.rate_hz.map(|rate| format!("{rate:.1}"))),
            or_dash(topic.longest_gap_s.map(|gap| format!("{gap:.3}"))),
            topic.skipped.to_string(),
            or_dash(topic.lost),
        ]
    });
    page.table(
        "Skipped: numbers that never reached the recorder. Lost: messages that it could not keep.",
        &["topic", "messages", "Hz", "longest gap, s", "skipped", "lost"],
        rows,
    );
}

/// All landmarks of all recordings.
pub(super) fn index(page: &mut Page, reports: &[(String, Figures)]) {
    let links: String = reports
        .iter()
        .map(|(file, figures)| {
            let (file, name) = (escaped(file), escaped(&figures.recording));
            format!("<li><a href=\"{file}\">{name}</a></li>")
        })
        .collect();
    page.raw(&format!("<ul>{links}</ul>"));
    let rows = reports.iter().flat_map(|(_, figures)| {
        figures.cameras.iter().flat_map(move |camera| {
            camera.landmarks.iter().map(move |landmark| {
                let score = landmark.score.as_ref();
                vec![
                    figures.recording.clone(),
                    camera.camera.clone(),
                    landmark.id.clone(),
                    landmark.frames.to_string(),
                    percent(landmark.measured_rate),
                    or_dash(landmark.innovation_median_px.map(rounded)),
                    percent(score.and_then(|score| score.detection_rate)),
                    or_dash(score.and_then(|score| score.centre_median_px).map(rounded)),
                ]
            })
        })
    });
    page.table(
        "",
        &[
            "recording",
            "camera",
            "landmark",
            "frames",
            "measured",
            "innovation median, px",
            "detected",
            "centre median, px",
        ],
        rows,
    );
}
