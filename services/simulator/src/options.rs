//! Which scene, how large, how fast, and which of its variations.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use vision::SizePx;

/// The scenes of the reference thesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SceneKind {
    /// Section 3.2: four blocks on three kinds of floor before a dark wall. Objects: `red`, `blue`, `black`, `tan`.
    Rink,
    /// Section 4.0.7: a drive up to a stop sign past red clutter. Object: `sign`.
    StopSign,
    /// Section 4.0.8: green road signs, one each 200 feet. Objects: `sign-1`, `sign-2`, …
    GreenSigns,
}

impl SceneKind {
    /// Every scene.
    pub const ALL: [Self; 3] = [Self::Rink, Self::StopSign, Self::GreenSigns];

    /// The name in a source URI.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rink => "rink",
            Self::StopSign => "stop-sign",
            Self::GreenSigns => "green-signs",
        }
    }
}

impl fmt::Display for SceneKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for SceneKind {
    type Err = OptionsError;

    fn from_str(name: &str) -> Result<Self, OptionsError> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| OptionsError::UnknownScene { got: name.to_owned() })
    }
}

/// What the pictures look like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Look {
    /// A good camera: sharp, little noise, the exposure swings by a tenth.
    #[default]
    Clean,
    /// A film from a moving car, chosen by seed: blur of lens and motion mixed in linear light, an exposure that drifts,
    /// noise, sharpening, JPEG of quality 70 to 85 with halved chroma; the stop sign's road has red kerbs and red cars.
    Film,
}

impl Look {
    /// Every look.
    pub const ALL: [Self; 2] = [Self::Clean, Self::Film];

    /// The name in a source URI.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Film => "film",
        }
    }
}

impl FromStr for Look {
    type Err = OptionsError;

    fn from_str(name: &str) -> Result<Self, OptionsError> {
        let unknown = || OptionsError::UnknownLook { got: name.to_owned() };
        Self::ALL.into_iter().find(|look| look.name() == name).ok_or_else(unknown)
    }
}

/// What to simulate. The text form is `sim:SCENE?seed=3&width=640&height=480&fps=30&vehicle=1&frames=200&look=film`,
/// every parameter optional.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneOptions {
    /// The scene.
    pub kind: SceneKind,
    /// Chooses positions, colours, light, shadows and textures.
    pub seed: u64,
    /// Which vehicle looks: each has its own lane, its own start on the path, and its own camera's light and noise.
    pub vehicle: u32,
    /// Size of the picture; the field of view is 60° wide whatever the size.
    pub size: SizePx,
    /// Frames a second.
    pub frame_rate_hz: f64,
    /// Frames for one way along the path; then the vehicle drives back, and so on without end.
    pub frames_one_way: u32,
    /// What its pictures look like.
    pub look: Look,
}

/// Why options cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OptionsError {
    /// The text does not start with `sim:`.
    #[error("simulator source is {got:?}; it must start with \"sim:\", as in sim:rink?seed=3")]
    NotASimulator {
        /// The text received.
        got: String,
    },
    /// No scene has that name.
    #[error("simulator scene is {got:?}; use one of rink, stop-sign, green-signs")]
    UnknownScene {
        /// The name received.
        got: String,
    },
    /// No look has that name.
    #[error("simulator parameter look is {got:?}; use one of clean, film")]
    UnknownLook {
        /// The name received.
        got: String,
    },
    /// No parameter has that name.
    #[error("simulator parameter {name:?} is unknown; use seed, vehicle, width, height, fps, frames, look")]
    UnknownParameter {
        /// The name received.
        name: String,
    },
    /// A parameter's value is no number, or outside its range.
    #[error("simulator parameter {name} is {got:?}; it must be a number within {least} and {most}")]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// The value received.
        got: String,
        /// The least allowed value.
        least: f64,
        /// The greatest allowed value.
        most: f64,
    },
}

const WIDTH: RangeInclusive<u32> = 64..=4_096;
const HEIGHT: RangeInclusive<u32> = 48..=4_096;
const VEHICLE: RangeInclusive<u32> = 0..=1_000;
const FRAMES: RangeInclusive<u32> = 10..=1_000_000;
const FRAME_RATE_HZ: RangeInclusive<f64> = 0.1..=1_000.0;

