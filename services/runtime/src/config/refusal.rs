//! Why a configuration is refused, in words that name the place and the remedy.

use std::io;
use std::path::PathBuf;

use figment::error::Kind;

use super::ConfigFile;
use super::locate::line_of_key;

/// Names less alike than this are no suggestion (Jaro-Winkler, 0..1).
const LEAST_LIKENESS: f64 = 0.7;

/// Why a configuration is refused.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// A file cannot be read.
    #[error("the configuration file {path}: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A file is no TOML.
    #[error("the configuration file {path} is no TOML: {source}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What is wrong, with line and column.
        source: Box<toml::de::Error>,
    },
    /// An assignment without `=`.
    #[error("--set {text} has no value; write --set a.b=value")]
    Assignment {
        /// The assignment.
        text: String,
    },
    /// A key with an empty part.
    #[error("{source_name}: {key:?} is no key; write it like a.b")]
    Key {
        /// The key.
        key: String,
        /// Where it was given.
        source_name: String,
    },
    /// A key or a value that nothing accepts.
    #[error("{}{what}{}", place(.location), quote(.location))]
    Value {
        /// What is wrong and what would be right.
        what: String,
        /// Where it was set.
        location: Location,
    },
    /// A value of the program's own that TOML cannot express.
    #[error("a value cannot be written as TOML: {reason}")]
    Defaults {
        /// The reason.
        reason: String,
    },
}

/// Where a value was set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The layer, as in `file follower.toml`; empty when no layer can be named.
    pub source: String,
    /// Line number and line, where the layer is a file.
    pub line: Option<(usize, String)>,
}

fn place(location: &Location) -> String {
    match (&location.line, location.source.as_str()) {
        (_, "") => String::new(),
        (Some((number, _)), source) => format!("{source}, line {number}: "),
        (None, source) => format!("{source}: "),
    }
}

fn quote(location: &Location) -> String {
    location.line.as_ref().map_or_else(String::new, |(_, line)| format!("\n  | {line}"))
}

pub(super) fn explain(error: &figment::Error, files: &[ConfigFile]) -> ConfigError {
    let mut path = error.path.clone();
    let what = describe(&error.kind, &mut path);
    let location = locate(error, &path, files);
    ConfigError::Value { what, location }
}

fn describe(kind: &Kind, path: &mut Vec<String>) -> String {
    match kind {
        Kind::UnknownField(name, known) => {
            if path.last() != Some(name) {
                path.push(name.clone());
            }
            let key = path.join(".");
            format!("nothing reads {key:?}; {}", suggestion(name, known))
        }
        Kind::UnknownVariant(name, known) => {
            format!("{} is {name:?}; {}", path.join("."), suggestion(name, known))
        }
        Kind::MissingField(name) => {
            path.push(name.to_string());
            format!("{} is missing", path.join("."))
        }
        Kind::InvalidType(found, wanted) | Kind::InvalidValue(found, wanted) => {
            format!("{} is {found}; allowed: {wanted}", path.join("."))
        }
        other => format!("{}: {other}", path.join(".")),
    }
}

fn suggestion(name: &str, known: &[&str]) -> String {
    let nearest = known
        .iter()
        .map(|known| (strsim::jaro_winkler(name, known), *known))
        .max_by(|(one, _), (other, _)| one.total_cmp(other))
        .filter(|(likeness, _)| *likeness >= LEAST_LIKENESS);
    match nearest {
        Some((_, nearest)) => format!("did you mean {nearest:?}?"),
        None => format!("allowed: {}", known.join(", ")),
    }
}

/// The layer that set the key. Where it was merged away from its metadata, the last file that holds the key.
fn locate(error: &figment::Error, path: &[String], files: &[ConfigFile]) -> Location {
    let source = error.metadata.as_ref().map(|metadata| metadata.name.to_string());
    let of_source = |file: &&ConfigFile| {
        source.as_ref().is_none_or(|source| *source == format!("file {}", file.path.display()))
    };
    let file = files.iter().rev().filter(of_source).find_map(|file| {
        let (number, line) = line_of_key(&file.text, path)?;
        Some((file, number, line.to_owned()))
    });
    match file {
        Some((file, number, line)) => {
            Location { source: format!("file {}", file.path.display()), line: Some((number, line)) }
        }
        None => Location { source: source.unwrap_or_default(), line: None },
    }
}
