//! A recorded drive as one HTML page that needs nothing beside itself: tables and plots as in the reference thesis's
//! chapter of results, the detection of each landmark over time, the frames worth looking at, losses and gaps.

mod appendix;
mod plots;
mod section;
mod shots;
mod tables;
mod timeline;

use std::path::Path;

use recording::RecordingError;

use crate::chart::ChartError;
use crate::drive::Drive;
use crate::figures::Figures;
use crate::page::Page;

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A plot cannot be drawn.
    #[error(transparent)]
    Chart(#[from] ChartError),
}

/// A recording's report.
#[derive(Clone, Debug)]
pub struct Report {
    /// Its figures.
    pub figures: Figures,
    /// The page.
    pub html: String,
}

/// Reports on the recording `path`, which is read three times: for its figures, for what the recorder says of it, and
/// for the pictures of the frames that turned out to be worth showing.
///
/// # Errors
/// When it cannot be read.
pub fn report(path: &Path) -> Result<Report, ReportError> {
    let drive = Drive::read(path)?;
    let figures = Figures::of(path, &drive)?;
    let shots = shots::take(path, &drive)?;
    let mut page = Page::new(&section::title(path));
    section::head(&mut page, &figures);
    for camera in &figures.cameras {
        let Some(of_camera) = drive.cameras.get(camera.camera.as_str()) else { continue };
        section::camera(&mut page, camera, of_camera, &shots)?;
    }
    tables::losses(&mut page, &figures);
    Ok(Report { figures, html: page.finish() })
}

/// A page that lists the reports of many recordings, each with the name of its own page.
#[must_use]
pub fn index(reports: &[(String, Figures)]) -> String {
    let mut page = Page::new(&format!("{} recordings", reports.len()));
    tables::index(&mut page, reports);
    page.finish()
}
