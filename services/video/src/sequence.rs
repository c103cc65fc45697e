//! What a sequence parameter set says of its pictures, read before the codec sees it (ITU-T H.264, clause 7.3.2.1.1).

use vision::SizePx;
use vision::frame::decode::DecodeLimits;

use crate::bits::BitReader;
use crate::error::VideoError;

/// The most macroblocks that a decoder keeps: `MaxDpbMbs` of level 5.2 (Table A-1), 68 MiB of pictures.
const MAX_KEPT_MACROBLOCKS: u64 = 184_320;

/// The most macroblocks of one picture: `MaxFS` of level 5.2.
const MAX_MACROBLOCKS: u64 = 36_864;

const DECODABLE: &str = "progressive 8-bit 4:2:0 up to level 5.2 is decoded";

/// How luma and chroma become red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColourCoding {
    /// Which weights.
    pub matrix: ColourMatrix,
    /// Which levels mean black and white.
    pub range: LevelRange,
}

/// Weights of red, green and blue in luma.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMatrix {
    /// ITU-R BT.601: standard definition, and JPEG.
    Bt601,
    /// ITU-R BT.709: high definition.
    Bt709,
}

/// Which levels mean black and white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LevelRange {
    /// Luma 16 to 235, chroma 16 to 240.
    Limited,
    /// 0 to 255.
    Full,
}

/// What a sequence parameter set says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sequence {
    /// Size of the coded pictures, before cropping.
    pub coded: SizePx,
    /// How colours are coded.
    pub colour: ColourCoding,
    /// `profile_idc`, the constraint flags, `level_idc`.
    pub profile: [u8; 3],
}

impl Sequence {
    /// Reads a sequence parameter set, NAL header included, and judges whether it can and may be decoded.
    ///
    /// # Errors
    /// When it is damaged, of a kind that the codec does not decode, or claims more than `limits`.
    pub fn read(nal: &[u8], limits: &DecodeLimits) -> Result<Self, VideoError> {
        let cut = || VideoError::damaged("a sequence parameter set ends early");
        let fields = Fields::read(nal.get(1..).unwrap_or_default()).ok_or_else(cut)?;
        fields.judge(limits)
    }
}

/// The fields that matter, as they stand.
struct Fields {
    profile: [u8; 3],
    chroma_format: u32,
    bit_depths: [u32; 2],
    kept_pictures: u32,
    width_macroblocks: u64,
    height_map_units: u64,
    frames_only: bool,
    full_range: bool,
    matrix: Option<u32>,
}

impl Fields {
    fn read(payload: &[u8]) -> Option<Self> {
        let mut bits = BitReader::new(payload);
        let profile = [bits.bits(8)? as u8, bits.bits(8)? as u8, bits.bits(8)? as u8];
        let _id = bits.unsigned()?;
        let (mut chroma_format, mut bit_depths) = (1, [8, 8]);
        if HIGH_PROFILES.contains(&profile[0]) {
            (chroma_format, bit_depths) = read_high_profile(&mut bits)?;
        }
        let _log2_max_frame_num = bits.unsigned()?;
        skip_picture_order(&mut bits)?;
        let kept_pictures = bits.unsigned()?;
        let _gaps_allowed = bits.bit()?;
        let width_macroblocks = u64::from(bits.unsigned()?) + 1;
        let height_map_units = u64::from(bits.unsigned()?) + 1;
        let frames_only = bits.bit()?;
        if !frames_only {
            let _adaptive = bits.bit()?;
        }
        let _direct_8x8 = bits.bit()?;
        if bits.bit()? {
            for _ in 0..4 {
                let _crop = bits.unsigned()?;
            }
        }
        // Everything from here on is optional, and a stream that ends here says nothing of its colours.
        let (full_range, matrix) = read_colours(&mut bits).unwrap_or((false, None));
        Some(Self {
            profile,
            chroma_format,
            bit_depths,
            kept_pictures,
            width_macroblocks,
            height_map_units,
            frames_only,
            full_range,
            matrix,
        })
    }

