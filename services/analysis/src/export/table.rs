//! A table in any of the formats.

use std::io::Write;

use super::ExportError;
use super::truth_row::{TRUTH_COLUMNS, TruthRow};
use crate::parquet_table::{Cell, Column, Kind, ParquetWriter};
use crate::row::Row;
use crate::table::{COLUMNS, RowFormat, RowWriter};

/// What a table is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TableKind {
    /// What was registered: the columns of `register`.
    #[default]
    Registrations,
    /// What a simulator really showed.
    Truth,
}

/// How a table is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// As text.
    Text(RowFormat),
    /// As Parquet.
    Parquet,
}

/// Writes one table.
pub struct TableWriter<W: Write + Send> {
    kind: TableKind,
    sink: Sink<W>,
}

enum Sink<W: Write + Send> {
    Text(RowWriter<W>),
    Parquet(Box<ParquetWriter<W>>),
}

impl<W: Write + Send> TableWriter<W> {
    /// Begins a table onto `out`.
    ///
    /// # Errors
    /// When `out` refuses it.
    pub fn new(kind: TableKind, format: TableFormat, out: W) -> Result<Self, ExportError> {
        let sink = match format {
            TableFormat::Text(format) => Sink::Text(RowWriter::with_columns(format, out, kind.columns())?),
            TableFormat::Parquet => {
                Sink::Parquet(Box::new(ParquetWriter::new(out, kind.name(), &kind.parquet_columns())?))
            }
        };
        Ok(Self { kind, sink })
    }

    /// What the table is of.
    #[must_use]
    pub fn kind(&self) -> TableKind {
        self.kind
    }

    /// Finishes it.
    ///
    /// # Errors
    /// When `out` refuses the rest.
    pub fn finish(self) -> Result<(), ExportError> {
        match self.sink {
            Sink::Text(writer) => Ok(writer.finish()?),
            Sink::Parquet(writer) => Ok(writer.finish()?),
        }
    }

    pub(super) fn registration(&mut self, row: &Row<'_>) -> Result<(), ExportError> {
        match &mut self.sink {
            Sink::Text(writer) => Ok(writer.write(row)?),
            Sink::Parquet(writer) => Ok(writer.write(&registration_cells(row))?),
        }
    }

    pub(super) fn truth(&mut self, row: &TruthRow<'_>) -> Result<(), ExportError> {
        match &mut self.sink {
            Sink::Text(writer) => Ok(writer.write(row)?),
            Sink::Parquet(writer) => Ok(writer.write(&truth_cells(row))?),
        }
    }
}

impl TableKind {
    const fn name(self) -> &'static str {
        match self {
            Self::Registrations => "registrations",
            Self::Truth => "truth",
        }
    }

    const fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Registrations => &COLUMNS,
            Self::Truth => &TRUTH_COLUMNS,
        }
    }

    fn parquet_columns(self) -> Vec<Column> {
        let kind = |name: &str| match (self, name) {
            (_, "input" | "camera" | "landmark" | "object" | "result") => Kind::Text,
            (_, "frame" | "captured_at_ns" | "instance") => Kind::Int,
            (Self::Registrations, _) => Kind::Float,
            (Self::Truth, _) => Kind::Double,
        };
        self.columns().iter().map(|&name| (name, kind(name))).collect()
    }
}

fn registration_cells<'a>(row: &Row<'a>) -> [Cell<'a>; 20] {
    [
        Cell::Text(Some(row.input)),
        Cell::Int(row.frame.map(|frame| frame as i64)),
        Cell::Int(Some(row.captured_at_ns)),
        Cell::Text(row.camera),
        Cell::Text(Some(row.landmark)),
        Cell::Int(Some(row.instance.into())),
        Cell::Text(Some(row.result)),
        Cell::Float(row.x_px),
        Cell::Float(row.y_px),
        Cell::Float(row.area_px2),
        Cell::Float(row.mask_area_2x),
        Cell::Float(row.shape_score),
        Cell::Float(row.score),
        Cell::Float(row.predicted_x_px),
        Cell::Float(row.predicted_y_px),
        Cell::Float(row.predicted_area_px2),
        Cell::Float(row.innovation_px),
        Cell::Float(row.gain),
        Cell::Float(row.bearing_rad),
        Cell::Float(row.range_m),
    ]
}

fn truth_cells<'a>(row: &TruthRow<'a>) -> [Cell<'a>; 9] {
    [
        Cell::Text(Some(row.input)),
        Cell::Int(row.frame.map(|frame| frame as i64)),
        Cell::Int(Some(row.captured_at_ns)),
        Cell::Text(row.camera),
        Cell::Text(Some(row.object)),
        Cell::Double(Some(row.x_px)),
        Cell::Double(Some(row.y_px)),
        Cell::Double(Some(row.area_px2)),
        Cell::Double(Some(row.visible)),
    ]
}
