//! The parts of the page in their order.

use std::path::Path;

use super::plots::{Course, over_frames, path};
use super::shots::Shots;
use super::{ReportError, appendix, tables, timeline};
use crate::drive::CameraDrive;
use crate::figures::{CameraFigures, Figures, LandmarkFigures, Observation, observations};
use crate::page::{Page, or_dash};

pub(super) fn title(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// What the recording is.
pub(super) fn head(page: &mut Page, figures: &Figures) {
    let size_mib = figures.bytes as f64 / f64::from(1 << 20);
    let span = or_dash(figures.span_s.map(|span| format!("{span:.1} s")));
    page.paragraph(&format!("{}: {span}, {size_mib:.1} MiB", figures.recording));
    if figures.cameras.is_empty() {
        page.paragraph("It holds no pictures and no results.");
    }
}

/// One camera and its landmarks.
pub(super) fn camera(
    page: &mut Page,
    figures: &CameraFigures,
    drive: &CameraDrive,
    shots: &Shots,
) -> Result<(), ReportError> {
    page.heading(2, &format!("Camera {}", figures.camera));
    let gap = or_dash(figures.longest_gap_s.map(|gap| format!("{gap:.3} s")));
    page.paragraph(&format!(
        "{} pictures, {} registered, {} not; longest time between two results {gap}.",
        figures.pictures, figures.registered, figures.not_registered
    ));
    tables::landmarks(page, figures);
    tables::scores(page, figures);
    let ids: Vec<&str> = figures.landmarks.iter().map(|landmark| landmark.id.as_str()).collect();
    timeline::write(page, drive, &ids);
    shots.write(page, &figures.camera);
    for figures in &figures.landmarks {
        landmark(page, figures, drive)?;
    }
    Ok(())
}

fn landmark(page: &mut Page, figures: &LandmarkFigures, drive: &CameraDrive) -> Result<(), ReportError> {
    page.heading(3, &format!("Landmark {}", figures.id));
    tables::prediction_error(page, figures);
    let seen: Vec<Observation<'_>> = observations(drive, &figures.id).collect();
    page.raw("<div class=\"grid plots\">");
    let centres: Vec<(f64, f64)> = measured(&seen, |seen| (seen.centroid.x, seen.centroid.y))
        .map(|(_, (x, y))| (f64::from(x), f64::from(y)))
        .collect();
    let size = seen.first().map(|seen| seen.outcome.frame_size).unwrap_or_default();
    page.drawing(&path("Centre in the picture; ring: first sighting", size, centres).svg()?, "");
    for series in series(&seen) {
        page.drawing(&over_frames(series).svg()?, "");
    }
    page.raw("</div>");
    appendix::write(page, drive, &figures.id);
    Ok(())
}

/// X, Y and Z over the frames, as Figures 4.8 and 4.9.
fn series(seen: &[Observation<'_>]) -> [Course; 3] {
    let values =
        |title: &str, of: fn(&vision::Sighting) -> f32, prior: fn(&vision::Prediction) -> f32| Course {
            title: title.to_owned(),
            measured: measured(seen, of).map(|(frame, value)| (frame, f64::from(value))).collect(),
            predicted: seen
                .iter()
                .filter_map(|seen| Some((number(seen), f64::from(prior(seen.best.prediction.as_ref()?)))))
                .collect(),
        };
    [
        values("X, px", |seen| seen.centroid.x, |prior| prior.centroid.x),
        values("Y, px", |seen| seen.centroid.y, |prior| prior.centroid.y),
        values("Z: area, px²", |seen| seen.area_px2, |prior| prior.area_px2),
    ]
}

fn measured<'a, T>(
    seen: &'a [Observation<'_>],
    of: impl Fn(&vision::Sighting) -> T + 'a,
) -> impl Iterator<Item = (f64, T)> + 'a {
    seen.iter().filter_map(move |seen| Some((number(seen), of(seen.best.result.as_ref().ok()?))))
}

/// The frame's number; in its stream, where its picture is not in the recording.
fn number(seen: &Observation<'_>) -> f64 {
    seen.frame.number.unwrap_or(seen.outcome.sequence) as f64
}