    fn judge(&self, limits: &DecodeLimits) -> Result<Sequence, VideoError> {
        let unsupported = |what: String| VideoError::Unsupported { what, allowed: DECODABLE };
        let pixels = |macroblocks: u64| u32::try_from(16 * macroblocks).unwrap_or(u32::MAX);
        let coded = SizePx {
            width: pixels(self.width_macroblocks),
            height: pixels(self.height_map_units * if self.frames_only { 1 } else { 2 }),
        };
        let macroblocks = self.width_macroblocks.saturating_mul(self.height_map_units);
        let in_all = u64::from(coded.width) * u64::from(coded.height);
        if coded.width.max(coded.height) > limits.max_side_px.next_multiple_of(16)
            || in_all > limits.max_pixels
            || macroblocks > MAX_MACROBLOCKS
        {
            return Err(VideoError::TooLarge { width: coded.width, height: coded.height, limits: *limits });
        }
        if !self.frames_only {
            return Err(unsupported("interlaced pictures".to_owned()));
        }
        if self.chroma_format != 1 || self.bit_depths != [8, 8] {
            let [luma, chroma] = self.bit_depths;
            return Err(unsupported(format!(
                "chroma format {} with {luma} and {chroma} bits",
                self.chroma_format
            )));
        }
        if self.kept_pictures > 16 || macroblocks * u64::from(self.kept_pictures) > MAX_KEPT_MACROBLOCKS {
            return Err(unsupported(format!("{} reference pictures of its size", self.kept_pictures)));
        }
        Ok(Sequence { coded, colour: self.colour(coded), profile: self.profile })
    }

    /// What the stream says, or what is usual for its size.
    fn colour(&self, coded: SizePx) -> ColourCoding {
        let matrix = match self.matrix {
            Some(1) => ColourMatrix::Bt709,
            Some(4..=7) => ColourMatrix::Bt601,
            _ if coded.height >= 720 => ColourMatrix::Bt709,
            _ => ColourMatrix::Bt601,
        };
        ColourCoding { matrix, range: if self.full_range { LevelRange::Full } else { LevelRange::Limited } }
    }
}

/// Values of `profile_idc` whose sets say more of the samples.
const HIGH_PROFILES: [u8; 13] = [100, 110, 122, 244, 44, 83, 86, 118, 128, 138, 139, 134, 135];

/// Chroma format and bit depths of luma and chroma.
fn read_high_profile(bits: &mut BitReader<'_>) -> Option<(u32, [u32; 2])> {
    let chroma_format = bits.unsigned()?;
    if chroma_format == 3 {
        let _separate_planes = bits.bit()?;
    }
    let depths = [bits.unsigned()?.checked_add(8)?, bits.unsigned()?.checked_add(8)?];
    let _lossless = bits.bit()?;
    if bits.bit()? {
        for list in 0..if chroma_format == 3 { 12 } else { 8 } {
            if bits.bit()? {
                skip_scaling_list(bits, if list < 6 { 16 } else { 64 })?;
            }
        }
    }
    Some((chroma_format, depths))
}

/// Clause 7.3.2.1.1.1.
fn skip_scaling_list(bits: &mut BitReader<'_>, size: u32) -> Option<()> {
    let (mut last, mut next) = (8_i64, 8_i64);
    for _ in 0..size {
        if next != 0 {
            next = (last + bits.signed()?).rem_euclid(256);
        }
        last = if next == 0 { last } else { next };
    }
    Some(())
}

fn skip_picture_order(bits: &mut BitReader<'_>) -> Option<()> {
    match bits.unsigned()? {
        0 => {
            let _log2_max = bits.unsigned()?;
        }
        1 => {
            let _always_zero = bits.bit()?;
            let (_non_reference, _bottom) = (bits.signed()?, bits.signed()?);
            for _ in 0..bits.unsigned()?.min(255) {
                let _reference = bits.signed()?;
            }
        }
        _ => {}
    }
    Some(())
}

