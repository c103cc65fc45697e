//! Where an object really was: truth files, in the two forms that are common.
//!
//! One is CSV with a header, `frame,object,cx,cy,area,x0,y0,x1,y1,visible`, centres counted from the centre of the
//! first pixel, so half a pixel is added here. The other has a box `x,y,w,h` on every line, one a frame, as the OTB
//! and VOT tracking benchmarks have it; `0,0,0,0` where the object is not visible.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use vision::PointPx;
use waymark_proto::v1;

use crate::score::Claim;

/// One object's truth over the frames of an input, by frame number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Frames count from 1.
    pub frames: BTreeMap<u64, TrueObject>,
}

/// Where the object was in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrueObject {
    /// Its centre, corner origin.
    pub centre: PointPx,
    /// Its area where the truth knows it; boxes do not.
    pub area_px2: Option<f32>,
    /// Part of it that is visible, 0..1.
    pub visible: f32,
    /// How far a measured centre may be off and still count.
    pub tolerance_px: f32,
}

/// Centres within this distance count for any object.
const LEAST_TOLERANCE_PX: f32 = 3.0;

/// Why a truth file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TruthError {
    /// It cannot be read.
    #[error("cannot read the truth file `{}`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A line is neither form.
    #[error(
        "`{}`, line {line}: `{text}` is neither a box x,y,w,h nor a row of frame,object,cx,cy,area,x0,y0,x1,y1,visible",
        path.display()
    )]
    Line {
        /// The file.
        path: PathBuf,
        /// Counts from 1.
        line: usize,
        /// What it says.
        text: String,
    },
    /// The object is not in it.
    #[error("`{}` knows no object `{object}`; it knows {}", path.display(), known.join(", "))]
    UnknownObject {
        /// The file.
        path: PathBuf,
        /// What was asked for.
        object: String,
        /// What is there.
        known: Vec<String>,
    },
}

#[derive(Deserialize)]
struct TruthRow {
    frame: u64,
    object: String,
    cx: f32,
    cy: f32,
    area: f32,
    visible: f32,
}

impl Truth {
    /// Reads `object`'s truth; a file of boxes knows one object, whatever its name.
    ///
    /// # Errors
    /// When the file cannot be read, is of neither form, or does not know the object.
    pub fn read(path: &Path, object: &str) -> Result<Self, TruthError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| TruthError::Read { path: path.to_owned(), source })?;
        if text.starts_with("frame,") { from_csv(path, &text, object) } else { from_boxes(path, &text) }
    }
}

fn bad_line(path: &Path, text: &str, index: usize) -> TruthError {
    let said = text.lines().nth(index).unwrap_or_default().to_owned();
    TruthError::Line { path: path.to_owned(), line: index + 1, text: said }
}

fn from_csv(path: &Path, text: &str, object: &str) -> Result<Truth, TruthError> {
    let mut truth = Truth::default();
    let mut known: Vec<String> = Vec::new();
    let mut last = 0;
    for (index, row) in csv::Reader::from_reader(text.as_bytes()).into_deserialize().enumerate() {
        let row: TruthRow = row.map_err(|_| bad_line(path, text, index + 1))?;
        last = last.max(row.frame);
        if row.object == object {
            truth.frames.insert(row.frame, true_object(&row));
        } else if !known.contains(&row.object) {
            known.push(row.object);
        }
    }
    if truth.frames.is_empty() {
        return Err(TruthError::UnknownObject { path: path.to_owned(), object: object.to_owned(), known });
    }
    // A frame that has no row for the object shows it nowhere.
    for frame in 1..=last {
        truth.frames.entry(frame).or_default();
    }
    Ok(truth)
}

fn true_object(row: &TruthRow) -> TrueObject {
    TrueObject {
        centre: PointPx::new(row.cx + 0.5, row.cy + 0.5),
        area_px2: Some(row.area),
        visible: row.visible,
        tolerance_px: LEAST_TOLERANCE_PX.max(0.5 * row.area.sqrt()),
    }
}

