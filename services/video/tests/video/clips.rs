//! Real films, where they lie beside the repository.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Duration;

use video::FilmReader;
use vision::frame::decode::DecodeLimits;

fn clip(name: &str) -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let shared = std::env::var_os("WAYMARK_SHARED").map_or(beside, PathBuf::from);
    let path = shared.join("data/clips").join(name);
    if path.is_file() {
        return Some(path);
    }
    println!("SKIPPED: no {}; set WAYMARK_SHARED to what holds data/clips", path.display());
    None
}

/// Both films have bidirectional pictures, 1280×720 at 30000/1001 a second.
#[test]
fn every_frame_of_real_films_comes_out_in_order() {
    for (name, count) in [("blocks.mp4", 292), ("coffee_mug.mp4", 287)] {
        let Some(path) = clip(name) else { continue };
        let reader = FilmReader::open(File::open(path).unwrap(), DecodeLimits::default()).unwrap();
        let mut frames = 0_u32;
        for frame in reader {
            let frame = frame.unwrap();
            assert_eq!((frame.frame.width(), frame.frame.height()), (1280, 720));
            let expected = Duration::from_nanos(u64::from(frames) * 1_001_000_000_000 / 30_000);
            assert!(
                frame.shown_after.abs_diff(expected) < Duration::from_micros(40),
                "{name} frame {frames}"
            );
            frames += 1;
        }
        assert_eq!(frames, count, "{name}");
    }
}