/// `video_full_range_flag` and `matrix_coefficients` of the usability information (Annex E), where there is one.
fn read_colours(bits: &mut BitReader<'_>) -> Option<(bool, Option<u32>)> {
    if !bits.bit()? {
        return None;
    }
    // Aspect ratio, with an extended form.
    if bits.bit()? && bits.bits(8)? == 255 {
        let _ratio = bits.bits(32)?;
    }
    // Overscan.
    if bits.bit()? {
        let _appropriate = bits.bit()?;
    }
    if !bits.bit()? {
        return None;
    }
    let _format = bits.bits(3)?;
    let full_range = bits.bit()?;
    if !bits.bit()? {
        return Some((full_range, None));
    }
    let (_primaries, _transfer) = (bits.bits(8)?, bits.bits(8)?);
    Some((full_range, bits.bits(8)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// 1280×720, high profile, one reference picture, BT.709 limited: of an encoder that is not ours.
    const HD: [u8; 27] = [
        0x67, 100, 0, 31, 172, 217, 64, 80, 5, 187, 1, 106, 2, 2, 2, 128, 0, 1, 244, 128, 0, 117, 48, 7, 140,
        24, 203,
    ];

    #[test]
    fn a_set_of_another_encoder_is_read() {
        let sequence = Sequence::read(&HD, &DecodeLimits::default()).unwrap();
        assert_eq!(sequence.coded, SizePx { width: 1280, height: 720 });
        let colour = ColourCoding { matrix: ColourMatrix::Bt709, range: LevelRange::Limited };
        assert_eq!((sequence.colour, sequence.profile), (colour, [100, 0, 31]));
    }

    #[test]
    fn more_than_the_limit_is_refused() {
        let limits = DecodeLimits { max_side_px: 640, max_pixels: 1 << 20 };
        let error = Sequence::read(&HD, &limits).unwrap_err();
        assert!(error.to_string().contains("1280×720"), "{error}");
        let error = Sequence::read(&claiming(50_000), &DecodeLimits::default()).unwrap_err();
        assert!(matches!(error, VideoError::TooLarge { .. }), "{error}");
    }

    /// A baseline set whose pictures have that many macroblocks a side.
    fn claiming(macroblocks: u32) -> Vec<u8> {
        let mut bits = vec![];
        let mut unsigned = |value: u32| {
            let width = 32 - (value + 1).leading_zeros();
            bits.extend(std::iter::repeat_n(0, width as usize - 1));
            bits.extend((0..width).rev().map(|at| (value + 1) >> at & 1));
        };
        // id, frame number, picture order type 2, references, and the size.
        [0, 0, 2, 1].into_iter().for_each(&mut unsigned);
        bits.push(0);
        let mut unsigned = |value: u32| {
            let width = 32 - (value + 1).leading_zeros();
            bits.extend(std::iter::repeat_n(0, width as usize - 1));
            bits.extend((0..width).rev().map(|at| (value + 1) >> at & 1));
        };
        [macroblocks - 1, macroblocks - 1].into_iter().for_each(&mut unsigned);
        bits.extend([1, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
        let payload = bits.chunks(8).map(|byte| byte.iter().fold(0, |value, bit| value << 1 | *bit as u8));
        [0x67, 66, 0, 40].into_iter().chain(payload).collect()
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(mut bytes in proptest::collection::vec(any::<u8>(), 0..80), high: bool) {
            bytes.splice(0..0, if high { [0x67, 100] } else { [0x67, 66] });
            let _ = Sequence::read(&bytes, &DecodeLimits::default());
        }

        #[test]
        fn cut_and_changed_sets_are_read_or_refused(at in 0..HD.len(), value: u8, length in 0..HD.len()) {
            let mut bytes = HD;
            bytes[at] = value;
            let _ = Sequence::read(&bytes[..length], &DecodeLimits::default());
        }
    }
}
