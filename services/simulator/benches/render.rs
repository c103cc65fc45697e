//! Cost of one simulated frame, without encoding.

use criterion::{Criterion, criterion_group, criterion_main};
use simulator::{SceneKind, SceneOptions, Simulator};
use vision::SizePx;

fn render(criterion: &mut Criterion) {
    for kind in SceneKind::ALL {
        for (width, height) in [(640, 480), (1280, 720)] {
            let size = SizePx { width, height };
            let mut simulator = Simulator::new(SceneOptions { size, ..SceneOptions::new(kind) })
                .expect("the default options with a usual size are valid");
            let mut index = 0;
            criterion.bench_function(&format!("render/{kind}/{width}x{height}"), |bencher| {
                bencher.iter(|| {
                    index += 7;
                    simulator.render(index)
                });
            });
        }
    }
}

criterion_group!(benches, render);
criterion_main!(benches);
