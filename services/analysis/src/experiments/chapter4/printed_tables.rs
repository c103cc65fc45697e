//! What Figure 4.6 and Appendices B and C say about the thesis's own run: the only data of it that there are.

use vision::gate::innovation_gate;
use vision::predict::{PredictionMethod, Predictor};

use crate::chart::{Axis, Chart, Extent, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::appendix::{Block, Row, rows};
use crate::experiments::{ExperimentError, Lab};

/// Figure 4.6 as printed: frame, "X position", "Y position", area.
const FIGURE_4_6: [(u32, f32, f32, f32); 10] = [
    (5, 326.0, 441.0, 113.12),
    (10, 321.0, 442.0, 305.25),
    (28, 331.0, 447.0, 242.25),
    (37, 327.0, 446.0, 414.62),
    (50, 343.0, 445.0, 477.62),
    (64, 326.0, 452.0, 520.0),
    (75, 344.0, 468.0, 469.0),
    (91, 358.0, 496.0, 691.5),
    (110, 378.0, 512.0, 1387.38),
    (129, 392.0, 548.0, 2071.25),
];
/// Two places of one object in one frame lie within this.
const SAME_PLACE_PX: f32 = 8.0;
/// Areas are printed with two places.
const SAME_AREA: f32 = 0.02;

/// Which rows of an appendix lie on one track: a Kalman filter with its gate (4.0.6) believes them.
pub(in crate::experiments) fn on_track(rows: &[Row]) -> Vec<bool> {
    let mut track: Option<Predictor> = None;
    let believed = rows.iter().map(|row| {
        let fix = row.fix();
        match &mut track {
            None => {
                track = Some(Predictor::new(PredictionMethod::Kalman, fix));
                true
            }
            Some(track) => {
                let inside = innovation_gate(&track.predict(fix.captured_at)).contains(fix.centroid);
                if inside {
                    track.update(fix);
                }
                inside
            }
        }
    });
    believed.collect()
}

/// Figure 4.6 against Appendix B.
pub(in crate::experiments) fn figure(_: &Lab) -> Result<Account, ExperimentError> {
    let table = rows(Block::Red)?;
    let row = |frame: u32| table.iter().find(|row| row.frame == frame);
    // The figure's X is the appendix's Y.
    let place_agrees = |&(frame, y, x, _): &(u32, f32, f32, f32)| {
        row(frame).is_some_and(|row| (row.x_px - x).hypot(row.y_px - y) <= SAME_PLACE_PX)
    };
    let area_agrees = |&(frame, _, _, area): &(u32, f32, f32, f32)| {
        row(frame).is_some_and(|row| (row.area_px2_2x - area).abs() <= SAME_AREA)
    };
    let places = FIGURE_4_6.iter().filter(|printed| place_agrees(printed)).count();
    let areas = FIGURE_4_6.iter().filter(|printed| area_agrees(printed)).count();
    let growth = f64::from(FIGURE_4_6[9].3 / FIGURE_4_6[0].3);
    let mut account = Account::default();
    let of_ten = Thesis::Number(10.0);
    account.compare(
        "places that Appendix B confirms",
        of_ten,
        places as f64,
        "of 10",
        "within 8 px; X and Y are interchanged in the figure",
    );
    account.compare("areas that Appendix B confirms", of_ten, areas as f64, "of 10", "");
    account.compare(
        "growth of the area, frame 5 to 129",
        Thesis::Number(growth),
        areas_of(&table),
        "times",
        "from Appendix B",
    );
    account.sentence = format!(
        "The figure's areas are Appendix B's in {areas} of ten frames, its places in {places}: for the others the appendix \
         has a place far to the left. The figure shows where the block was, the appendix what the program found."
    );
    account.chart(&Chart {
        title: "Red block: Appendix B (dots), Figure 4.6 (rings)".to_owned(),
        x: Axis::new("x, px", Extent::Fixed(0.0, 640.0)),
        y: Axis::new("y, px", Extent::Fixed(480.0, 280.0)),
        series: vec![
            Series::new(
                "Appendix B",
                Mark::Dots,
                table.iter().map(|row| (row.x_px.into(), row.y_px.into())).collect(),
            ),
            Series::new(
                "Figure 4.6",
                Mark::Rings,
                FIGURE_4_6.iter().map(|&(_, y, x, _)| (x.into(), y.into())).collect(),
            ),
        ],
    })?;
    Ok(account)
}

fn areas_of(table: &[Row]) -> Option<f64> {
    let area = |frame: u32| table.iter().find(|row| row.frame == frame).map(|row| f64::from(row.area_px2_2x));
    Some(area(129)? / area(5)?)
}

/// Appendices B and C: how many of the printed places are the block.
pub(in crate::experiments) fn appendices(_: &Lab) -> Result<Account, ExperimentError> {
    let mut account = Account::default();
    let mut told = Vec::new();
    for block in [Block::Red, Block::Blue] {
        let table = rows(block)?;
        let believed = on_track(&table);
        let off = believed.iter().filter(|believed| !**believed).count();
        let (name, printed) = (block.name(), Thesis::Words("registered in every frame"));
        let note =
            format!("of the {} rows of {}; told by a gated Kalman filter", table.len(), block.appendix());
        account.compare(format!("{name} places off the track"), printed, off as f64, "rows", note);
        let missing = 146 - table.len();
        account.compare(
            format!("{name} frames without a row"),
            Thesis::Silent,
            missing as f64,
            "frames",
            "of 2 to 147; frame 1 is printed as zeros",
        );
        told.push(format!("{off} of {} places of the {name} block", table.len()));
        let points = |wanted: bool| {
            let chosen = table.iter().zip(&believed).filter(|(_, believed)| **believed == wanted);
            chosen.map(|(row, _)| (f64::from(row.frame), f64::from(row.x_px))).collect()
        };
        let series = vec![
            Series::new("on the track", Mark::Dots, points(true)),
            Series::new("off it", Mark::Dots, points(false)),
        ];
        let mut chart =
            Chart::over_frames(format!("{}: X of the {name} block, px", block.appendix()), series);
        chart.y.extent = Extent::Fixed(0.0, 640.0);
        account.chart(&chart)?;
    }
    account.compare(
        "frames with data",
        Thesis::Number(299.0),
        147.0,
        "frames",
        "the appendices end at frame 147 of the 299",
    );
    account.sentence = format!(
        "{} lie off its track, far from where it was a frame before. So the block was not registered in every frame, as \
         section 4.0.5 and chapter 5 say; something was.",
        told.join(" and ")
    );
    Ok(account)
}
