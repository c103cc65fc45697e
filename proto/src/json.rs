//! Landmark files: the protobuf JSON mapping of `waymark.v1.Landmark` and `waymark.v1.LandmarkSet`.
//!
//! A file that a person wrote may leave out `revision`, `epoch` and `digest`; field names that do not exist are
//! refused, so that a misspelt tolerance does not silently become another one.

use prost_reflect::{DescriptorPool, DynamicMessage, ReflectMessage as _, SerializeOptions};
use vision::{Landmark, LandmarkSet};

use crate::convert::{
    InvalidField, landmark_draft_from_wire, landmark_from_wire, landmark_to_wire, set_from_wire, set_to_wire,
};
use crate::payload::{WAYMARK_DESCRIPTORS, WireMessage};
use crate::v1;

/// Why a text is no landmark file.
#[derive(Debug, thiserror::Error)]
pub enum LandmarkFileError {
    /// Not JSON, or not the JSON of this message.
    #[error("not the JSON of a {schema}: {source}")]
    Json {
        /// The message expected.
        schema: &'static str,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// A value that no landmark has.
    #[error("{0}{hint}", hint = hint(.0))]
    Value(#[from] InvalidField),
    /// The message cannot be described; a build without its own descriptors.
    #[error("this build does not describe {schema}: {reason}")]
    Undescribed {
        /// The message.
        schema: &'static str,
        /// What its descriptors lack.
        reason: String,
    },
}

fn hint(invalid: &InvalidField) -> &'static str {
    if invalid.field.ends_with("digest") {
        "; leave \"digest\" out after changing a landmark by hand"
    } else {
        ""
    }
}

/// Reads one landmark. Without a revision in the file it has revision 0: the leader gives it one.
///
/// # Errors
/// When the text is no such JSON, names an unknown field, or holds a value that no landmark has.
pub fn landmark_from_json(text: &str) -> Result<Landmark, LandmarkFileError> {
    Ok(landmark_draft_from_wire(&from_json::<v1::Landmark>(text)?)?)
}

/// One landmark as a file's text, ending in a line feed. It has no epoch, which is a leader's affair.
///
/// # Errors
/// Never for a landmark that passed validation: JSON has no NaN.
pub fn landmark_to_json(landmark: &Landmark) -> Result<String, LandmarkFileError> {
    to_json(&landmark_to_wire(landmark, 0))
}

/// Reads a whole set with its manifest.
///
/// # Errors
/// As [`landmark_from_json`], and when the manifest does not describe the landmarks.
pub fn set_from_json(text: &str) -> Result<LandmarkSet, LandmarkFileError> {
    Ok(set_from_wire(&from_json::<v1::LandmarkSet>(text)?)?)
}

/// A whole set with its manifest as a file's text.
///
/// # Errors
/// As [`landmark_to_json`].
pub fn set_to_json(set: &LandmarkSet) -> Result<String, LandmarkFileError> {
    to_json(&set_to_wire(set))
}

/// Reads landmarks that are no set: several may have one id.
///
/// # Errors
/// As [`landmark_from_json`].
pub fn landmarks_from_json(text: &str) -> Result<Vec<Landmark>, LandmarkFileError> {
    let wire: v1::LandmarkSet = from_json(text)?;
    wire.landmarks.iter().map(|landmark| Ok(landmark_from_wire(landmark)?.0)).collect()
}

/// Landmarks that are no set as a file's text: a `waymark.v1.LandmarkSet` without a manifest.
///
/// # Errors
/// As [`landmark_to_json`].
pub fn landmarks_to_json<'a>(
    landmarks: impl IntoIterator<Item = &'a Landmark>,
) -> Result<String, LandmarkFileError> {
    let landmarks = landmarks.into_iter().map(|landmark| landmark_to_wire(landmark, 0)).collect();
    to_json(&v1::LandmarkSet { manifest: None, landmarks })
}

/// A message of `waymark.v1` in the protobuf JSON mapping, indented.
///
/// # Errors
/// When a number in it is none.
pub fn to_json<M: WireMessage>(message: &M) -> Result<String, LandmarkFileError> {
    let undescribed = |source: prost::DecodeError| LandmarkFileError::Undescribed {
        schema: M::SCHEMA,
        reason: source.to_string(),
    };
    let mut dynamic = empty::<M>()?;
    dynamic.transcode_from(message).map_err(undescribed)?;
    let mut text = Vec::new();
    let mut serializer = serde_json::Serializer::pretty(&mut text);
    let options = SerializeOptions::new().skip_default_fields(true);
    let json = |source| LandmarkFileError::Json { schema: M::SCHEMA, source };
    dynamic.serialize_with_options(&mut serializer, &options).map_err(json)?;
    text.push(b'\n');
    Ok(String::from_utf8_lossy(&text).into_owned())
}

