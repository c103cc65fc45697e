//! Sixty-four neighbouring pixels at a time, for whatever vector instructions the caller is compiled for.
//!
//! Loops go by index and over arrays of fixed size: iterators' closures are not compiled for the instructions of the
//! caller.

use crate::bitmask::lowest_bits;

/// Pixels in a word.
pub(crate) const WORD_PX: usize = 64;

/// Levels of up to 64 pixels, channel by channel; those that are missing are black.
#[inline(always)]
pub(crate) fn split(rgb: &[u8]) -> [[f32; WORD_PX]; 3] {
    let padded: [u8; 3 * WORD_PX];
    let pixels = match rgb.first_chunk() {
        Some(pixels) => pixels,
        None => {
            let mut bytes = [0; 3 * WORD_PX];
            bytes[..rgb.len()].copy_from_slice(rgb);
            padded = bytes;
            &padded
        }
    };
    // Split as bytes first: for that the compiler has instructions.
    let mut planes = [[0_u8; WORD_PX]; 3];
    for at in 0..WORD_PX {
        planes[0][at] = pixels[3 * at];
        planes[1][at] = pixels[3 * at + 1];
        planes[2][at] = pixels[3 * at + 2];
    }
    let mut levels = [[0.0; WORD_PX]; 3];
    for channel in 0..3 {
        for at in 0..WORD_PX {
            levels[channel][at] = planes[channel][at] as f32;
        }
    }
    levels
}

/// The lowest bits of 64 bytes, the first one's lowest.
#[inline(always)]
pub(crate) fn packed(found: &[u8; WORD_PX]) -> u64 {
    let mut bits = 0;
    for at in 0..WORD_PX / 8 {
        let mut eight = [0; 8];
        eight.copy_from_slice(&found[8 * at..8 * at + 8]);
        bits |= lowest_bits(eight) << (8 * at);
    }
    bits
}

/// The bits of the pixels that are there.
#[inline(always)]
pub(crate) fn existing(rgb: &[u8]) -> u64 {
    if rgb.len() >= 3 * WORD_PX { u64::MAX } else { (1 << (rgb.len() / 3)) - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_pixel_and_every_bit_is_in_its_place(
            rgb in prop::collection::vec(any::<u8>(), 0..=192), found in prop::array::uniform32(0u8..2),
        ) {
            let pixels = &rgb[..rgb.len() / 3 * 3];
            let levels = split(pixels);
            let black = std::iter::repeat(&[0; 3]);
            for (at, pixel) in pixels.as_chunks::<3>().0.iter().chain(black).take(WORD_PX).enumerate() {
                prop_assert!((0..3).all(|c| levels[c][at] == f32::from(pixel[c])));
                prop_assert_eq!(existing(pixels) >> at & 1 == 1, 3 * at < pixels.len());
            }
            let mut flags = [0; WORD_PX];
            flags[16..48].copy_from_slice(&found);
            prop_assert!((0..WORD_PX).all(|at| packed(&flags) >> at & 1 == u64::from(flags[at])));
        }
    }
}
