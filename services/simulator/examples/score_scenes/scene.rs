//! Pictures and truth, rendered or read.

use std::fs;
use std::path::Path;

use simulator::{SceneOptions, Simulator};
use vision::RectPx;
use vision::frame::encode::{Quality, encode_jpeg};

/// One object in one frame; places count from the corner of the frame.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    pub(crate) object: String,
    pub(crate) centre_px: [f64; 2],
    pub(crate) area_px2: f64,
    pub(crate) bbox_px: [f64; 4],
    pub(crate) visible: f64,
}

/// Encoded pictures and what is really in each.
pub(crate) struct Sequence {
    pub(crate) pictures: Vec<Vec<u8>>,
    pub(crate) truth: Vec<Vec<Seen>>,
}

impl Sequence {
    pub(crate) fn open(source: &str) -> Self {
        if source.starts_with("sim:") { rendered(source) } else { read(Path::new(source)) }
    }

    /// The first whole view of one of the objects.
    pub(crate) fn first_box(&self, objects: &[String]) -> Option<(usize, RectPx)> {
        self.views(objects).next().map(|(at, seen)| (at, around(seen)))
    }

    /// The whole view of one of the objects whose size is nearest to `side_px`.
    pub(crate) fn nearest_box(&self, objects: &[String], side_px: f64) -> Option<(usize, RectPx)> {
        let off = |seen: &Seen| (seen.area_px2.sqrt() / side_px).ln().abs();
        let nearest = self.views(objects).min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
        nearest.map(|(at, seen)| (at, around(seen)))
    }

    fn views<'a>(&'a self, objects: &'a [String]) -> impl Iterator<Item = (usize, &'a Seen)> {
        let all =
            self.truth.iter().enumerate().flat_map(|(at, seen)| seen.iter().map(move |seen| (at, seen)));
        all.filter(|(_, seen)| objects.contains(&seen.object) && seen.visible > 0.999)
    }
}

/// The whole pixels around an object, as somebody would draw a box.
fn around(seen: &Seen) -> RectPx {
    let [left, top, right, bottom] = seen.bbox_px;
    let (x, y) = (left.floor() as u32, top.floor() as u32);
    RectPx { x, y, width: right.ceil() as u32 - x, height: bottom.ceil() as u32 - y }
}

fn rendered(source: &str) -> Sequence {
    let options: SceneOptions = source.parse().unwrap();
    let mut simulator = Simulator::new(options).unwrap();
    let mut sequence = Sequence { pictures: Vec::new(), truth: Vec::new() };
    for index in 0..u64::from(options.frames_one_way) {
        let rendered = simulator.render(index);
        sequence.pictures.push(encode_jpeg(&rendered.frame, Quality::default()).unwrap());
        let seen = rendered.truth.into_iter().map(|object| Seen {
            object: object.object,
            centre_px: object.centroid_px,
            area_px2: object.area_px2,
            bbox_px: object.bbox_px,
            visible: object.visible,
        });
        sequence.truth.push(seen.collect());
    }
    sequence
}

fn read(directory: &Path) -> Sequence {
    let files = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "jpg")).collect();
    paths.sort();
    let mut truth = vec![Vec::new(); paths.len()];
    for row in fs::read_to_string(directory.join("truth.csv")).unwrap().lines().skip(1) {
        let columns: Vec<&str> = row.split(',').collect();
        let number = |column: usize| columns[column].parse::<f64>().unwrap();
        // Truth files count from the centre of the first pixel.
        let place = |column: usize| number(column) + 0.5;
        truth[number(0) as usize - 1].push(Seen {
            object: columns[1].to_owned(),
            centre_px: [place(2), place(3)],
            area_px2: number(4),
            bbox_px: [place(5), place(6), place(7), place(8)],
            visible: number(9),
        });
    }
    Sequence { pictures: paths.iter().map(|path| fs::read(path).unwrap()).collect(), truth }
}
