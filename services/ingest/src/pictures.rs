//! Pictures in files: one file, a directory, or a glob, in natural order (`f9` before `f10`).

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// File name extensions of the pictures that can be decoded, lower case.
pub const EXTENSIONS: [&str; 3] = ["jpg", "jpeg", "png"];

/// The largest picture file that is read, in bytes: an uncompressed 8-bit RGB picture of 4,700 × 4,700 pixels.
pub const MAX_FILE_BYTES: u64 = 64 << 20;

/// A picture as it lies in its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedPicture {
    /// Where it was read from.
    pub path: PathBuf,
    /// The whole file.
    pub bytes: Vec<u8>,
}

/// Why text does not name pictures.
#[derive(Debug, thiserror::Error)]
pub enum OpenPicturesError {
    /// Nothing is there.
    #[error("`{spec}` is not a file, a directory or a glob that matches anything")]
    NotFound {
        /// The text as given.
        spec: String,
    },
    /// Files are there, but no pictures.
    #[error("`{spec}` holds no pictures (*.jpg, *.jpeg, *.png){}", hint(nearest))]
    NoPictures {
        /// The text as given.
        spec: String,
        /// A directory below it that does hold pictures.
        nearest: Option<PathBuf>,
    },
    /// The glob cannot be read as one.
    #[error("`{spec}` is not a valid glob")]
    Glob {
        /// The text as given.
        spec: String,
        /// Where it went wrong.
        source: glob::PatternError,
    },
    /// The directory cannot be listed.
    #[error("cannot list `{}`", path.display())]
    List {
        /// The directory.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// Why a picture's file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadPictureError {
    /// The system refused.
    #[error("cannot read `{}`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Too large to be a picture from a camera.
    #[error("`{}` is larger than the {} MiB allowed for a picture", path.display(), MAX_FILE_BYTES >> 20)]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
}

fn hint(nearest: &Option<PathBuf>) -> String {
    nearest.as_ref().map_or_else(String::new, |path| format!("; `{}` does", path.display()))
}

/// Picture files in natural order, each read when it is its turn.
#[derive(Debug)]
pub struct PictureFiles {
    paths: std::vec::IntoIter<PathBuf>,
}

impl PictureFiles {
    /// The pictures that `spec` names: a picture file, a directory (its own pictures, not those of directories below
    /// it), or a glob.
    ///
    /// # Errors
    /// When nothing is there, when nothing there is a picture, or when it cannot be listed.
    pub fn open(spec: &str) -> Result<Self, OpenPicturesError> {
        let path = Path::new(spec);
        let mut paths = match path.metadata() {
            Ok(metadata) if metadata.is_dir() => pictures_in(path)?,
            Ok(_) => vec![path.to_owned()],
            Err(_) => pictures_matching(spec)?,
        };
        paths.retain(|path| is_picture(path));
        if paths.is_empty() {
            return Err(OpenPicturesError::NoPictures {
                spec: spec.to_owned(),
                nearest: nearest_below(path),
            });
        }
        paths.sort_by(|a, b| natord::compare(&a.to_string_lossy(), &b.to_string_lossy()));
        Ok(Self { paths: paths.into_iter() })
    }
}

impl Iterator for PictureFiles {
    type Item = Result<EncodedPicture, ReadPictureError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.paths.next().map(read_picture)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.paths.size_hint()
    }
}

impl ExactSizeIterator for PictureFiles {}

/// Reads one picture file.
///
/// # Errors
/// When it cannot be read or is larger than [`MAX_FILE_BYTES`].
pub fn read_picture(path: PathBuf) -> Result<EncodedPicture, ReadPictureError> {
    let mut bytes = Vec::new();
    let read = File::open(&path).and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes));
    match read {
        Err(source) => Err(ReadPictureError::Read { path, source }),
        Ok(_) if bytes.len() as u64 > MAX_FILE_BYTES => Err(ReadPictureError::TooLarge { path }),
        Ok(_) => Ok(EncodedPicture { path, bytes }),
    }
}

fn is_picture(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}

