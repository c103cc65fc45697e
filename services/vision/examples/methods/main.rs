//! Writes what every method of `vision::methods` makes of two pictures, as NumPy arrays, for comparison with other programs.
//!
//! `methods FIRST SECOND DIRECTORY`; `tests/python/methods_peer.py` says which parameters the names stand for.
#![allow(clippy::disallowed_methods, reason = "a tool for developers: it reads and writes files")]

mod npy;

use std::error::Error;
use std::num::NonZeroU16;

use npy::Folder;
use vision::frame::decode::{DecodeLimits, decode};
use vision::methods::control_points::ControlPoint;
use vision::methods::convolve::FourierConvolution;
use vision::methods::hough::Peaks;
use vision::methods::low_pass::{gaussian, low_pass};
use vision::methods::{
    BilinearMap, Border, Canny, Colours, Extent, HornSchunck, HoughTransform, Intensity, Interpolation, Ncc,
    NccOptions, Operator, PhaseCorrelator, Plane, Shift, Taper, convolve, gradient, median,
};
use vision::{Frame, PointPx, RectPx, SizePx};

/// What the template is cut from.
const TEMPLATE: RectPx = RectPx { x: 301, y: 207, width: 24, height: 20 };

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [first, second, directory] = arguments.as_slice() else {
        return Err("usage: methods FIRST SECOND DIRECTORY".into());
    };
    let read = |path: &String| -> Result<Frame, Box<dyn Error>> {
        Ok(decode(&std::fs::read(path)?, &DecodeLimits::default())?)
    };
    let (first, second, folder) = (read(first)?, read(second)?, Folder::new(directory)?);
    let plane = Plane::of(&first, Intensity::Luma);
    folder.write("luma", &plane)?;
    folder.write("magnitude", &Plane::of(&first, Intensity::Magnitude))?;
    filters(&folder, &plane)?;
    resolutions(&folder, &plane)?;
    convolutions(&folder, &plane)?;
    edges_and_lines(&folder, &plane)?;
    control_points(&folder, &plane)?;
    shifts(&folder, &plane)?;
    correlation(&folder, &first)?;
    let flow = HornSchunck::default().flow(&plane, &Plane::of(&second, Intensity::Luma))?;
    folder.write("flow-u", &flow.u)?;
    folder.write("flow-v", &flow.v)?;
    Ok(())
}

fn side(pixels: u16) -> NonZeroU16 {
    NonZeroU16::new(pixels).unwrap_or(NonZeroU16::MIN)
}

fn filters(folder: &Folder, plane: &Plane) -> Result<(), Box<dyn Error>> {
    folder.write("low-pass-5x4", &low_pass(plane, side(5), side(4), Border::Nearest))?;
    folder.write("low-pass-3x3-mirror", &low_pass(plane, side(3), side(3), Border::Mirror))?;
    folder.write("gaussian-1.5", &gaussian(plane, 1.5, Border::Nearest))?;
    folder.write("median-3x3", &median(plane, side(3), side(3), Border::Nearest))?;
    folder.write("median-2x2", &median(plane, side(2), side(2), Border::Nearest))
}

fn resolutions(folder: &Folder, plane: &Plane) -> Result<(), Box<dyn Error>> {
    let names = [Interpolation::Nearest, Interpolation::Bilinear, Interpolation::Bicubic];
    for (method, name) in names.into_iter().zip(["nearest", "bilinear", "bicubic"]) {
        for (width, height) in [(2 * plane.width(), 2 * plane.height()), (512, 384)] {
            let resized = method.resized(plane, SizePx { width, height });
            folder.write(&format!("{name}-{width}x{height}"), &resized)?;
        }
    }
    Ok(())
}

fn convolutions(folder: &Folder, plane: &Plane) -> Result<(), Box<dyn Error>> {
    let kernel = Plane::from_fn(SizePx { width: 6, height: 5 }, |x, y| ((3 * x + 7 * y) % 11) as f32 - 4.0);
    let extents = [Extent::Full, Extent::Same, Extent::Valid];
    for (extent, name) in extents.into_iter().zip(["full", "same", "valid"]) {
        folder.write(&format!("convolution-{name}"), &convolve(plane, &kernel, extent))?;
        let mut fourier = FourierConvolution::new(&kernel, plane.size(), extent)?;
        folder.write(&format!("convolution-fourier-{name}"), &fourier.apply(plane))?;
    }
    Ok(())
}

