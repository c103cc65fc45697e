//! `cargo bench -p vision --bench methods`: what the thesis's other methods cost, as tab-separated lines
//! `method, variant, width, height, microseconds`. `tests/bench-methods` puts the peers in Python beside it.
//!
//! Thread CPU time; every figure is measured in several rounds over all figures, and the smallest counts. An argument selects
//! figures whose line contains it; `--frames DIRECTORY` writes the frames as raw RGB for other programs.
#![allow(missing_docs, reason = "a program")]
#![allow(dead_code, reason = "the scenes and the clock are shared with other benches")]
#![allow(clippy::print_stdout, reason = "its figures are its product")]

#[path = "figures/clock.rs"]
mod clock;
#[path = "scene/mod.rs"]
mod scene;

use std::error::Error;
use std::hint::black_box;
use std::num::NonZeroU16;
use std::rc::Rc;

use clock::Rounds;
use image::GrayImage;
use vision::methods::convolve::FourierConvolution;
use vision::methods::horn_schunck::Memory;
use vision::methods::low_pass::{gaussian, low_pass};
use vision::methods::{
    Border, Canny, Colours, Extent, Flow, HornSchunck, HoughTransform, Intensity, Interpolation, Ncc,
    NccOptions, Operator, PhaseCorrelator, Plane, Taper, convolve, gradient, median,
};
use vision::{Frame, RectPx, SizePx};

/// Where templates are cut: on the border between two floors and a block.
const TEMPLATE_AT: (u32, u32) = (300, 200);

fn main() -> Result<(), Box<dyn Error>> {
    let filters = scene::arguments()?;
    let wanted = |line: &str| filters.iter().all(|part| line.contains(part.as_str()));
    let mut subjects = Subjects { rounds: Rounds::default(), wanted: &wanted };
    for size in scene::SIZES {
        let frame = Rc::new(scene::rink(size));
        let plane = Rc::new(Plane::of(&frame, Intensity::Luma));
        subjects.registration(&frame);
        subjects.shifts_and_flow(&plane);
        if size == scene::SIZES[0] {
            subjects.filters(&plane);
            subjects.edges(&plane);
            subjects.imageproc(&plane);
        }
    }
    for (line, smallest_us) in subjects.rounds.measure() {
        println!("{line}\t{smallest_us:.2}");
    }
    Ok(())
}

/// What is measured.
struct Subjects<'w> {
    rounds: Rounds<'w>,
    wanted: &'w dyn Fn(&str) -> bool,
}

impl<'w> Subjects<'w> {
    fn add(&mut self, method: &str, variant: &str, size: SizePx, run: impl FnMut() + 'w) {
        let line = format!("{method}\t{variant}\t{}\t{}", size.width, size.height);
        if (self.wanted)(&line) {
            self.rounds.add(line, run);
        }
    }

    fn registration(&mut self, frame: &Rc<Frame>) {
        let one = || vec![1.0];
        let several = || (0..8_u8).map(|step| 0.7 * 1.12_f32.powi(step.into())).collect();
        let gate = RectPx { x: TEMPLATE_AT.0 - 36, y: TEMPLATE_AT.1 - 36, width: 96, height: 96 };
        for (variant, colours, side, scales, region) in [
            ("grey 24 px", Colours::Grey, 24, one(), None),
            ("grey 48 px", Colours::Grey, 48, one(), None),
            ("rgb 24 px", Colours::Rgb, 24, one(), None),
            ("grey 24 px, 8 scales", Colours::Grey, 24, several(), None),
            ("grey 24 px, gate 96 px", Colours::Grey, 24, one(), Some(gate)),
        ] {
            let template = cut(frame, side);
            let mut ncc =
                Ncc::new(&template, &NccOptions { colours, scales }).expect("a template with structure");
            let frame = Rc::clone(frame);
            self.add("ncc", variant, frame.size(), move || {
                black_box(ncc.search(black_box(&frame), region));
            });
        }
    }

    fn shifts_and_flow(&mut self, plane: &Rc<Plane>) {
        let size = plane.size();
        let moved = Rc::new(Plane::from_fn(size, |x, y| plane.get((x + 1) % size.width, y)));
        let mut correlator = PhaseCorrelator::new(size, Taper::Hann).expect("pixels");
        let (first, second) = (Rc::clone(plane), Rc::clone(&moved));
        self.add("phase correlation", "Hann", size, move || {
            black_box(correlator.shift(&first, &second).expect("one size"));
        });
        let (first, mut flow, mut memory) = (Rc::clone(plane), Flow::default(), Memory::default());
        self.add("Horn-Schunck", "100 iterations", size, move || {
            let method = HornSchunck { alpha: 15.0, iterations: 100 };
            method.flow_into(&first, &moved, &mut flow, &mut memory).expect("one size");
        });
    }

