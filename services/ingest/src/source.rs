//! What an `INPUT` of the command line or a `source` of a configuration names.

use std::path::PathBuf;
use std::str::FromStr;

use crate::films::is_film;

/// Where pictures come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SourceUri {
    /// A directory or a glob of pictures.
    Pictures(String),
    /// A film: an MP4 file.
    Film(PathBuf),
    /// A recording; `topic` picks one of several cameras.
    Recording {
        /// The MCAP file.
        file: PathBuf,
        /// The image topic, needed where the file holds several.
        topic: Option<String>,
    },
    /// A simulated camera; the whole URI, which the simulator parses.
    Simulator(String),
    /// A camera published over Zenoh under this key expression.
    Zenoh(String),
}

/// Why text does not name a source.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum SourceUriError {
    /// Nothing was given.
    #[error(
        "source is empty; name a directory or glob of pictures, a film (FILE.mp4), a recording (FILE.mcap), sim:SCENE or zenoh:KEYEXPR"
    )]
    Empty,
    /// A scheme nobody here serves.
    #[error(
        "source `{uri}` has the scheme `{scheme}`, which is not supported; allowed are `mcap:FILE#topic`, `sim:SCENE?seed=N`, `zenoh:KEYEXPR`, a film (FILE.mp4), a directory, or a glob"
    )]
    Scheme {
        /// The text as given.
        uri: String,
        /// What stood before the colon.
        scheme: String,
    },
}

impl FromStr for SourceUri {
    type Err = SourceUriError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.split_once(':') {
            _ if text.is_empty() => Err(SourceUriError::Empty),
            Some(("sim", _)) => Ok(Self::Simulator(text.to_owned())),
            Some(("zenoh", key)) => Ok(Self::Zenoh(key.to_owned())),
            Some(("mcap", rest)) => {
                let (file, topic) = match rest.split_once('#') {
                    Some((file, topic)) => (file, Some(topic.to_owned())),
                    None => (rest, None),
                };
                Ok(Self::Recording { file: file.into(), topic })
            }
            Some((scheme, _)) if is_scheme(scheme) => {
                Err(SourceUriError::Scheme { uri: text.to_owned(), scheme: scheme.to_owned() })
            }
            _ if text.ends_with(".mcap") || text.ends_with(".mcap.active") => {
                Ok(Self::Recording { file: text.into(), topic: None })
            }
            _ if is_film(text) => Ok(Self::Film(text.into())),
            _ => Ok(Self::Pictures(text.to_owned())),
        }
    }
}

/// RFC 3986 section 3.1, less the one-letter schemes that are drive letters elsewhere.
fn is_scheme(text: &str) -> bool {
    text.len() > 1
        && text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_apart() {
        let parse = |text: &str| text.parse::<SourceUri>();
        assert_eq!(parse("frames/*.jpg"), Ok(SourceUri::Pictures("frames/*.jpg".into())));
        assert_eq!(parse("clips/Blocks.MP4"), Ok(SourceUri::Film("clips/Blocks.MP4".into())));
        assert_eq!(parse("sim:rink?seed=3"), Ok(SourceUri::Simulator("sim:rink?seed=3".into())));
        assert_eq!(parse("zenoh:a/b"), Ok(SourceUri::Zenoh("a/b".into())));
        assert_eq!(parse("drive.mcap"), Ok(SourceUri::Recording { file: "drive.mcap".into(), topic: None }));
        assert_eq!(
            parse("mcap:drive.mcap#/v/camera/c/image"),
            Ok(SourceUri::Recording { file: "drive.mcap".into(), topic: Some("/v/camera/c/image".into()) })
        );
        assert!(matches!(parse("ftp://x"), Err(SourceUriError::Scheme { scheme, .. }) if scheme == "ftp"));
        assert_eq!(parse(""), Err(SourceUriError::Empty));
    }
}
