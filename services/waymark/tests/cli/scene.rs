//! Pictures made for these tests: a red block that moves over a grey floor.

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use vision::Frame;
use vision::frame::encode::{Quality, encode_jpeg, encode_png};

/// Side of the block, px.
pub(crate) const SIDE_PX: u32 = 20;

/// Left edge of the block in frame `number`, counted from 1.
pub(crate) fn left_px(number: u32) -> u32 {
    30 + 3 * number
}

/// Top edge of the block.
pub(crate) const TOP_PX: u32 = 40;

/// One frame.
pub(crate) fn frame(number: u32) -> Frame {
    let left = left_px(number);
    let inside = |x, y| (left..left + SIDE_PX).contains(&x) && (TOP_PX..TOP_PX + SIDE_PX).contains(&y);
    let colour = |x: u32, y: u32| match inside(x, y) {
        true => [204, 38, 30],
        false => [(96 + (x * 7 + y * 13) % 19) as u8; 3],
    };
    let rgb = (0..120).flat_map(|y| (0..160).flat_map(move |x| colour(x, y))).collect();
    Frame::from_rgb(160, 120, rgb).unwrap()
}

/// A drive of `frames` JPEG pictures, `f1.jpg` and on, and the landmark file learned from its second.
pub(crate) struct Drive {
    directory: TempDir,
}

impl Drive {
    pub(crate) fn of(frames: u32) -> Self {
        let drive = Self { directory: tempfile::tempdir().unwrap() };
        std::fs::create_dir(drive.frames()).unwrap();
        for number in 1..=frames {
            let jpeg = encode_jpeg(&frame(number), Quality::default()).unwrap();
            std::fs::write(drive.frames().join(format!("f{number}.jpg")), jpeg).unwrap();
        }
        std::fs::create_dir(drive.path("learned")).unwrap();
        let png = drive.near();
        std::fs::write(&png, encode_png(&frame(2)).unwrap()).unwrap();
        let region = format!("{}#xywh={},{TOP_PX},{SIDE_PX},{SIDE_PX}", png.display(), left_px(2));
        let learned = drive.landmark();
        crate::program::waymark([
            "landmark",
            "learn",
            &region,
            "--id",
            "red",
            "--shape",
            "block",
            "-o",
            text(&learned),
        ])
        .ended(0);
        drive
    }

    pub(crate) fn frames(&self) -> PathBuf {
        self.path("frames")
    }

    pub(crate) fn landmark(&self) -> PathBuf {
        self.path("red.json")
    }

    /// A picture (PNG) without the block.
    pub(crate) fn floor(&self) -> Vec<u8> {
        encode_png(&Frame::from_rgb(160, 120, vec![110; 160 * 120 * 3]).unwrap()).unwrap()
    }

    /// The picture that the landmark was learned from.
    pub(crate) fn near(&self) -> PathBuf {
        self.path("learned").join("near.png")
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }
}

/// A path as an argument.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}
