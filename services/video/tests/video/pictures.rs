//! Pictures that move.

use video::{EncoderOptions, Quantizer, StreamEncoder};
use vision::Frame;

/// A coloured square that moves over a shaded background; its number can be read from its place.
pub(crate) fn moving(width: u32, height: u32, number: u32) -> Frame {
    let left = 8 + number * 3 % (width - 40);
    let rgb = (0..height)
        .flat_map(|y| {
            (0..width).flat_map(move |x| {
                let inside = (left..left + 24).contains(&x) && (8..32).contains(&y);
                if inside { [200, 40, 30] } else { [90 + (x / 8 % 32) as u8, 110, 80 + (y / 8 % 32) as u8] }
            })
        })
        .collect();
    Frame::from_rgb(width, height, rgb).unwrap()
}

/// The first column of the square.
pub(crate) fn square_left(frame: &Frame) -> u32 {
    (0..frame.width()).find(|&x| frame.pixel(x, 20)[0] > 160).unwrap()
}

/// Mean absolute difference of two frames, levels.
pub(crate) fn difference(a: &Frame, b: &Frame) -> f64 {
    assert_eq!(a.size(), b.size());
    let sum: u64 = a.rgb().iter().zip(b.rgb()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.rgb().len() as f64
}

pub(crate) const OPTIONS: EncoderOptions =
    EncoderOptions { quantizer: Quantizer::new(24).unwrap(), keyframe_interval: 8 };

/// Messages of a stream of `count` moving pictures.
pub(crate) fn stream(count: u32) -> Vec<Vec<u8>> {
    let mut encoder = StreamEncoder::new(OPTIONS).unwrap();
    (0..count).map(|number| encoder.encode(&moving(160, 96, number)).unwrap().bytes).collect()
}
