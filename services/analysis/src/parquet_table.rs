//! Tables as Parquet, for DuckDB, DataFusion, Spark and their like: every column may be null, compressed with Zstandard.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, ZstdLevel};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

/// Rows of a row group: a few megabytes in memory.
const GROUP_ROWS: usize = 65_536;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// UTF-8 text.
    Text,
    /// A signed 64-bit integer.
    Int,
    /// A 32-bit floating-point number.
    Float,
    /// A 64-bit floating-point number.
    Double,
}

/// One value of a row; `None` is null.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// Of a [`Kind::Text`].
    Text(Option<&'a str>),
    /// Of a [`Kind::Int`].
    Int(Option<i64>),
    /// Of a [`Kind::Float`].
    Float(Option<f32>),
    /// Of a [`Kind::Double`].
    Double(Option<f64>),
}

/// A column's name and what it holds.
pub type Column = (&'static str, Kind);

/// Writes a table row by row.
pub struct ParquetWriter<W: Write + Send> {
    file: SerializedFileWriter<W>,
    columns: Vec<Values>,
    rows: usize,
}

/// The values of one column of the open row group, nulls left out, and for each row whether it has one.
struct Values {
    present: Vec<i16>,
    cells: Cells,
}

enum Cells {
    Text(Vec<ByteArray>),
    Int(Vec<i64>),
    Float(Vec<f32>),
    Double(Vec<f64>),
}

impl<W: Write + Send> ParquetWriter<W> {
    /// Begins a table with those columns.
    ///
    /// # Errors
    /// When `out` refuses it.
    pub fn new(out: W, name: &str, columns: &[Column]) -> Result<Self, ParquetError> {
        let fields: Vec<String> = columns.iter().map(|(name, kind)| kind.field(name)).collect();
        let schema = Arc::new(parse_message_type(&format!("message {name} {{ {} }}", fields.join(" ")))?);
        let compression = Compression::ZSTD(ZstdLevel::try_new(3)?);
        let properties = Arc::new(WriterProperties::builder().set_compression(compression).build());
        let file = SerializedFileWriter::new(out, schema, properties)?;
        Ok(Self { file, columns: columns.iter().map(|(_, kind)| Values::new(*kind)).collect(), rows: 0 })
    }

    /// Adds a row, a cell for each column in order.
    ///
    /// # Errors
    /// When a cell is not what its column holds, or `out` refuses a full row group.
    pub fn write(&mut self, row: &[Cell<'_>]) -> Result<(), ParquetError> {
        for (column, cell) in self.columns.iter_mut().zip(row) {
            column.push(*cell)?;
        }
        self.rows += 1;
        if self.rows == GROUP_ROWS { self.close_group() } else { Ok(()) }
    }

    /// Writes what is left and the footer.
    ///
    /// # Errors
    /// When `out` refuses it.
    pub fn finish(mut self) -> Result<(), ParquetError> {
        if self.rows > 0 {
            self.close_group()?;
        }
        self.file.close().map(drop)
    }

    fn close_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        for values in &mut self.columns {
            let Some(mut column) = group.next_column()? else { break };
            values.write(column.untyped())?;
            column.close()?;
        }
        self.rows = 0;
        group.close().map(drop)
    }
}

impl Kind {
    fn field(self, name: &str) -> String {
        match self {
            Self::Text => format!("optional binary {name} (UTF8);"),
            Self::Int => format!("optional int64 {name};"),
            Self::Float => format!("optional float {name};"),
            Self::Double => format!("optional double {name};"),
        }
    }
}

impl Values {
    fn new(kind: Kind) -> Self {
        let cells = match kind {
            Kind::Text => Cells::Text(Vec::new()),
            Kind::Int => Cells::Int(Vec::new()),
            Kind::Float => Cells::Float(Vec::new()),
            Kind::Double => Cells::Double(Vec::new()),
        };
        Self { present: Vec::new(), cells }
    }

    fn push(&mut self, cell: Cell<'_>) -> Result<(), ParquetError> {
        let present = match (&mut self.cells, cell) {
            (Cells::Text(cells), Cell::Text(cell)) => extend(cells, cell.map(ByteArray::from)),
            (Cells::Int(cells), Cell::Int(cell)) => extend(cells, cell),
            (Cells::Float(cells), Cell::Float(cell)) => extend(cells, cell),
            (Cells::Double(cells), Cell::Double(cell)) => extend(cells, cell),
            (_, cell) => return Err(ParquetError::General(format!("{cell:?} is not what its column holds"))),
        };
        self.present.push(present);
        Ok(())
    }

    fn write(&mut self, column: &mut ColumnWriter<'_>) -> Result<(), ParquetError> {
        use parquet::column::writer::get_typed_column_writer_mut as typed;
        let present = std::mem::take(&mut self.present);
        let levels = Some(present.as_slice());
        match &mut self.cells {
            Cells::Text(cells) => {
                typed::<ByteArrayType>(column).write_batch(&std::mem::take(cells), levels, None)
            }
            Cells::Int(cells) => typed::<Int64Type>(column).write_batch(&std::mem::take(cells), levels, None),
            Cells::Float(cells) => {
                typed::<FloatType>(column).write_batch(&std::mem::take(cells), levels, None)
            }
            Cells::Double(cells) => {
                typed::<DoubleType>(column).write_batch(&std::mem::take(cells), levels, None)
            }
        }
        .map(drop)
    }
}

/// Adds a value if there is one; returns its definition level.
fn extend<T>(cells: &mut Vec<T>, cell: Option<T>) -> i16 {
    let present = i16::from(cell.is_some());
    cells.extend(cell);
    present
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_begins_and_ends_as_parquet_does() {
        let mut out = Vec::new();
        let columns = [("name", Kind::Text), ("count", Kind::Int), ("x", Kind::Float), ("y", Kind::Double)];
        let mut writer = ParquetWriter::new(&mut out, "test", &columns).unwrap();
        for row in 0..70_000 {
            let known = (row % 3 == 0).then_some(row);
            writer
                .write(&[
                    Cell::Text(known.map(|_| "red")),
                    Cell::Int(known),
                    Cell::Float(known.map(|row| row as f32)),
                    Cell::Double(None),
                ])
                .unwrap();
        }
        writer.finish().unwrap();
        assert_eq!((&out[..4], &out[out.len() - 4..]), (&b"PAR1"[..], &b"PAR1"[..]));
    }

    #[test]
    fn a_cell_of_another_kind_is_refused() {
        let mut writer = ParquetWriter::new(Vec::new(), "test", &[("count", Kind::Int)]).unwrap();
        assert!(writer.write(&[Cell::Text(Some("one"))]).is_err());
    }
}
