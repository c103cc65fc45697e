//! What a recording holds, as tables and pictures for other programs.

mod pictures;
mod table;
mod truth_row;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ingest::recorded::{RecordedItem, RecordedItems};
use parquet::errors::ParquetError;
use recording::RecordingError;
use vision::Timestamp;

use crate::row::{FrameKey, rows};
use crate::table::WriteRowError;

pub use pictures::{ExportPictureError, Pictures, export_pictures};
pub use table::{TableFormat, TableKind, TableWriter};
pub use truth_row::{TruthRow, truth_rows};

/// What became of an export.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exported {
    /// Rows, or pictures.
    pub written: u64,
    /// Parts of the recording that could not be used.
    pub damaged: u64,
}

/// Why a table could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The table cannot be written as text.
    #[error(transparent)]
    Row(#[from] WriteRowError),
    /// The table cannot be written as Parquet.
    #[error("cannot write the Parquet table")]
    Parquet(#[from] ParquetError),
}

/// Writes the rows of one recording, `given` being what its `input` column says.
///
/// # Errors
/// When the recording cannot be read or the table not be written; damaged parts are counted.
pub fn export_table<W: std::io::Write + Send>(
    file: &Path,
    given: &str,
    table: &mut TableWriter<W>,
) -> Result<Exported, ExportError> {
    let (mut numbers, mut done) = (FrameNumbers::default(), Exported::default());
    for item in RecordedItems::open(file)? {
        match item? {
            RecordedItem::Picture { camera, picture: Ok(picture), .. } => {
                numbers.count(&camera, Some((picture.captured_at, picture.sequence)));
            }
            RecordedItem::Picture { camera, picture: Err(_), .. } => {
                done.damaged += 1;
                numbers.count(&camera, None);
            }
            RecordedItem::Registration { camera, outcome, places }
                if table.kind() == TableKind::Registrations =>
            {
                let frame = numbers.of(&camera, outcome.captured_at, outcome.sequence);
                let key = FrameKey { input: given, frame, camera: Some(&camera) };
                for row in rows(key, &outcome, &places) {
                    table.registration(&row)?;
                    done.written += 1;
                }
            }
            RecordedItem::Truth { camera, truth } if table.kind() == TableKind::Truth => {
                let captured_at = Timestamp::from_nanos(truth.captured_at_ns);
                let frame = numbers.of(&camera, captured_at, truth.sequence);
                for row in truth_rows(FrameKey { input: given, frame, camera: Some(&camera) }, &truth) {
                    table.truth(&row)?;
                    done.written += 1;
                }
            }
            RecordedItem::Damage(_) => done.damaged += 1,
            _ => {}
        }
    }
    Ok(done)
}

/// Which picture of its camera a frame is.
#[derive(Debug, Default)]
struct FrameNumbers {
    cameras: BTreeMap<Arc<str>, Numbers>,
}

/// How many pictures a camera has so far, and the number of each by its stamp.
#[derive(Debug, Default)]
struct Numbers {
    count: u64,
    by_stamp: BTreeMap<(Timestamp, u32), u64>,
}

impl FrameNumbers {
    /// Counts a picture; one that cannot be used has no stamp.
    fn count(&mut self, camera: &Arc<str>, stamp: Option<(Timestamp, u64)>) {
        let numbers = self.cameras.entry(Arc::clone(camera)).or_default();
        numbers.count += 1;
        if let Some((captured_at, sequence)) = stamp {
            numbers.by_stamp.insert((captured_at, sequence as u32), numbers.count);
        }
    }

    fn of(&self, camera: &str, captured_at: Timestamp, sequence: u64) -> Option<u64> {
        self.cameras.get(camera)?.by_stamp.get(&(captured_at, sequence as u32)).copied()
    }
}
