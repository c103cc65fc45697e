//! Writes a simulated drive as JPEG pictures with its truth.
//!
//! usage: render_sequence SOURCE DIRECTORY [FRAMES]
//!
//! SOURCE is a simulator source such as `sim:rink?seed=3`. DIRECTORY receives `f001.jpg` … and `truth.csv`, whose
//! coordinates follow the pixel-centre convention (the centre of the first pixel is (0, 0)), half a pixel less than
//! everywhere else in Waymark.

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use simulator::{SceneOptions, Simulator, TrueObject};
use vision::frame::encode::{Quality, encode_jpeg};

/// From the corner convention to the pixel-centre convention, px.
const TO_PIXEL_CENTRES: f64 = -0.5;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [source, directory, rest @ ..] = &arguments[..] else {
        return Err("usage: render_sequence SOURCE DIRECTORY [FRAMES]".into());
    };
    let options: SceneOptions = source.parse()?;
    let frames = rest.first().map_or(Ok(u64::from(options.frames_one_way)), |text| text.parse())?;
    write_sequence(Simulator::new(options)?, Path::new(directory), frames)
}

fn write_sequence(mut simulator: Simulator, directory: &Path, frames: u64) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(directory)?;
    let mut table = "frame,object,cx,cy,area,x0,y0,x1,y1,visible\n".to_owned();
    for index in 0..frames {
        let rendered = simulator.render(index);
        let picture = encode_jpeg(&rendered.frame, Quality::default())?;
        fs::write(directory.join(format!("f{:03}.jpg", index + 1)), picture)?;
        for object in &rendered.truth {
            add_row(&mut table, index + 1, object)?;
        }
    }
    fs::write(directory.join("truth.csv"), table)?;
    Ok(())
}

fn add_row(table: &mut String, number: u64, object: &TrueObject) -> Result<(), std::fmt::Error> {
    let [x, y] = object.centroid_px.map(|at| at + TO_PIXEL_CENTRES);
    let [left, top, right, bottom] = object.bbox_px.map(|at| at + TO_PIXEL_CENTRES);
    writeln!(
        table,
        "{number},{},{x:.4},{y:.4},{:.4},{left:.4},{top:.4},{right:.4},{bottom:.4},{:.4}",
        object.object, object.area_px2, object.visible
    )
}
