//! Many recordings at once: named by globs, worked on several at a time, finished files kept when a run is repeated.

use std::fs::{self, File};
use std::io::BufWriter;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::PoisonError;

use anyhow::{Context, anyhow};
use indicatif::ProgressBar;

use crate::console::Console;
use crate::exit::{Failure, OrUsage};

/// Which recordings, and how many at a time.
#[derive(Debug, clap::Args)]
pub(crate) struct Batch {
    /// Recordings, or quoted globs of them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,

    /// Recordings worked on at the same time [default: one for each processor]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
}

impl Batch {
    /// The recordings in the order in which they were given, those of a glob in the order of their names.
    pub(crate) fn recordings(&self) -> Result<Vec<PathBuf>, Failure> {
        let mut files = Vec::new();
        for given in &self.files {
            match Path::new(given).exists() {
                true => files.push(PathBuf::from(given)),
                false => files.extend(matching(given)?),
            }
        }
        Ok(files)
    }

    /// Does `work` for every recording, several at a time; the results are in the order of `files`.
    pub(crate) fn each<T: Send>(
        &self,
        files: &[PathBuf],
        bar: &ProgressBar,
        work: impl Fn(&Path) -> anyhow::Result<T> + Sync,
    ) -> Vec<anyhow::Result<T>> {
        let results: Vec<Mutex<Option<anyhow::Result<T>>>> = files.iter().map(|_| Mutex::new(None)).collect();
        let waiting = Mutex::new(files.iter().zip(&results));
        let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
        std::thread::scope(|scope| {
            for _ in 0..self.threads().get().min(files.len()) {
                scope.spawn(|| {
                    while let Some((file, result)) = next() {
                        let done = work(file).with_context(|| format!("`{}`", file.display()));
                        *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(done);
                        bar.inc(1);
                    }
                });
            }
        });
        let finished =
            results.into_iter().map(|result| result.into_inner().unwrap_or_else(PoisonError::into_inner));
        finished.map(|result| result.unwrap_or_else(|| Err(anyhow!("its thread ended early")))).collect()
    }

    fn threads(&self) -> NonZeroUsize {
        self.threads.or_else(|| std::thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN)
    }
}

/// `given` with every glob of recordings in it replaced by those, in the order of their names; globs of pictures stay,
/// since they are a sequence each.
pub(crate) fn with_recordings(given: &[String]) -> Result<Vec<String>, Failure> {
    let mut inputs = Vec::new();
    for given in given {
        let is_glob =
            given.ends_with(".mcap") && given.contains(['*', '?', '[']) && !Path::new(given).exists();
        match is_glob {
            true => inputs.extend(matching(given)?.into_iter().map(|file| file.display().to_string())),
            false => inputs.push(given.clone()),
        }
    }
    Ok(inputs)
}

fn matching(given: &str) -> Result<Vec<PathBuf>, Failure> {
    let paths = glob::glob(given).with_context(|| format!("`{given}` is not a valid glob")).or_usage()?;
    let files: Vec<PathBuf> = paths.filter_map(Result::ok).filter(|path| path.is_file()).collect();
    match files.is_empty() {
        true => Err(Failure::Usage(anyhow!("`{given}` is not a file or a glob that matches anything"))),
        false => Ok(files),
    }
}

/// A name for what is made of each recording: its file name without extension, told apart by a number where two share
/// it.
pub(crate) fn stems(files: &[PathBuf]) -> Vec<String> {
    let stem = |file: &PathBuf| file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let stems: Vec<String> = files.iter().map(stem).collect();
    let named =
        stems.iter().enumerate().map(|(at, stem)| match stems[..at].iter().filter(|s| *s == stem).count() {
            0 => stem.clone(),
            earlier => format!("{stem}-{}", earlier + 1),
        });
    named.collect()
}

/// Whether `output` was made of `input` as it is now.
pub(crate) fn is_current(output: &Path, input: &Path) -> bool {
    let modified = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    modified(output).zip(modified(input)).is_some_and(|(output, input)| output >= input)
}

/// The name of a file that is not whole yet.
pub(crate) fn unfinished(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    PathBuf::from(name)
}

/// Writes a file that has its name only when it is whole; until then it ends in `.part`.
pub(crate) fn write_whole<T>(
    path: &Path,
    write: impl FnOnce(BufWriter<File>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let unfinished = unfinished(path);
    let file =
        File::create(&unfinished).with_context(|| format!("cannot write `{}`", unfinished.display()))?;
    let done = write(BufWriter::with_capacity(1 << 16, file))?;
    fs::rename(&unfinished, path).with_context(|| format!("cannot write `{}`", path.display()))?;
    Ok(done)
}

/// Tells of recordings that could not be worked on, and hands on what came of the others.
pub(crate) fn told<T>(results: Vec<anyhow::Result<T>>, console: Console) -> (Vec<T>, u64) {
    let (mut done, mut failed) = (Vec::new(), 0);
    for result in results {
        match result {
            Ok(result) => done.push(result),
            Err(error) => {
                failed += 1;
                console.warn(&format!("failed: {error:#}"));
            }
        }
    }
    (done, failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_of_recordings_with_one_name_are_told_apart() {
        let files = ["a/x.mcap", "b/x.mcap", "b/y.mcap"].map(PathBuf::from);
        assert_eq!(stems(&files), ["x", "x-2", "y"]);
    }

    #[test]
    fn globs_of_recordings_are_those_and_others_stay() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name).display().to_string();
        ["b.mcap", "a.mcap", "c.jpg"].iter().for_each(|name| fs::write(path(name), "").unwrap());
        let given = [path("*.mcap"), path("*.jpg"), path("b.mcap")];
        let inputs = with_recordings(&given).unwrap();
        assert_eq!(inputs, [path("a.mcap"), path("b.mcap"), path("*.jpg"), path("b.mcap")]);
        assert!(with_recordings(&[path("x*.mcap")]).is_err());
    }

    #[test]
    fn a_file_that_could_not_be_written_whole_has_no_name() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("table.csv");
        assert!(write_whole(&path, |_| -> anyhow::Result<()> { Err(anyhow!("no")) }).is_err());
        assert!(!path.exists());
        write_whole(&path, |_| Ok(())).unwrap();
        assert!(path.exists());
    }
}