fn from_boxes(path: &Path, text: &str) -> Result<Truth, TruthError> {
    let mut truth = Truth::default();
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let numbers = line.split([',', '\t']).map(|number| number.trim().parse::<f32>());
        let numbers: Vec<f32> =
            numbers.take(4).collect::<Result<_, _>>().map_err(|_| bad_line(path, text, index))?;
        let &[x, y, width, height] = numbers.as_slice() else { return Err(bad_line(path, text, index)) };
        let frame = truth.frames.len() as u64 + 1;
        truth.frames.insert(frame, true_box(x, y, width, height));
    }
    Ok(truth)
}

fn true_box(x: f32, y: f32, width: f32, height: f32) -> TrueObject {
    TrueObject {
        centre: PointPx::new(x + width / 2.0, y + height / 2.0),
        area_px2: None,
        visible: if width > 0.0 && height > 0.0 { 1.0 } else { 0.0 },
        tolerance_px: LEAST_TOLERANCE_PX.max(0.25 * width.hypot(height)),
    }
}

/// The object of a simulated frame that a landmark stands for. One landmark may stand for many alike (`sign-1`, `sign-2`
/// …): then for the one nearest to its best claim. Absent when the picture does not show it.
#[must_use]
pub fn meant_object(truth: &v1::Truth, landmark: &str, claims: &[Claim]) -> TrueObject {
    let best = claims.iter().max_by(|a, b| a.score.total_cmp(&b.score)).map(|claim| claim.centre);
    let is_meant = |object: &&v1::TrueObject| match object.object.strip_prefix(landmark) {
        Some(rest) => rest.is_empty() || rest.starts_with('-'),
        None => false,
    };
    let distance_px = |object: &v1::TrueObject| {
        best.map_or(-object.area_px2 as f32, |best| best.distance_px(centre_of(object)))
    };
    let meant = truth.objects.iter().filter(is_meant);
    let object = meant.min_by(|a, b| distance_px(a).total_cmp(&distance_px(b)));
    object.map_or_else(TrueObject::default, |object| TrueObject {
        centre: centre_of(object),
        area_px2: Some(object.area_px2 as f32),
        visible: object.visible as f32,
        tolerance_px: LEAST_TOLERANCE_PX.max(0.5 * (object.area_px2 as f32).sqrt()),
    })
}

fn centre_of(object: &v1::TrueObject) -> PointPx {
    PointPx::new(object.x_px as f32, object.y_px as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        file
    }

    const HEADER: &str = "frame,object,cx,cy,area,x0,y0,x1,y1,visible";

    #[test]
    fn csv_counts_from_pixel_centres_and_fills_gaps() {
        let file = file(&format!("{HEADER}\n1,red,10,20,100,5,15,15,25,1\n3,blue,0,0,9,0,0,3,3,0.25\n"));
        let truth = Truth::read(file.path(), "red").unwrap();
        assert_eq!(truth.frames.len(), 3);
        assert_eq!(truth.frames[&1].centre, PointPx::new(10.5, 20.5));
        assert_eq!(truth.frames[&1].tolerance_px, 5.0);
        assert_eq!(truth.frames[&2].visible, 0.0);
    }

    #[test]
    fn boxes_are_one_a_line() {
        let file = file("10,20,8,6\n\n0\t0\t0\t0\n");
        let truth = Truth::read(file.path(), "whatever").unwrap();
        assert_eq!(truth.frames[&1].centre, PointPx::new(14.0, 23.0));
        assert_eq!((truth.frames[&1].visible, truth.frames[&2].visible), (1.0, 0.0));
        assert_eq!(truth.frames[&1].area_px2, None);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let error = Truth::read(file("1,2,3\n").path(), "red").unwrap_err();
        assert!(matches!(error, TruthError::Line { line: 1, .. }), "{error}");
        let error =
            Truth::read(file(&format!("{HEADER}\n1,red,x,2,3,4,5,6,7,8\n")).path(), "red").unwrap_err();
        assert!(error.to_string().contains("line 2: `1,red,x"), "{error}");
        let file = file(&format!("{HEADER}\n1,red,10,20,100,5,15,15,25,1\n"));
        let error = Truth::read(file.path(), "green").unwrap_err();
        assert!(error.to_string().ends_with("knows no object `green`; it knows red"), "{error}");
    }
}
