//! Who can take part.

use std::fmt;
use std::str::FromStr;

/// A method of registration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Method {
    /// Statistical-gradient registration as the thesis has it (4.0.3), statistics and tolerances fixed.
    Faithful,
    /// The same, following light, noise and scale.
    Adaptive,
    /// Normalised cross correlation of brightness (2.7.4).
    NccGrey,
    /// Of all three channels.
    NccColour,
    /// Of all three channels at eight sizes.
    NccScales,
    /// Phase correlation (2.7.3) of the object's surroundings from frame to frame.
    PhaseCorrelation,
    /// Horn and Schunck's optical flow (2.8), by which the place is carried along from frame to frame.
    OpticalFlow,
    /// The largest blob of the landmark's colour.
    ColourBlob,
    /// Two perpendicular lines of the Hough transform (2.6), whatever the colour.
    HoughAlone,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 9] = [
        Self::Faithful,
        Self::Adaptive,
        Self::NccGrey,
        Self::NccColour,
        Self::NccScales,
        Self::PhaseCorrelation,
        Self::OpticalFlow,
        Self::ColourBlob,
        Self::HoughAlone,
    ];

    /// The name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Faithful => "faithful",
            Self::Adaptive => "adaptive",
            Self::NccGrey => "ncc-grey",
            Self::NccColour => "ncc-colour",
            Self::NccScales => "ncc-scales",
            Self::PhaseCorrelation => "phase-correlation",
            Self::OpticalFlow => "optical-flow",
            Self::ColourBlob => "colour-blob",
            Self::HoughAlone => "hough",
        }
    }

    /// What it does, in a few words.
    #[must_use]
    pub const fn says(self) -> &'static str {
        match self {
            Self::Faithful => {
                "statistical-gradient as the thesis has it: fixed statistics and tolerances (4.0.3)"
            }
            Self::Adaptive => "statistical-gradient, following light, noise and scale",
            Self::NccGrey => {
                "normalised cross correlation of brightness with the first picture of the object (2.7.4)"
            }
            Self::NccColour => "the same of all three channels",
            Self::NccScales => "the same of all three channels at eight sizes",
            Self::PhaseCorrelation => "phase correlation around the last place, from frame to frame (2.7.3)",
            Self::OpticalFlow => "the last place carried along by Horn and Schunck's flow (2.8)",
            Self::ColourBlob => "the largest blob of pixels within the tolerances of the means",
            Self::HoughAlone => "the longest two perpendicular lines that meet, whatever the colour (2.6)",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A method that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("method is `{got}`; use {}", Method::ALL.map(Method::name).join(", "))]
pub struct UnknownMethod {
    got: String,
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let found = Self::ALL.into_iter().find(|method| method.name() == name);
        found.ok_or_else(|| UnknownMethod { got: name.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_again() {
        for method in Method::ALL {
            assert_eq!(method.name().parse(), Ok(method));
        }
        assert!("sift".parse::<Method>().unwrap_err().to_string().contains("ncc-scales"));
    }
}