fn from_json<M: WireMessage>(text: &str) -> Result<M, LandmarkFileError> {
    let json = |source| LandmarkFileError::Json { schema: M::SCHEMA, source };
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let descriptor = empty::<M>()?.descriptor();
    let dynamic = DynamicMessage::deserialize(descriptor, &mut deserializer).map_err(json)?;
    deserializer.end().map_err(json)?;
    dynamic
        .transcode_to()
        .map_err(|source| LandmarkFileError::Undescribed { schema: M::SCHEMA, reason: source.to_string() })
}

fn empty<M: WireMessage>() -> Result<DynamicMessage, LandmarkFileError> {
    let undescribed = |reason| LandmarkFileError::Undescribed { schema: M::SCHEMA, reason };
    let pool = DescriptorPool::decode(WAYMARK_DESCRIPTORS).map_err(|error| undescribed(error.to_string()))?;
    let descriptor =
        pool.get_message_by_name(M::SCHEMA).ok_or_else(|| undescribed("no such message".to_owned()))?;
    Ok(DynamicMessage::new(descriptor))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::arbitrary::{landmarks, sets};

    const HAND_WRITTEN: &str = r#"{
        "id": "red",
        "windowWidthPx": 12,
        "window_height_px": 12,
        "shades": [{"mean": [176.5, 32, 41.25], "variance": [90, 60.5, 55]}],
        "tolerance": {"mean": [15, 15, 15], "variance": [50, 50, 50]},
        "shape": "SHAPE_CLASS_BLOCK"
    }"#;

    #[test]
    fn a_file_written_by_hand_is_read() {
        let landmark = landmark_from_json(HAND_WRITTEN).unwrap();
        assert_eq!((landmark.id.as_str(), landmark.revision, landmark.size_m), ("red", 0, None));
        assert_eq!(landmark.shades[0].mean, [176.5, 32.0, 41.25]);
        assert_ne!(landmark.digest.0, [0; 32]);
    }

    fn refusal(from: &str, to: &str) -> String {
        let changed = HAND_WRITTEN.replace(from, to);
        assert_ne!(changed, HAND_WRITTEN);
        landmark_from_json(&changed).unwrap_err().to_string()
    }

    #[test]
    fn errors_say_where_and_what() {
        let unknown = refusal("\"tolerance\"", "\"tolerence\"");
        assert!(unknown.contains("tolerence") && unknown.contains("line 6"), "{unknown}");
        let shape = refusal("SHAPE_CLASS_BLOCK", "SHAPE_CLASS_BLOB");
        assert!(shape.contains("SHAPE_CLASS_BLOB"), "{shape}");
        let range = refusal("176.5", "1e308");
        assert!(range.contains("line") || range.contains("shades[0].mean[0]"), "{range}");
        let negative = refusal("[90,", "[-90,");
        assert_eq!(negative, "shades[0].variance[0] is -90.0; allowed: 0 to 16256.25");
        let none = refusal("[90,", "[\"NaN\",");
        assert_eq!(none, "shades[0].variance[0] is NaN; allowed: 0 to 16256.25");
        let trailing = landmark_from_json(&format!("{HAND_WRITTEN} x")).unwrap_err().to_string();
        assert!(trailing.contains("trailing"), "{trailing}");
        let stale = refusal("\"id\": \"red\"", "\"id\": \"red\", \"digest\": \"AAAA\"");
        assert!(stale.ends_with("leave \"digest\" out after changing a landmark by hand"), "{stale}");
    }

    proptest! {
        #[test]
        fn every_landmark_survives_its_file(landmark in landmarks()) {
            let text = landmark_to_json(&landmark).unwrap();
            prop_assert_eq!(landmark_from_json(&text).unwrap(), landmark);
        }

        #[test]
        fn every_set_survives_its_file(set in sets()) {
            let text = set_to_json(&set).unwrap();
            prop_assert_eq!(set_from_json(&text).unwrap(), set);
        }
    }
}
