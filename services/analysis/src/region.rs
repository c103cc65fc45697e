//! A picture and a region of it in one word: `FILE#xywh=X,Y,W,H`, and `FILE.mp4#t=SECONDS&xywh=X,Y,W,H` for the frame
//! of a film (W3C Media Fragments URI 1.0, sections 4.2.1 and 4.2.2).

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use ingest::films::is_film;
use vision::{RectPx, SizePx};

/// A region of a picture, which is the whole of it where none was named.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureRegion {
    /// The picture's file.
    pub file: PathBuf,
    /// Which frame of a film: the one that is shown then, from the beginning. The first, where none was named.
    pub shown_at: Option<Duration>,
    /// Which part of it.
    pub region: Option<Region>,
}

/// A rectangle as a media fragment names it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// `xywh=` or `xywh=pixel:`: left, top, width, height in pixels.
    Pixels(RectPx),
    /// `xywh=percent:`: the same in percent of the picture's width and height.
    Percent([f32; 4]),
}

/// Why text does not name a region, or the region does not lie in its picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegionError {
    /// Nothing before the `#`.
    #[error("`{text}` names no picture; write FILE#xywh=X,Y,W,H")]
    NoFile {
        /// The text as given.
        text: String,
    },
    /// A fragment that is not a region.
    #[error(
        "`#{fragment}` is not a region; write #xywh=X,Y,W,H in whole pixels, for example #xywh=446,314,25,24, #xywh=percent:X,Y,W,H, or for the frame of a film #t=SECONDS&xywh=X,Y,W,H"
    )]
    Fragment {
        /// What stood behind the `#`.
        fragment: String,
    },
    /// A time of something that has none.
    #[error("`{file}` is no film, so #t= names nothing in it; write #xywh=X,Y,W,H")]
    NotAFilm {
        /// The file.
        file: String,
    },
    /// Nothing of it would be left.
    #[error("region {region} is empty; width and height must be greater than 0")]
    Empty {
        /// The region as given.
        region: String,
    },
    /// It reaches over an edge.
    #[error(
        "region {}×{} at {},{} reaches outside the picture, which is {}×{}; x + width may be at most {}, y + height at most {}",
        rect.width, rect.height, rect.x, rect.y, size.width, size.height, size.width, size.height
    )]
    Outside {
        /// The region in pixels.
        rect: RectPx,
        /// The picture's size.
        size: SizePx,
    },
}

impl FromStr for PictureRegion {
    type Err = RegionError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (file, fragment) = text.rsplit_once('#').unzip();
        let file = file.unwrap_or(text);
        let (mut shown_at, mut region) = (None, None);
        for part in fragment.into_iter().flat_map(|fragment| fragment.split('&')) {
            match part.strip_prefix("t=") {
                Some(seconds) => shown_at = Some(time(seconds, part)?),
                None => region = Some(part.parse()?),
            }
        }
        if file.is_empty() {
            return Err(RegionError::NoFile { text: text.to_owned() });
        }
        if shown_at.is_some() && !is_film(file) {
            return Err(RegionError::NotAFilm { file: file.to_owned() });
        }
        Ok(Self { file: file.into(), shown_at, region })
    }
}

fn time(seconds: &str, fragment: &str) -> Result<Duration, RegionError> {
    let time = seconds.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    time.ok_or_else(|| RegionError::Fragment { fragment: fragment.to_owned() })
}

impl FromStr for Region {
    type Err = RegionError;

    fn from_str(fragment: &str) -> Result<Self, Self::Err> {
        let malformed = || RegionError::Fragment { fragment: fragment.to_owned() };
        let value = fragment.strip_prefix("xywh=").ok_or_else(malformed)?;
        let region = match value.strip_prefix("percent:") {
            Some(percent) => {
                Self::Percent(four(percent).filter(|v| v.iter().all(|v| *v >= 0.0)).ok_or_else(malformed)?)
            }
            None => {
                let pixels = value.strip_prefix("pixel:").unwrap_or(value);
                let [x, y, width, height] = four::<u32>(pixels).ok_or_else(malformed)?;
                Self::Pixels(RectPx { x, y, width, height })
            }
        };
        let empty = match region {
            Self::Pixels(rect) => rect.width == 0 || rect.height == 0,
            Self::Percent([_, _, width, height]) => width == 0.0 || height == 0.0,
        };
        if empty { Err(RegionError::Empty { region: value.to_owned() }) } else { Ok(region) }
    }
}