fn entries(directory: &Path) -> Result<Vec<PathBuf>, OpenPicturesError> {
    std::fs::read_dir(directory)
        .and_then(|entries| entries.map(|entry| entry.map(|entry| entry.path())).collect())
        .map_err(|source| OpenPicturesError::List { path: directory.to_owned(), source })
}

fn pictures_in(directory: &Path) -> Result<Vec<PathBuf>, OpenPicturesError> {
    let mut paths = entries(directory)?;
    paths.retain(|path| path.is_file());
    Ok(paths)
}

fn pictures_matching(spec: &str) -> Result<Vec<PathBuf>, OpenPicturesError> {
    let matches =
        glob::glob(spec).map_err(|source| OpenPicturesError::Glob { spec: spec.to_owned(), source })?;
    let paths: Vec<PathBuf> = matches.filter_map(Result::ok).filter(|path| path.is_file()).collect();
    if paths.is_empty() {
        return Err(OpenPicturesError::NotFound { spec: spec.to_owned() });
    }
    Ok(paths)
}

/// A directory right below `path` that holds pictures: people often name the directory one level too high.
fn nearest_below(path: &Path) -> Option<PathBuf> {
    let mut below = entries(path).ok()?;
    below.sort();
    below.into_iter().find(|path| {
        path.is_dir() && pictures_in(path).is_ok_and(|files| files.iter().any(|file| is_picture(file)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directory_with(names: &[&str]) -> tempfile::TempDir {
        let directory = tempfile::tempdir().unwrap();
        for name in names {
            std::fs::write(directory.path().join(name), name).unwrap();
        }
        directory
    }

    fn names(spec: &Path) -> Vec<String> {
        let files = PictureFiles::open(spec.to_str().unwrap()).unwrap();
        files.map(|picture| picture.unwrap().path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
    }

    #[test]
    fn a_directory_gives_its_pictures_in_natural_order() {
        let directory = directory_with(&["f10.jpg", "f9.jpg", "truth.csv", "f2.PNG"]);
        assert_eq!(names(directory.path()), ["f2.PNG", "f9.jpg", "f10.jpg"]);
    }

    #[test]
    fn a_glob_gives_what_it_matches() {
        let directory = directory_with(&["a1.jpg", "a2.jpg", "b1.jpg", "a3.txt"]);
        assert_eq!(names(&directory.path().join("a*")), ["a1.jpg", "a2.jpg"]);
    }

    #[test]
    fn a_file_whose_name_looks_like_a_glob_is_a_file() {
        let directory = directory_with(&["left[1].jpg"]);
        assert_eq!(names(&directory.path().join("left[1].jpg")), ["left[1].jpg"]);
    }

    #[test]
    fn nothing_found_says_what_was_looked_for() {
        let directory = directory_with(&["notes.txt"]);
        let spec = directory.path().to_str().unwrap();
        assert!(matches!(PictureFiles::open(spec), Err(OpenPicturesError::NoPictures { nearest: None, .. })));
        let missing = format!("{spec}/no*.jpg");
        assert!(matches!(PictureFiles::open(&missing), Err(OpenPicturesError::NotFound { .. })));
        assert!(matches!(PictureFiles::open("a[.jpg"), Err(OpenPicturesError::Glob { .. })));
    }

    #[test]
    fn a_directory_one_level_too_high_is_pointed_down() {
        let directory = directory_with(&[]);
        let frames = directory.path().join("frames");
        std::fs::create_dir(&frames).unwrap();
        std::fs::write(frames.join("1.jpg"), "x").unwrap();
        let error = PictureFiles::open(directory.path().to_str().unwrap()).unwrap_err();
        assert!(error.to_string().ends_with(&format!("; `{}` does", frames.display())), "{error}");
    }

    #[test]
    fn oversized_files_are_refused_before_they_are_read_whole() {
        let directory = directory_with(&["big.png"]);
        let path = directory.path().join("big.png");
        File::options().write(true).open(&path).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
        assert!(matches!(read_picture(path), Err(ReadPictureError::TooLarge { .. })));
    }
}
