//! Prediction on the registered positions that the thesis prints (Appendix B and C): false detections are gated out,
//! the others are predicted to within the required error.

#![allow(clippy::print_stdout, reason = "a skipped test says so")]

use std::path::PathBuf;

use vision::gate::innovation_gate;
use vision::predict::{Fix, PredictionMethod, Predictor};
use vision::{PointPx, Timestamp};

struct Row {
    fix: Fix,
    outlier: bool,
}

/// The rows of an appendix without the all-zero first frame; `None` where the shared data are missing.
fn rows(name: &str) -> Option<Vec<Row>> {
    let shared = std::env::var_os("WAYMARK_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"), PathBuf::from);
    let path = shared.join("thesis").join(name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("SKIPPED: {} is missing; set WAYMARK_SHARED to the shared reference", path.display());
        return None;
    };
    Some(text.lines().skip(1).filter_map(row).collect())
}

fn row(line: &str) -> Option<Row> {
    let fields: Vec<&str> = line.split(',').collect();
    if fields[4] == "frame1_zero" {
        return None;
    }
    let number = |at: usize| fields[at].parse::<f32>().ok();
    let frame = fields[0].parse::<i64>().ok()?;
    Some(Row {
        fix: Fix {
            captured_at: Timestamp::from_nanos(frame * 1_000_000_000 / 30),
            centroid: PointPx::new(number(1)?, number(2)?),
            area_px2: number(3)? / 4.0,
        },
        outlier: !fields[4].is_empty(),
    })
}

struct Result {
    rejected_outliers: usize,
    rejected_inliers: usize,
    rms_px: [f32; 2],
}

fn run(rows: &[Row]) -> Result {
    let mut predictor = Predictor::new(PredictionMethod::Kalman, rows[0].fix);
    let mut result = Result { rejected_outliers: 0, rejected_inliers: 0, rms_px: [0.0; 2] };
    let mut inliers = 0;
    for row in &rows[1..] {
        let prior = predictor.predict(row.fix.captured_at);
        let believed = innovation_gate(&prior).contains(row.fix.centroid);
        if !row.outlier {
            inliers += 1;
            result.rms_px[0] += (row.fix.centroid.x - prior.centroid.x).powi(2);
            result.rms_px[1] += (row.fix.centroid.y - prior.centroid.y).powi(2);
        }
        match (believed, row.outlier) {
            (true, _) => predictor.update(row.fix),
            (false, true) => result.rejected_outliers += 1,
            (false, false) => result.rejected_inliers += 1,
        }
    }
    result.rms_px = result.rms_px.map(|sum| (sum / inliers as f32).sqrt());
    result
}

#[test]
fn appendix_c_inliers_are_predicted_and_outliers_gated_out() {
    let Some(rows) = rows("appendix_c.csv") else { return };
    let result = run(&rows);
    println!("rms {:?} px, {} inliers rejected", result.rms_px, result.rejected_inliers);
    assert_eq!(result.rejected_outliers, 13);
    assert!(result.rms_px.iter().all(|&rms| rms <= 1.6), "{:?}", result.rms_px);
}

#[test]
fn appendix_b_outliers_are_gated_out() {
    let Some(rows) = rows("appendix_b.csv") else { return };
    let result = run(&rows);
    println!("rms {:?} px, {} inliers rejected", result.rms_px, result.rejected_inliers);
    assert_eq!(result.rejected_outliers, rows.iter().filter(|row| row.outlier).count());
    assert_eq!(result.rejected_outliers, 108);
}
