//! Frames like those of the thesis's rink, the same ones in every run.

use std::error::Error;
use std::path::Path;

use vision::{ColorStats, Digest, Frame, Landmark, RectPx, ShapeClass, SizePx, WindowPx};

/// Frame sizes that cameras deliver.
pub(crate) const SIZES: [SizePx; 3] = [
    SizePx { width: 640, height: 480 },
    SizePx { width: 1280, height: 720 },
    SizePx { width: 1920, height: 1080 },
];

const RED: [i32; 3] = [202, 71, 33];
const BLUE: [i32; 3] = [51, 60, 82];
const BLACK: [i32; 3] = [38, 36, 40];
const FLOORS: [[i32; 3]; 3] = [[176, 168, 152], [150, 158, 165], [186, 180, 172]];
const WALL: [i32; 3] = [58, 52, 50];

/// Floors of three surfaces, a dark wall above them, and three blocks of a thirteenth of the frame's height.
pub(crate) fn rink(size: SizePx) -> Frame {
    rink_of_blocks(size, size.height / 13)
}

/// The same with blocks `side` pixels wide.
pub(crate) fn rink_of_blocks(size: SizePx, side: u32) -> Frame {
    let mut noise = Noise(0x9E37_79B9_7F4A_7C15);
    let mut rgb = Vec::with_capacity(3 * (size.width * size.height) as usize);
    for (y, x) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (y, x))) {
        let block = |colour, left: u32, top: u32| {
            ((left..left + side).contains(&x) && (top..top + side).contains(&y)).then_some(colour)
        };
        let colour = block(RED, size.width * 7 / 10, size.height * 13 / 20)
            .or(block(BLUE, size.width * 3 / 10, size.height * 2 / 3))
            .or(block(BLACK, size.width / 2, size.height * 3 / 5))
            .unwrap_or(if y < size.height / 4 { WALL } else { FLOORS[(3 * x / size.width) as usize % 3] });
        rgb.extend(colour.map(|level| (level + noise.next()).clamp(0, 255) as u8));
    }
    Frame::from_rgb(size.width, size.height, rgb).expect("three levels for each pixel")
}

/// One colour, with or without noise.
fn flat(size: SizePx, noise_levels: i32) -> Frame {
    let mut noise = Noise(0x2545_F491_4F6C_DD1D);
    let pixels = (size.width * size.height) as usize;
    let level = |level: i32| (level + noise_levels * noise.next() / 12).clamp(0, 255) as u8;
    let rgb = RED.into_iter().cycle().take(3 * pixels).map(level).collect();
    Frame::from_rgb(size.width, size.height, rgb).expect("three levels for each pixel")
}

/// A frame with a red block of that side in its middle, and a gate around it of twice the side.
pub(crate) fn one_block(size: SizePx, side: u32) -> (Frame, RectPx) {
    let mut frame = rink(size);
    let mut noise = Noise(0x2545_F491_4F6C_DD1D);
    let (left, top) = ((size.width - side) / 2, (size.height - side) / 2);
    for (y, x) in (top..top + side).flat_map(|y| (left..left + side).map(move |x| (y, x))) {
        let at = 3 * (y * size.width + x) as usize;
        let pixel = RED.map(|level| (level + noise.next()).clamp(0, 255) as u8);
        frame.rgb_mut()[at..at + 3].copy_from_slice(&pixel);
    }
    let margin = side / 2;
    (frame, RectPx { x: left - margin, y: top - margin, width: 2 * side, height: 2 * side })
}

/// A landmark of these levels, window side and tolerances.
pub(crate) fn landmark(mean: [f32; 3], side: u16, tolerance: ColorStats) -> Landmark {
    Landmark {
        id: "bench".into(),
        revision: 1,
        window_px: WindowPx::square(side),
        shades: vec![ColorStats { mean, variance: [30.0; 3] }],
        tolerance,
        shape: ShapeClass::Block,
        size_m: None,
        digest: Digest::default(),
    }
}

/// The red block, tolerances of Table D.1.
pub(crate) fn red(side: u16) -> Landmark {
    landmark(RED.map(|level| level as f32), side, ColorStats::uniform(15.0, 50.0))
}

/// What landmarks may meet, from nothing to everything; the last without noise.
pub(crate) fn contents(size: SizePx, side: u16) -> [(&'static str, Frame, Landmark); 6] {
    let floor = FLOORS[1].map(|level| level as f32);
    let red = RED.map(|level| level as f32);
    let (usual, wide) = (ColorStats::uniform(15.0, 50.0), ColorStats::uniform(40.0, 150.0));
    [
        ("match", rink(size), landmark(red, side, usual)),
        ("nothing", rink(size), landmark([10.0, 240.0, 10.0], side, usual)),
        ("loose", rink(size), landmark(red, side, wide)),
        ("background", rink(size), landmark(floor, side, usual)),
        ("everything", flat(size, 12), landmark(red, side, wide)),
        ("flat", flat(size, 0), landmark(red, side, usual)),
    ]
}

/// Landmarks of colours spread over the cube.
pub(crate) fn distinct(count: u32) -> Vec<Landmark> {
    let level = |number: u32, step: u32| (250 - 60 * (number / step % 4)) as f32;
    (0..count)
        .map(|number| {
            let mean = [level(number, 1), level(number, 4), level(number, 16)];
            landmark(mean, 12, ColorStats::uniform(15.0, 50.0))
        })
        .collect()
}

/// Landmarks of the colours that a frame has at places spread over it, as if learned there.
pub(crate) fn learned(frame: &Frame, count: u32) -> Vec<Landmark> {
    let SizePx { width, height } = frame.size();
    let place = |number: u32, of_px: u32| (2 * (number % 8) + 1) * of_px / 16;
    let mean = |left: u32, top: u32| {
        let pixels = (top..top + 6).flat_map(|y| (left..left + 6).map(move |x| (x, y)));
        let sum = pixels.fold([0.0; 3], |sum: [f32; 3], (x, y)| {
            let levels = frame.pixel(x, y);
            [0, 1, 2].map(|channel| sum[channel] + f32::from(levels[channel]))
        });
        sum.map(|sum| sum / 36.0)
    };
    let landmark_at = |number| mean(place(number, width - 6), place(number / 8, height - 6));
    (0..count).map(|number| landmark(landmark_at(number), 12, ColorStats::uniform(15.0, 50.0))).collect()
}

/// The sum of three small random numbers, ±12: near enough to a camera's noise.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> i32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (0..3).map(|draw| (self.0 >> (40 + 8 * draw)) as i32 % 9 - 4).sum()
    }
}

/// The arguments that select figures. With `--frames DIRECTORY` the frames are written there as well.
pub(crate) fn arguments() -> Result<Vec<String>, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let (options, filters): (Vec<_>, Vec<_>) = arguments.chunks(2).partition(|pair| pair[0] == "--frames");
    if let Some([_, directory]) = options.first() {
        write_frames(Path::new(directory))?;
    }
    Ok(filters.concat())
}

#[allow(clippy::disallowed_methods, reason = "frames for the other program")]
fn write_frames(directory: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(directory)?;
    for size in SIZES {
        let SizePx { width, height } = size;
        std::fs::write(directory.join(format!("rink-{width}x{height}.rgb")), rink(size).rgb())?;
    }
    Ok(())
}
