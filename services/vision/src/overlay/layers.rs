//! Which parts of an outcome are drawn.

use std::fmt;
use std::ops::BitOr;
use std::str::FromStr;

/// A set of things to draw; as text the names joined by commas, `all` or `none`.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Layers(u8);

/// A layer's name that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "overlay layer {got:?} is unknown; use outline, segments, vector, prediction, gate, labels, all or none"
)]
pub struct UnknownLayer {
    got: String,
}

impl Layers {
    /// Nothing.
    pub const NONE: Self = Self(0);
    /// The outline of what was found, and its centroid.
    pub const OUTLINE: Self = Self(1);
    /// The straight pieces on which the shape verdict rests.
    pub const SEGMENTS: Self = Self(1 << 1);
    /// The vector from the picture's origin to the centroid, as in thesis Fig 4.5.
    pub const VECTOR: Self = Self(1 << 2);
    /// Where the landmark was expected.
    pub const PREDICTION: Self = Self(1 << 3);
    /// Within which bounds it was believed.
    pub const GATE: Self = Self(1 << 4);
    /// Name, position and area, or the reason of a miss.
    pub const LABELS: Self = Self(1 << 5);
    /// Everything.
    pub const ALL: Self = Self((1 << 6) - 1);

    const NAMES: [(&'static str, Self); 6] = [
        ("outline", Self::OUTLINE),
        ("segments", Self::SEGMENTS),
        ("vector", Self::VECTOR),
        ("prediction", Self::PREDICTION),
        ("gate", Self::GATE),
        ("labels", Self::LABELS),
    ];

    /// Whether all of `layers` are in this set.
    #[must_use]
    pub const fn contains(self, layers: Self) -> bool {
        self.0 & layers.0 == layers.0
    }
}

impl Default for Layers {
    fn default() -> Self {
        Self::ALL
    }
}

impl BitOr for Layers {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl FromStr for Layers {
    type Err = UnknownLayer;

    fn from_str(text: &str) -> Result<Self, UnknownLayer> {
        text.split(',').map(str::trim).try_fold(Self::NONE, |layers, name| {
            let named = match name {
                "all" => Some(Self::ALL),
                "none" => Some(Self::NONE),
                _ => Self::NAMES.into_iter().find(|(known, _)| *known == name).map(|(_, layer)| layer),
            };
            named
                .map(|layer| layers | layer)
                .ok_or_else(|| UnknownLayer { got: name.chars().take(32).collect() })
        })
    }
}

impl fmt::Display for Layers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = Self::NAMES
            .into_iter()
            .filter(|(_, layer)| self.contains(*layer))
            .map(|(name, _)| name)
            .collect();
        if names.is_empty() { f.write_str("none") } else { f.write_str(&names.join(",")) }
    }
}

impl fmt::Debug for Layers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Layers({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_is_written_and_read() {
        for bits in 0..=Layers::ALL.0 {
            let layers = Layers(bits);
            assert_eq!(layers.to_string().parse(), Ok(layers));
        }
        assert_eq!("gate, labels".parse(), Ok(Layers::GATE | Layers::LABELS));
        assert_eq!("all".parse(), Ok(Layers::ALL));
    }

    #[test]
    fn an_unknown_name_is_told_with_the_known_ones() {
        let error = "outline,sparkles".parse::<Layers>().unwrap_err().to_string();
        assert!(error.contains("\"sparkles\"") && error.contains("prediction"), "{error}");
        assert!("".parse::<Layers>().is_err());
    }
}
