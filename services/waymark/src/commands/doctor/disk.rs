//! Whether a service can keep what it has to keep: its state, and its recordings as fast as they come.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::HumanBytes;

use super::finding::Finding;
use super::subject::{Recordings, Subject};

/// A camera of 1280×720 pixels at 30 Hz in JPEG needs about 6 MB/s.
const BYTES_PER_SECOND_AND_CAMERA: f64 = 8e6;
const BLOCK_BYTES: usize = 1 << 20;
const MOST_BLOCKS: usize = 64;
/// No block is begun later than this.
const WRITING: Duration = Duration::from_secs(1);
/// A disk that has not written a second's worth by then hangs.
const DEADLINE: Duration = Duration::from_secs(10);
const REMEDY: &str = "give a directory that this user may write to, on a disk that is not mounted read-only";

pub(super) async fn examine(subject: &Subject) -> Vec<Finding> {
    let state = match subject.state_dir.clone() {
        None => Finding::not_applicable("state directory", format!("a {} keeps no state", subject.role())),
        Some(directory) => patiently("state directory", move || state(&directory)).await,
    };
    let Some(recordings) = subject.recordings.clone() else {
        let why = format!("this {} records nothing", subject.role());
        let none = |check| Finding::not_applicable(check, why.clone());
        return vec![state, none("disk space"), none("disk speed")];
    };
    let for_speed = recordings.clone();
    let space = patiently("disk space", move || space(&recordings)).await;
    let speed = patiently("disk speed", move || speed(&for_speed)).await;
    vec![state, space, speed]
}

/// A disk that hangs keeps a thread of its own, not this program.
async fn patiently(check: &'static str, work: impl FnOnce() -> Finding + Send + 'static) -> Finding {
    match tokio::time::timeout(DEADLINE, tokio::task::spawn_blocking(work)).await {
        Ok(Ok(finding)) => finding,
        Ok(Err(error)) => Finding::no(check, error.to_string(), "report this as a fault of Waymark"),
        Err(_) => {
            let found = format!("the disk has not answered for {} s", DEADLINE.as_secs());
            Finding::no(check, found, "see the kernel's log (dmesg); record to another disk")
        }
    }
}

fn state(directory: &Path) -> Finding {
    let place = standing(directory);
    match tempfile::tempfile_in(&place) {
        Ok(_deleted) => Finding::yes("state directory", format!("{} can be written", directory.display())),
        Err(error) => Finding::no(
            "state directory",
            format!("{}: {error}", place.display()),
            format!("state_dir: {REMEDY}"),
        ),
    }
}

fn space(recordings: &Recordings) -> Finding {
    let place = standing(&recordings.directory);
    let free_bytes = match rustix::fs::statvfs(&place) {
        Ok(stat) => stat.f_bavail.saturating_mul(stat.f_frsize),
        Err(error) => return Finding::no("disk space", format!("{}: {error}", place.display()), REMEDY),
    };
    let (free, kept_free) = (HumanBytes(free_bytes), HumanBytes(recordings.min_free_bytes));
    if free_bytes <= recordings.min_free_bytes {
        let found = format!("{free} free at {}, and recording leaves {kept_free} free", place.display());
        let remedy = "delete old recordings, record to another disk, or lower recorder.min_free_bytes; \
                      recorder.max_total_bytes has the oldest deleted by itself";
        return Finding::no("disk space", found, remedy);
    }
    let room_bytes = (free_bytes - recordings.min_free_bytes) as f64;
    let minutes = room_bytes / (BYTES_PER_SECOND_AND_CAMERA * recordings.cameras.max(1) as f64) / 60.0;
    Finding::yes(
        "disk space",
        format!("{free} free at {}, enough for {minutes:.0} min or more", place.display()),
    )
}

fn speed(recordings: &Recordings) -> Finding {
    let place = standing(&recordings.directory);
    let needed = BYTES_PER_SECOND_AND_CAMERA * recordings.cameras.max(1) as f64;
    let worded = |rate: f64| format!("{:.0} MB/s written and synced at {}", rate * 1e-6, place.display());
    match bytes_per_second(&place) {
        Ok(rate) if rate >= needed => Finding::yes("disk speed", worded(rate)),
        Ok(rate) => {
            let found = format!("{}; {:.0} MB/s are needed", worded(rate), needed * 1e-6);
            Finding::no("disk speed", found, "record to a faster disk, or fewer or smaller pictures")
        }
        Err(error) => {
            let remedy = format!("recorder.directory: {REMEDY}");
            Finding::no("disk speed", format!("{}: {error}", place.display()), remedy)
        }
    }
}

/// Writes as the recorder does, in blocks that are synced, into a file that has no name and so leaves nothing behind.
fn bytes_per_second(place: &Path) -> io::Result<f64> {
    let mut file: File = tempfile::tempfile_in(place)?;
    // Not zeros: some file systems do not store those.
    let block: Vec<u8> = (0..BLOCK_BYTES).map(|at| (at.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let began = Instant::now();
    let mut written = 0;
    while written < MOST_BLOCKS && began.elapsed() < WRITING {
        file.write_all(&block)?;
        file.sync_data()?;
        written += 1;
    }
    Ok((written * BLOCK_BYTES) as f64 / began.elapsed().as_secs_f64())
}

/// The directory, or where it would be made.
fn standing(directory: &Path) -> PathBuf {
    let absolute = std::path::absolute(directory).unwrap_or_else(|_| directory.to_owned());
    let exists = |path: &&Path| fs::metadata(path).is_ok();
    absolute.ancestors().find(exists).unwrap_or(&absolute).to_owned()
}