impl SceneOptions {
    /// The scene with seed 1, vehicle 0, 640×480 pixels at 30 Hz.
    #[must_use]
    pub fn new(kind: SceneKind) -> Self {
        let frames_one_way = match kind {
            SceneKind::Rink => 150,
            SceneKind::StopSign => 200,
            SceneKind::GreenSigns => 360,
        };
        let size = SizePx { width: 640, height: 480 };
        Self { kind, seed: 1, vehicle: 0, size, frame_rate_hz: 30.0, frames_one_way, look: Look::Clean }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// Naming the parameter, the value and the range.
    pub fn validated(self) -> Result<Self, OptionsError> {
        within("width", self.size.width, WIDTH)?;
        within("height", self.size.height, HEIGHT)?;
        within("vehicle", self.vehicle, VEHICLE)?;
        within("frames", self.frames_one_way, FRAMES)?;
        within("fps", self.frame_rate_hz, FRAME_RATE_HZ)?;
        Ok(self)
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), OptionsError> {
        match name {
            "seed" => self.seed = number("seed", value, 0..=u64::MAX)?,
            "vehicle" => self.vehicle = number("vehicle", value, VEHICLE)?,
            "width" => self.size.width = number("width", value, WIDTH)?,
            "height" => self.size.height = number("height", value, HEIGHT)?,
            "fps" => self.frame_rate_hz = number("fps", value, FRAME_RATE_HZ)?,
            "frames" => self.frames_one_way = number("frames", value, FRAMES)?,
            "look" => self.look = value.parse()?,
            _ => return Err(OptionsError::UnknownParameter { name: name.to_owned() }),
        }
        Ok(())
    }
}

impl FromStr for SceneOptions {
    type Err = OptionsError;

    fn from_str(text: &str) -> Result<Self, OptionsError> {
        let rest =
            text.strip_prefix("sim:").ok_or_else(|| OptionsError::NotASimulator { got: text.to_owned() })?;
        let (scene, parameters) = rest.split_once('?').unwrap_or((rest, ""));
        let mut options = Self::new(scene.parse()?);
        for parameter in parameters.split('&').filter(|parameter| !parameter.is_empty()) {
            let (name, value) = parameter.split_once('=').unwrap_or((parameter, ""));
            options.set(name, value)?;
        }
        Ok(options)
    }
}

impl fmt::Display for SceneOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, seed, vehicle, size: SizePx { width, height }, frame_rate_hz, .. } = self;
        write!(f, "sim:{kind}?seed={seed}&vehicle={vehicle}&width={width}&height={height}")?;
        write!(f, "&fps={frame_rate_hz}&frames={}", self.frames_one_way)?;
        if self.look == Look::Clean { Ok(()) } else { write!(f, "&look={}", self.look.name()) }
    }
}

/// Numbers that can be named in an error.
trait Bound: FromStr + PartialOrd + fmt::Display + Copy {
    fn as_f64(self) -> f64;
}

impl Bound for u32 {
    fn as_f64(self) -> f64 {
        self.into()
    }
}

impl Bound for u64 {
    fn as_f64(self) -> f64 {
        self as f64
    }
}

impl Bound for f64 {
    fn as_f64(self) -> f64 {
        self
    }
}

fn out_of_range<T: Bound>(name: &'static str, got: String, range: &RangeInclusive<T>) -> OptionsError {
    OptionsError::OutOfRange { name, got, least: range.start().as_f64(), most: range.end().as_f64() }
}

fn number<T: Bound>(name: &'static str, text: &str, range: RangeInclusive<T>) -> Result<T, OptionsError> {
    let value: T = text.parse().map_err(|_| out_of_range(name, text.to_owned(), &range))?;
    within(name, value, range)
}

fn within<T: Bound>(name: &'static str, value: T, range: RangeInclusive<T>) -> Result<T, OptionsError> {
    if range.contains(&value) { Ok(value) } else { Err(out_of_range(name, value.to_string(), &range)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_with_all_parameters_is_read_and_written() {
        let text = "sim:stop-sign?seed=3&vehicle=1&width=1280&height=720&fps=12.5&frames=200";
        let options: SceneOptions = text.parse().unwrap();
        assert_eq!(options.size, SizePx { width: 1280, height: 720 });
        assert_eq!((options.seed, options.vehicle, options.frames_one_way), (3, 1, 200));
        assert_eq!(options.to_string(), text);
        let film = format!("{text}&look=film");
        assert_eq!(film.parse::<SceneOptions>().unwrap().to_string(), film);
        assert_eq!("sim:rink".parse(), Ok(SceneOptions::new(SceneKind::Rink)));
    }

    #[test]
    fn errors_name_parameter_value_and_range() {
        let error = |text: &str| text.parse::<SceneOptions>().unwrap_err().to_string();
        assert!(error("rink").contains("sim:rink"));
        assert!(error("sim:moon").contains("\"moon\"") && error("sim:moon").contains("green-signs"));
        assert!(error("sim:rink?speed=3").contains("\"speed\""));
        assert!(
            error("sim:rink?look=old").contains("\"old\"") && error("sim:rink?look=old").contains("film")
        );
        let width = error("sim:rink?width=20");
        assert!(["width", "\"20\"", "64", "4096"].iter().all(|part| width.contains(part)), "{width}");
        for bad in ["fps=0", "fps=NaN", "fps=inf", "frames=9", "seed=-1", "seed", "vehicle=x", "height=1e3"] {
            assert!(error(&format!("sim:rink?{bad}")).contains(bad.split('=').next().unwrap()));
        }
    }

    #[test]
    fn options_that_were_put_together_by_hand_are_checked_too() {
        let options = SceneOptions { frame_rate_hz: f64::NAN, ..SceneOptions::new(SceneKind::Rink) };
        assert!(options.validated().is_err());
    }
}
