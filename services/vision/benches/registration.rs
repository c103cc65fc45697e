//! `cargo bench -p vision`: registration stage by stage, over frame sizes, contents, windows and numbers of landmarks.
#![allow(missing_docs, reason = "criterion's macros define public functions")]

mod scene;

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use vision::doubled_grid::DoubledGrid;
use vision::hough::Hough;
use vision::mask::{Lanes, Masker};
use vision::measure::{self, Evidence};
use vision::outline::Outline;
use vision::{
    BitMask, Components, Frame, Landmark, NoProbe, PointPx, RectPx, Request, SizePx, Workspace, register,
    shape,
};

fn grid(frame: &Frame, landmark: &Landmark) -> DoubledGrid {
    DoubledGrid::new(RectPx::whole(frame.size()), landmark.window_px).expect("windows fit into frames")
}

fn name(size: SizePx) -> String {
    format!("{}x{}", size.width, size.height)
}

/// Each stage on its own, on the rink. Statistics and mask are one.
fn stages(criterion: &mut Criterion) {
    for size in scene::SIZES {
        let mut group = criterion.benchmark_group(format!("stages/{}", name(size)));
        let (frame, landmark) = (scene::rink(size), scene::red(12));
        let grid = grid(&frame, &landmark);
        let (mut masker, mut mask, mut components) =
            (Masker::default(), BitMask::default(), Components::default());
        let (mut outline, mut hough) = (Outline::default(), Hough::default());
        group.bench_function("mask", |bench| {
            bench.iter(|| masker.find(black_box(&frame), &grid, &landmark, &mut mask, &mut NoProbe));
        });
        group.bench_function("components", |bench| bench.iter(|| components.find(black_box(&mask))));
        let component =
            *components.list().iter().max_by_key(|component| component.pixels).expect("a red block");
        let runs = components.runs(&component);
        group.bench_function("outline", |bench| bench.iter(|| outline.trace(black_box(&mask), runs[0])));
        group.bench_function("hough", |bench| bench.iter(|| hough.segments(black_box(&outline)).len()));
        let segments = hough.segments(&outline);
        group.bench_function("shape", |bench| {
            bench.iter(|| shape::fit(landmark.shape, black_box(&outline), segments));
        });
        let evidence = Evidence {
            mask: &mask,
            component: &component,
            runs,
            outline: &outline,
            segments,
            shape_score: None,
        };
        group.bench_function("measure", |bench| {
            bench.iter(|| measure::sighting(&frame, &grid, black_box(&evidence)));
        });
        let mut workspace = Workspace::default();
        group.bench_function("register", |bench| {
            let request = Request::default();
            bench.iter(|| {
                register(black_box(&frame), &landmark, &request, &mut workspace, &mut NoProbe).is_ok()
            });
        });
        group.finish();
    }
}

/// The mask alone, for what a frame may hold, with each set of instructions.
fn contents(criterion: &mut Criterion) {
    for size in scene::SIZES {
        let mut group = criterion.benchmark_group(format!("mask/{}", name(size)));
        for (content, frame, landmark) in scene::contents(size) {
            let (grid, mut mask) = (grid(&frame, &landmark), BitMask::default());
            for lanes in Lanes::available() {
                let mut masker = Masker::with_lanes(lanes);
                group.bench_function(BenchmarkId::new(content, lanes.name()), |bench| {
                    bench.iter(|| masker.find(black_box(&frame), &grid, &landmark, &mut mask, &mut NoProbe));
                });
            }
        }
        group.finish();
    }
}

/// The mask alone, for windows of several sizes.
fn windows(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("windows/640x480");
    let frame = scene::rink(scene::SIZES[0]);
    for side in [2, 6, 12, 13, 24] {
        let landmark = scene::red(side);
        let (grid, mut mask, mut masker) = (grid(&frame, &landmark), BitMask::default(), Masker::default());
        group.bench_function(BenchmarkId::from_parameter(side), |bench| {
            bench.iter(|| masker.find(black_box(&frame), &grid, &landmark, &mut mask, &mut NoProbe));
        });
    }
    group.finish();
}

/// Many landmarks of distinct colours in one frame, and one inside gates of two sizes, all steps.
fn landmarks(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("landmarks/640x480");
    let (frame, mut workspace) = (scene::rink(scene::SIZES[0]), Workspace::default());
    for count in [1, 8, 64] {
        let landmarks = scene::distinct(count);
        group.bench_function(BenchmarkId::from_parameter(count), |bench| {
            bench.iter(|| {
                let found = |landmark| {
                    register(black_box(&frame), landmark, &Request::default(), &mut workspace, &mut NoProbe)
                        .is_ok()
                };
                landmarks.iter().map(found).filter(|&found| found).count()
            });
        });
    }
    let centre = PointPx::new(466.0, 330.0);
    for side in [48, 96] {
        let corner = |at: f32| at as u32 - side / 2;
        let region = RectPx { x: corner(centre.x), y: corner(centre.y), width: side, height: side };
        let (landmark, request) = (scene::red(12), Request { region: Some(region), ..Request::default() });
        group.bench_function(BenchmarkId::new("gated", side), |bench| {
            bench.iter(|| {
                register(black_box(&frame), &landmark, &request, &mut workspace, &mut NoProbe).is_ok()
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = registration;
    config = Criterion::default()
        .sample_size(30)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(700));
    targets = stages, contents, windows, landmarks
}
criterion_main!(registration);
