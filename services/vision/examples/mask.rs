//! Writes the mask of six given statistics, one byte 0 or 1 a window position, for comparison with other programs.
//!
//! `mask PICTURE MEAN_R,MEAN_G,MEAN_B VARIANCE_R,VARIANCE_G,VARIANCE_B WIDTH,HEIGHT MEAN_TOLERANCE,VARIANCE_TOLERANCE OUT`
#![allow(clippy::disallowed_methods, reason = "a tool for developers: it reads and writes files")]

use std::error::Error;

use vision::doubled_grid::DoubledGrid;
use vision::frame::decode::{DecodeLimits, decode};
use vision::mask::Masker;
use vision::{BitMask, ColorStats, Digest, Landmark, NoProbe, RectPx, ShapeClass, WindowPx};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [picture, mean, variance, window, tolerance, out] = arguments.as_slice() else {
        return Err("usage: mask PICTURE R,G,B R,G,B WIDTH,HEIGHT MEAN,VARIANCE OUT".into());
    };
    let [width, height] = numbers(window)?;
    let [mean_tolerance, variance_tolerance] = numbers(tolerance)?;
    let landmark = Landmark {
        id: "given".into(),
        revision: 1,
        window_px: WindowPx { width: width as u16, height: height as u16 },
        shades: vec![ColorStats { mean: numbers(mean)?, variance: numbers(variance)? }],
        tolerance: ColorStats::uniform(mean_tolerance, variance_tolerance),
        shape: ShapeClass::Any,
        size_m: None,
        digest: Digest::default(),
    };
    let frame = decode(&std::fs::read(picture)?, &DecodeLimits::default())?;
    let grid = DoubledGrid::new(RectPx::whole(frame.size()), landmark.window_px)
        .ok_or("the window is larger than the picture")?;
    let mut mask = BitMask::default();
    Masker::default().find(&frame, &grid, &landmark, &mut mask, &mut NoProbe);
    let pixels = (0..mask.height()).flat_map(|y| (0..mask.width()).map(move |x| (x, y)));
    let bytes: Vec<u8> = pixels.map(|(x, y)| u8::from(mask.get(x, y))).collect();
    Ok(std::fs::write(out, bytes)?)
}

fn numbers<const N: usize>(text: &str) -> Result<[f32; N], Box<dyn Error>> {
    let numbers = text.split(',').map(str::parse).collect::<Result<Vec<f32>, _>>()?;
    numbers.try_into().map_err(|_| format!("`{text}` is not {N} numbers separated by commas").into())
}