impl Region {
    /// The region in pixels of a picture of that size; percentages are rounded outward to whole pixels.
    ///
    /// # Errors
    /// When it does not lie wholly inside the picture.
    pub fn in_picture(self, size: SizePx) -> Result<RectPx, RegionError> {
        let rect = match self {
            Self::Pixels(rect) => rect,
            Self::Percent(percent) => pixels_from_percent(percent, size),
        };
        let inside = |start: u32, length: u32, limit: u32| {
            start.checked_add(length).is_some_and(|end| end <= limit && length > 0)
        };
        if inside(rect.x, rect.width, size.width) && inside(rect.y, rect.height, size.height) {
            Ok(rect)
        } else {
            Err(RegionError::Outside { rect, size })
        }
    }
}

fn pixels_from_percent([x, y, width, height]: [f32; 4], size: SizePx) -> RectPx {
    let span = |start: f32, length: f32, whole: u32| {
        let pixels = |percent: f32| f64::from(percent) / 100.0 * f64::from(whole);
        let first = pixels(start).floor() as u32;
        (first, (pixels(start + length).ceil() as u32).saturating_sub(first))
    };
    let ((x, width), (y, height)) = (span(x, width, size.width), span(y, height, size.height));
    RectPx { x, y, width, height }
}

/// Exactly four numbers between commas; not-a-number and infinities are none.
fn four<T: FromStr + Copy + Into<f64>>(text: &str) -> Option<[T; 4]> {
    let numbers: Vec<T> = text.split(',').map(|number| number.trim().parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok().filter(|numbers: &[T; 4]| numbers.iter().all(|&n| n.into().is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const VGA: SizePx = SizePx { width: 640, height: 480 };

    fn region(text: &str) -> Region {
        text.parse().unwrap()
    }

    #[test]
    fn a_picture_with_and_without_a_region() {
        let picture: PictureRegion = "a/f037.jpg#xywh=446,314,25,24".parse().unwrap();
        let rect = RectPx { x: 446, y: 314, width: 25, height: 24 };
        let pixels = Some(Region::Pixels(rect));
        let still = PictureRegion { file: "a/f037.jpg".into(), shown_at: None, region: pixels };
        assert_eq!(picture, still);
        let film: PictureRegion = "a.mp4#t=0.5&xywh=446,314,25,24".parse().unwrap();
        let shown_at = Some(Duration::from_millis(500));
        assert_eq!(film, PictureRegion { file: "a.mp4".into(), shown_at, region: pixels });
        assert_eq!(region("xywh=pixel:446,314,25,24").in_picture(VGA), Ok(rect));
        assert_eq!("a.jpg".parse(), Ok(PictureRegion { file: "a.jpg".into(), shown_at: None, region: None }));
    }

    #[test]
    fn percentages_are_rounded_outward() {
        let rect = RectPx { x: 320, y: 120, width: 65, height: 240 };
        assert_eq!(region("xywh=percent:50,25,10.1,50").in_picture(VGA), Ok(rect));
        assert_eq!(region("xywh=percent:0,0,100,100").in_picture(VGA), Ok(RectPx::whole(VGA)));
    }

    #[test]
    fn what_is_not_a_region_is_refused() {
        for fragment in ["", "t=x", "xywh=1,2,3", "xywh=1,2,3,4,5", "xywh=-1,2,3,4", "xywh=1.5,2,3,4"] {
            assert!(matches!(fragment.parse::<Region>(), Err(RegionError::Fragment { .. })), "{fragment}");
        }
        for fragment in ["xywh=percent:nan,0,1,1", "xywh=percent:0,0,inf,1", "xywh=percent:-1,0,5,5"] {
            assert!(matches!(fragment.parse::<Region>(), Err(RegionError::Fragment { .. })), "{fragment}");
        }
        assert!(matches!("xywh=1,2,0,4".parse::<Region>(), Err(RegionError::Empty { .. })));
        assert!(matches!("#xywh=1,2,3,4".parse::<PictureRegion>(), Err(RegionError::NoFile { .. })));
    }

    #[test]
    fn regions_outside_the_picture_are_refused() {
        for fragment in
            ["xywh=630,0,11,5", "xywh=0,480,1,1", "xywh=4294967295,0,2,2", "xywh=percent:50,50,60,10"]
        {
            let error = region(fragment).in_picture(VGA).unwrap_err();
            assert!(error.to_string().contains("640×480"), "{error}");
        }
    }
}
