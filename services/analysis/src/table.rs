//! `register`'s result as text: CSV (RFC 4180) with a header, or one JSON object a line.

use std::io::Write;

use serde::Serialize;

/// How rows are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RowFormat {
    /// Comma-separated values with a header line.
    #[default]
    Csv,
    /// One JSON object a line.
    Ndjson,
}

/// Why a row could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteRowError {
    /// As CSV.
    #[error("cannot write the result")]
    Csv(#[source] csv::Error),
    /// As JSON, or the last of it.
    #[error("cannot write the result")]
    Write(#[from] std::io::Error),
}

impl From<csv::Error> for WriteRowError {
    /// An error of the system stays one: whoever reads the result may have seen enough.
    fn from(error: csv::Error) -> Self {
        if !error.is_io_error() {
            return Self::Csv(error);
        }
        match error.into_kind() {
            csv::ErrorKind::Io(error) => Self::Write(error),
            other => Self::Write(std::io::Error::other(format!("{other:?}"))),
        }
    }
}

/// Writes rows, and the header where the format has one even when no row comes.
#[derive(Debug)]
pub enum RowWriter<W: Write> {
    /// See [`RowFormat::Csv`].
    Csv(Box<csv::Writer<W>>),
    /// See [`RowFormat::Ndjson`].
    Ndjson(W),
}

/// The columns of `register`'s result; a test holds them against [`crate::row::Row`].
pub const COLUMNS: [&str; 20] = [
    "input",
    "frame",
    "captured_at_ns",
    "camera",
    "landmark",
    "instance",
    "result",
    "x_px",
    "y_px",
    "area_px2",
    "mask_area_2x",
    "shape_score",
    "score",
    "predicted_x_px",
    "predicted_y_px",
    "predicted_area_px2",
    "innovation_px",
    "gain",
    "bearing_rad",
    "range_m",
];

impl<W: Write> RowWriter<W> {
    /// A writer of that format onto `out`, for [`crate::row::Row`]s.
    ///
    /// # Errors
    /// When the header cannot be written.
    pub fn new(format: RowFormat, out: W) -> Result<Self, WriteRowError> {
        Self::with_columns(format, out, &COLUMNS)
    }

    /// A writer of that format onto `out`, for rows with those columns.
    ///
    /// # Errors
    /// When the header cannot be written.
    pub fn with_columns(format: RowFormat, out: W, columns: &[&str]) -> Result<Self, WriteRowError> {
        Ok(match format {
            RowFormat::Csv => {
                let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
                writer.write_record(columns)?;
                Self::Csv(Box::new(writer))
            }
            RowFormat::Ndjson => Self::Ndjson(out),
        })
    }

    /// Writes one row.
    ///
    /// # Errors
    /// When `out` refuses it.
    pub fn write(&mut self, row: &impl Serialize) -> Result<(), WriteRowError> {
        match self {
            Self::Csv(writer) => writer.serialize(row)?,
            Self::Ndjson(out) => {
                serde_json::to_writer(&mut *out, row).map_err(std::io::Error::from)?;
                out.write_all(b"\n")?;
            }
        }
        Ok(())
    }

    /// Writes what is still buffered.
    ///
    /// # Errors
    /// When `out` refuses it.
    pub fn finish(mut self) -> Result<(), WriteRowError> {
        match &mut self {
            Self::Csv(writer) => writer.flush()?,
            Self::Ndjson(out) => out.flush()?,
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::{FrameKey, rows};
    use vision::{Digest, LandmarkOutcome, Miss, Outcome, Place, PointPx, Sighting, Timestamp};

    fn landmark(id: &str, result: Result<Sighting, Miss>) -> LandmarkOutcome {
        LandmarkOutcome {
            landmark: id.to_owned(),
            digest: Digest::default(),
            instance: 0,
            prediction: None,
            gate: None,
            result,
            innovation_px: None,
            adaptation: None,
        }
    }

    fn outcome() -> Outcome {
        let seen = Sighting { centroid: PointPx::new(1.5, 2.25), area_px2: 9.0, ..Sighting::default() };
        Outcome {
            captured_at: Timestamp::from_nanos(33_333_333),
            landmarks: vec![landmark("red", Ok(seen)), landmark("blue", Err(Miss::TooSmall))],
            ..Outcome::default()
        }
    }

    fn written(format: RowFormat) -> String {
        let (outcome, mut out) = (outcome(), Vec::new());
        let mut writer = RowWriter::new(format, &mut out).unwrap();
        let key = FrameKey { input: "a, b", frame: Some(2), camera: None };
        let places = [Place { bearing_rad: Some(-0.5), range_m: Some(2.5) }];
        rows(key, &outcome, &places).for_each(|row| writer.write(&row).unwrap());
        writer.finish().unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn csv_has_a_header_quotes_and_leaves_unknowns_empty() {
        let text = written(RowFormat::Csv);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], COLUMNS.join(","));
        assert_eq!(lines[1], "\"a, b\",2,33333333,,red,0,measured,1.5,2.25,9.0,0.0,,0.0,,,,,,-0.5,2.5");
        assert_eq!(lines[2], "\"a, b\",2,33333333,,blue,0,too_small,,,,,,,,,,,,,");
    }

    #[test]
    fn ndjson_names_the_same_columns() {
        let text = written(RowFormat::Ndjson);
        let first: serde_json::Map<String, serde_json::Value> =
            serde_json::from_str(text.lines().next().unwrap()).unwrap();
        assert_eq!(first["x_px"], 1.5);
        assert!(first["shape_score"].is_null());
        let mut columns = COLUMNS.to_vec();
        columns.sort_unstable();
        assert_eq!(first.keys().collect::<Vec<_>>(), columns);
    }
}
