//! Landmarks as JSON documents of a web face: numbers as numbers, names as the command line writes them.
//!
//! Files and recordings use the protobuf's own JSON mapping instead ([`crate::json`]).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use vision::{ColorStats, Landmark, LandmarkSet, ShapeClass};

use crate::convert::{InvalidField, landmark_draft_from_wire};
use crate::v1;

/// A whole set with its version.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SetDocument {
    /// Which state of the set this is.
    pub version: VersionDocument,
    /// By id.
    pub landmarks: Vec<LandmarkDocument>,
}

/// Which state of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct VersionDocument {
    /// Counts the leader's starts.
    pub epoch: u64,
    /// Counts changes within the epoch.
    pub version: u64,
}

/// One landmark.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LandmarkDocument {
    /// Its id; where the address names it, it may be left out.
    #[serde(default)]
    pub id: String,
    /// Counts changes of its content; the leader gives it.
    #[serde(default)]
    pub revision: u64,
    /// SHA-256 over the content, hexadecimal; the leader computes it.
    #[serde(default)]
    pub digest: String,
    /// Averaging window: columns and rows on the doubled grid.
    pub window_px: [u16; 2],
    /// Its outline.
    pub shape: ShapeName,
    /// Physical width, metres; null where unknown.
    #[serde(default)]
    pub size_m: Option<f32>,
    /// How far each statistic may be off.
    pub tolerance: StatisticsDocument,
    /// Six statistics for each of its shades.
    pub shades: Vec<StatisticsDocument>,
}

/// Six statistics, R, G, B.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StatisticsDocument {
    /// Means, levels.
    pub mean: [f32; 3],
    /// Population variances, levels².
    pub variance: [f32; 3],
}

/// Names of the outlines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ShapeName {
    /// No statement.
    #[default]
    Any,
    /// Perpendicular pairs of edges.
    Block,
    /// Two parallel pairs of edges.
    Rectangle,
    /// Eight edges.
    Octagon,
    /// Three edges.
    Triangle,
    /// A circle.
    Circle,
}

impl From<&LandmarkSet> for SetDocument {
    fn from(set: &LandmarkSet) -> Self {
        Self {
            version: VersionDocument { epoch: set.version.epoch, version: set.version.version },
            landmarks: set.landmarks.iter().map(|landmark| landmark.as_ref().into()).collect(),
        }
    }
}

impl From<&Landmark> for LandmarkDocument {
    fn from(landmark: &Landmark) -> Self {
        Self {
            id: landmark.id.clone(),
            revision: landmark.revision,
            digest: landmark.digest.to_string(),
            window_px: [landmark.window_px.width, landmark.window_px.height],
            shape: landmark.shape.into(),
            size_m: landmark.size_m,
            tolerance: landmark.tolerance.into(),
            shades: landmark.shades.iter().copied().map(StatisticsDocument::from).collect(),
        }
    }
}

impl LandmarkDocument {
    /// The landmark of `set` with this id.
    #[must_use]
    pub fn in_set(set: &LandmarkSet, id: &str) -> Option<Self> {
        set.landmarks.iter().find(|landmark| landmark.id == id).map(|landmark| landmark.as_ref().into())
    }

    /// The landmark to be published: revision and digest are the leader's to give.
    ///
    /// # Errors
    /// The first field that is not allowed.
    pub fn draft(&self) -> Result<Landmark, InvalidField> {
        landmark_draft_from_wire(&v1::Landmark {
            id: self.id.clone(),
            window_width_px: self.window_px[0].into(),
            window_height_px: self.window_px[1].into(),
            shades: self.shades.iter().map(|shade| shade.to_wire()).collect(),
            tolerance: Some(self.tolerance.to_wire()),
            shape: crate::digest::shape_number(self.shape.into()).into(),
            size_m: self.size_m,
            ..v1::Landmark::default()
        })
    }
}

impl StatisticsDocument {
    fn to_wire(self) -> v1::ColorStats {
        v1::ColorStats { mean: self.mean.to_vec(), variance: self.variance.to_vec() }
    }
}

impl From<ColorStats> for StatisticsDocument {
    fn from(stats: ColorStats) -> Self {
        Self { mean: stats.mean, variance: stats.variance }
    }
}

impl From<ShapeClass> for ShapeName {
    fn from(shape: ShapeClass) -> Self {
        match shape {
            ShapeClass::Any => Self::Any,
            ShapeClass::Block => Self::Block,
            ShapeClass::Rectangle => Self::Rectangle,
            ShapeClass::Octagon => Self::Octagon,
            ShapeClass::Triangle => Self::Triangle,
            ShapeClass::Circle => Self::Circle,
        }
    }
}

impl From<ShapeName> for ShapeClass {
    fn from(name: ShapeName) -> Self {
        match name {
            ShapeName::Any => Self::Any,
            ShapeName::Block => Self::Block,
            ShapeName::Rectangle => Self::Rectangle,
            ShapeName::Octagon => Self::Octagon,
            ShapeName::Triangle => Self::Triangle,
            ShapeName::Circle => Self::Circle,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::arbitrary::landmarks;

    proptest! {
        #[test]
        fn a_document_gives_back_the_landmark_it_tells_of(landmark in landmarks()) {
            let text = serde_json::to_string(&LandmarkDocument::from(&landmark)).unwrap();
            let document: LandmarkDocument = serde_json::from_str(&text).unwrap();
            prop_assert_eq!(document.draft().unwrap(), Landmark { revision: 0, ..landmark });
        }
    }

    #[test]
    fn shapes_are_named_as_everywhere() {
        for shape in [ShapeClass::Any, ShapeClass::Block, ShapeClass::Octagon] {
            let name = serde_json::to_value(ShapeName::from(shape)).unwrap();
            assert_eq!(name, shape.name());
        }
    }
}