fn edges_and_lines(folder: &Folder, plane: &Plane) -> Result<(), Box<dyn Error>> {
    let operators = [Operator::Sobel, Operator::Prewitt, Operator::Roberts];
    for (operator, name) in operators.into_iter().zip(["sobel", "prewitt", "roberts"]) {
        let slope = gradient(plane, operator, Border::Nearest);
        folder.write(&format!("{name}-x"), &slope.x)?;
        folder.write(&format!("{name}-y"), &slope.y)?;
        folder.write(&format!("{name}-magnitude"), &slope.magnitude())?;
    }
    let edges = Canny { sigma_px: 0.0, weak: 60.0, strong: 150.0 }.edges(plane);
    folder.write("canny", &Plane::from_fn(plane.size(), |x, y| u8::from(edges.get(x, y)).into()))?;
    let votes = HoughTransform::default().votes(&edges);
    folder.write("hough-votes", &votes.plane())?;
    let lines = votes.lines(&Peaks { least_votes: 60, most_lines: 12, ..Peaks::default() });
    let table = |x: u32, y: u32| {
        let line = lines[y as usize];
        [line.rho_px, line.theta_rad, line.votes as f32][x as usize]
    };
    folder.write("hough-lines", &Plane::from_fn(SizePx { width: 3, height: lines.len() as u32 }, table))
}

fn control_points(folder: &Folder, plane: &Plane) -> Result<(), Box<dyn Error>> {
    let from = [(10.0, 12.0), (600.0, 30.0), (25.0, 450.0), (620.0, 470.0), (300.0, 240.0), (100.0, 400.0)];
    let to = [(14.5, 10.0), (590.0, 41.0), (31.0, 437.0), (633.0, 460.0), (308.0, 236.5), (107.0, 391.0)];
    let point = |(x, y): (f32, f32)| PointPx::new(x, y);
    let pairs: Vec<_> = from
        .into_iter()
        .zip(to)
        .map(|(from, to)| ControlPoint { from: point(from), to: point(to) })
        .collect();
    let map = BilinearMap::fit(&pairs)?;
    let coefficients = [map.x, map.y];
    let size = SizePx { width: 4, height: 2 };
    folder
        .write("control-points", &Plane::from_fn(size, |x, y| coefficients[y as usize][x as usize] as f32))?;
    folder.write("warped", &map.warp(plane, plane.size(), Interpolation::Bilinear, Border::Nearest))
}

/// Shifts between parts of one picture whose truth is known: whole pixels, and half pixels where each pixel is the mean of
/// two by two and the part begins at an odd one.
fn shifts(folder: &Folder, plane: &Plane) -> Result<(), Box<dyn Error>> {
    let mut rows: Vec<[f32; 5]> = Vec::new();
    for (dx, dy) in [(0, 0), (7, -4), (-13, 9), (1, 0), (25, 17)] {
        let cut = |x: i32, y: i32| {
            plane.cropped(RectPx { x: (60 + x) as u32, y: (60 + y) as u32, width: 256, height: 200 })
        };
        // What lies at (60, 60) of the picture lies dx further to the right in the second part.
        rows.push(row((dx as f32, dy as f32), shift(&cut(0, 0), &cut(-dx, -dy))?));
    }
    for (dx, dy) in [(1, 0), (0, 1), (1, 1), (-3, 5), (7, -2), (-1, -1)] {
        let size = SizePx { width: 240, height: 180 };
        let halved = |left: i32, top: i32| {
            Plane::from_fn(size, |x, y| {
                let at = |x: u32, y: u32| plane.get((20 + left) as u32 + x, (20 + top) as u32 + y);
                let (x, y) = (2 * x, 2 * y);
                (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0
            })
        };
        rows.push(row((dx as f32 / 2.0, dy as f32 / 2.0), shift(&halved(0, 0), &halved(-dx, -dy))?));
    }
    let table =
        Plane::from_fn(SizePx { width: 5, height: rows.len() as u32 }, |x, y| rows[y as usize][x as usize]);
    folder.write("shifts", &table)
}

fn shift(first: &Plane, second: &Plane) -> Result<Shift, Box<dyn Error>> {
    Ok(PhaseCorrelator::new(first.size(), Taper::Hann)?.shift(first, second)?)
}

fn row((dx, dy): (f32, f32), shift: Shift) -> [f32; 5] {
    [dx, dy, shift.dx_px, shift.dy_px, shift.peak]
}

fn correlation(folder: &Folder, frame: &Frame) -> Result<(), Box<dyn Error>> {
    let rows = TEMPLATE.y..TEMPLATE.y + TEMPLATE.height;
    let pixels = rows.flat_map(|y| &frame.row(y)[3 * TEMPLATE.x as usize..][..3 * TEMPLATE.width as usize]);
    let template = Frame::from_rgb(TEMPLATE.width, TEMPLATE.height, pixels.copied().collect())?;
    for (colours, name) in [(Colours::Grey, "grey"), (Colours::Rgb, "rgb")] {
        let mut ncc = Ncc::new(&template, &NccOptions { colours, ..NccOptions::default() })?;
        folder.write(&format!("ncc-{name}"), ncc.surface(frame, None))?;
        let found = ncc.search(frame, None).ok_or("the template does not fit the picture")?;
        let at = [found.window.x as f32, found.window.y as f32, found.score];
        folder.write(&format!("ncc-{name}-match"), &Plane::new(3, 1, at.to_vec())?)?;
    }
    Ok(())
}
