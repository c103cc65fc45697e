//! The thesis's own measurements: Appendices B and C, the only data of its experiments that were published.
//!
//! X is the column and Y the row (Figure 4.6 has them the other way round); areas are on the doubled grid.

use serde::Deserialize;
use vision::predict::{Fix, NOMINAL_INTERVAL_S};
use vision::{PointPx, Timestamp};

use super::ExperimentError;

const APPENDIX_B: &str = include_str!("thesis/appendix_b.csv");
const APPENDIX_C: &str = include_str!("thesis/appendix_c.csv");

/// Area on the doubled grid for each frame pixel².
pub(super) const GRID_AREA: f32 = 4.0;

/// A block that the thesis followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Block {
    Red,
    Blue,
}

impl Block {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Red => "red",
            Self::Blue => "blue",
        }
    }

    pub(super) const fn appendix(self) -> &'static str {
        match self {
            Self::Red => "Appendix B",
            Self::Blue => "Appendix C",
        }
    }
}

/// A frame's measurement as printed.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub(super) struct Row {
    pub(super) frame: u32,
    pub(super) x_px: f32,
    pub(super) y_px: f32,
    pub(super) area_px2_2x: f32,
}

impl Row {
    /// As the predictors take it: at 30 frames a second, the area in frame pixels.
    pub(super) fn fix(&self) -> Fix {
        let nanos = f64::from(self.frame) * NOMINAL_INTERVAL_S * 1e9;
        Fix {
            captured_at: Timestamp::from_nanos(nanos.round() as i64),
            centroid: PointPx::new(self.x_px, self.y_px),
            area_px2: self.area_px2_2x / GRID_AREA,
        }
    }
}

/// The rows of a block's appendix without the first frame, in which nothing was found: it is printed as zeros.
pub(super) fn rows(block: Block) -> Result<Vec<Row>, ExperimentError> {
    let text = match block {
        Block::Red => APPENDIX_B,
        Block::Blue => APPENDIX_C,
    };
    let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
    let rows: Result<Vec<Row>, csv::Error> = rows.collect();
    let name = block.appendix();
    let rows = rows.map_err(|source| ExperimentError::Appendix { name, source })?;
    Ok(rows.into_iter().filter(|row| row.area_px2_2x > 0.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_tables_are_complete() {
        let (red, blue) = (rows(Block::Red).unwrap(), rows(Block::Blue).unwrap());
        assert_eq!((red.len(), blue.len()), (142, 146));
        let missing = (2..=147).filter(|frame| red.iter().all(|row| row.frame != *frame));
        assert_eq!(missing.collect::<Vec<u32>>(), [88, 99, 101, 103]);
        // MATLAB's bwarea counts eighths, printed with two places.
        let eighths = |row: &Row| ((row.area_px2_2x * 8.0).round() / 8.0 - row.area_px2_2x).abs() <= 0.0051;
        assert_eq!(red.iter().chain(&blue).filter(|row| !eighths(row)).count(), 1, "one is misprinted");
    }
}
