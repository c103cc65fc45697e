//! Recordings that a crash left unfinished are recovered when the follower starts.

use std::path::Path;
use std::thread;

use recording::WriterOptions;
use recording::recover::{Leftover, Leftovers};

/// Claims what lies unfinished in `directory` and recovers it on a thread of its own, because that reads whole files.
/// Called before the journal begins its own file there. The process may end meanwhile: the next start begins anew.
pub(crate) fn recover(directory: &Path) {
    let leftovers = match Leftovers::claim(directory) {
        Ok(leftovers) => leftovers,
        Err(error) => return tracing::warn!(%error, "unfinished recordings cannot be looked for"),
    };
    if leftovers.is_empty() {
        return;
    }
    let recovery = move || leftovers.recover(&WriterOptions::default()).iter().for_each(tell);
    if let Err(error) = thread::Builder::new().name("recovery".to_owned()).spawn(recovery) {
        tracing::warn!(%error, "unfinished recordings are left as they are");
    }
}

fn tell(leftover: &Leftover) {
    match leftover {
        Leftover::Renamed(path) => tracing::info!(file = %path.display(), "recording given its final name"),
        Leftover::Recovered(report) => {
            let (file, messages, cut_bytes) = (report.output.display(), report.messages, report.cut_bytes);
            tracing::info!(%file, messages, cut_bytes, "recording recovered");
        }
        Leftover::Left(path, error) => {
            tracing::error!(file = %path.display(), %error, "recording cannot be recovered");
        }
    }
}