    fn filters(&mut self, plane: &Rc<Plane>) {
        let side = |side| NonZeroU16::new(side).expect("not 0");
        let size = plane.size();
        let mut each = |method, variant, run: fn(&Plane)| {
            let plane = Rc::clone(plane);
            self.add(method, variant, size, move || run(black_box(&plane)));
        };
        each("gaussian", "sigma 1.5", |plane| drop(black_box(gaussian(plane, 1.5, Border::Nearest))));
        each("bicubic", "doubled", |plane| {
            let doubled = SizePx { width: 2 * plane.width(), height: 2 * plane.height() };
            black_box(Interpolation::Bicubic.resized(plane, doubled));
        });
        let low = Rc::clone(plane);
        self.add("low-pass", "5x5", size, move || {
            drop(black_box(low_pass(&low, side(5), side(5), Border::Nearest)))
        });
        let middle = Rc::clone(plane);
        self.add("median", "3x3", size, move || {
            drop(black_box(median(&middle, side(3), side(3), Border::Nearest)))
        });
        let kernel = Plane::from_fn(SizePx { width: 31, height: 31 }, |x, y| (x * y % 7) as f32);
        let mut fourier = FourierConvolution::new(&kernel, size, Extent::Same).expect("pixels");
        let (space, frequency) = (Rc::clone(plane), Rc::clone(plane));
        self.add("convolution 31x31", "in space", size, move || {
            drop(black_box(convolve(&space, &kernel, Extent::Same)))
        });
        self.add("convolution 31x31", "by Fourier", size, move || drop(black_box(fourier.apply(&frequency))));
    }

    fn edges(&mut self, plane: &Rc<Plane>) {
        let size = plane.size();
        let slope = Rc::clone(plane);
        self.add("Sobel", "magnitude", size, move || {
            black_box(gradient(&slope, Operator::Sobel, Border::Nearest).magnitude());
        });
        let canny = Canny { sigma_px: 0.0, weak: 60.0, strong: 150.0 };
        let edges = canny.edges(plane);
        let plane = Rc::clone(plane);
        self.add("Canny", "60, 150", size, move || drop(black_box(canny.edges(&plane))));
        self.add("Hough", "votes, half degrees", size, move || {
            drop(black_box(HoughTransform::default().votes(&edges)))
        });
    }

    /// The same with `imageproc`.
    fn imageproc(&mut self, plane: &Plane) {
        let size = plane.size();
        let levels = plane.values().iter().map(|&level| level as u8).collect();
        let grey = Rc::new(GrayImage::from_raw(size.width, size.height, levels).expect("a level a pixel"));
        let mut each = |method, variant, run: fn(&GrayImage)| {
            let grey = Rc::clone(&grey);
            self.add(method, variant, size, move || run(black_box(&grey)));
        };
        each("gaussian", "imageproc", |grey| {
            drop(black_box(imageproc::filter::gaussian_blur_f32(grey, 1.5)))
        });
        each("low-pass", "imageproc", |grey| drop(black_box(imageproc::filter::box_filter(grey, 2, 2))));
        each("median", "imageproc", |grey| drop(black_box(imageproc::filter::median_filter(grey, 1, 1))));
        each("Canny", "imageproc", |grey| drop(black_box(imageproc::edges::canny(grey, 60.0, 150.0))));
        each("Sobel", "imageproc", |grey| drop(black_box(imageproc::gradients::sobel_gradients(grey))));
        each("ncc", "imageproc, grey 24 px", |grey| {
            let (x, y) = TEMPLATE_AT;
            let template = image::imageops::crop_imm(grey, x, y, 24, 24).to_image();
            let method = imageproc::template_matching::MatchTemplateMethod::CrossCorrelationNormalized;
            black_box(imageproc::template_matching::match_template(grey, &template, method));
        });
    }
}

fn cut(frame: &Frame, side: u32) -> Frame {
    let (x, y) = TEMPLATE_AT;
    let rows = (y..y + side).flat_map(|y| &frame.row(y)[3 * x as usize..][..3 * side as usize]);
    Frame::from_rgb(side, side, rows.copied().collect()).expect("three levels a pixel")
}
