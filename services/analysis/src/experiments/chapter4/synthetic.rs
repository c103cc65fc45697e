//! Table 4.1 and Figures 4.2 to 4.4: the method on the synthetic picture.

use vision::learn::{LearnOptions, Preset, Template, Tolerance, learn};
use vision::overlay::{Layers, draw};
use vision::register::{Request, Workspace, register};
use vision::{Frame, Landmark, LandmarkOutcome, NoProbe, Outcome, PointPx, ShapeClass, Sighting, SizePx};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::lab::TEMPLATE_FRAME;
use crate::experiments::picture::enlarged;
use crate::experiments::scene::{RED, Synthetic, synthetic};
use crate::experiments::{ExperimentError, Lab};
use crate::sketch::line;
use crate::thumbnail::part;

/// Table 4.1.
pub(in crate::experiments) fn characteristics(_: &Lab) -> Result<Account, ExperimentError> {
    let scene = synthetic()?;
    let stats = template(&scene)?.shades[0];
    let mut account = Account::default();
    for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
        let (mean, variance) = (f64::from(stats.mean[channel]), f64::from(stats.variance[channel]));
        let printed = Thesis::Number(f64::from(RED[channel]));
        account.compare(format!("{name} mean"), printed, mean, "levels", "");
        account.compare(format!("{name} variance"), Thesis::Number(0.0), variance, "levels²", "");
    }
    account.sentence =
        "The synthetic block is painted with the table's colour, so that its six statistics are the \
                        table's: nothing but a check that template and statistics are taken as described."
            .to_owned();
    Ok(account)
}

/// Figures 4.2 and 4.3.
pub(in crate::experiments) fn registration(_: &Lab) -> Result<Account, ExperimentError> {
    let scene = synthetic()?;
    let landmark = template(&scene)?;
    let found = find(&scene.frame, &landmark);
    let middle = PointPx::new(
        scene.block.x as f32 + scene.block.width as f32 / 2.0,
        scene.block.y as f32 + scene.block.height as f32 / 2.0,
    );
    let on_block = |sighting: &&Sighting| sighting.centroid.distance_px(middle) < scene.block.width as f32;
    let block = found.iter().find(on_block);
    let mut account = Account::default();
    let off_px = block.map(|seen| f64::from(seen.centroid.distance_px(middle)));
    account.compare("centre error", Thesis::Words("detected"), off_px, "px", "of the 6×6 block");
    let area = block.map(|seen| f64::from(seen.area_px2));
    account.compare("area", Thesis::Silent, area, "px²", "36 px² are true");
    let false_ones = found.iter().filter(|seen| !on_block(seen)).count() as f64;
    account.compare(
        "false sightings",
        Thesis::Number(0.0),
        false_ones,
        "",
        "the red line has the block's colour",
    );
    let (state, wrong) = (if block.is_some() { "is found" } else { "is not found" }, false_ones as u64);
    account.sentence = format!(
        "On the noiseless picture the block {state}, {}, with {wrong} false sightings beside it: the line of the same \
         colour is two pixels wide and the window of 3×3 pixels does not fit into it.",
        off_px.map_or_else(|| "-".to_owned(), |off| format!("{off:.2} px off"))
    );
    account.picture(&scene.frame, "The input, after Fig 4.2")?;
    let mut drawn = enlarged(&scene.frame, 3)?;
    for sighting in &found {
        let outline = sighting.outline.iter().map(|point| PointPx::new(3.0 * point.x, 3.0 * point.y));
        let points: Vec<PointPx> = outline.collect();
        for (from, to) in points.iter().zip(points.iter().cycle().skip(1)) {
            line(&mut drawn, *from, *to, 2, [0, 0, 0]);
        }
    }
    account.picture(&drawn, "What is registered (black outline), after Fig 4.3")?;
    Ok(account)
}

/// Figure 4.4.
pub(in crate::experiments) fn segments(lab: &Lab) -> Result<Account, ExperimentError> {
    let mut frame = lab.rink_frame()?;
    let landmark = lab.template(simulator::SceneKind::Rink, "red")?;
    let found = find(&frame, landmark);
    let best = found.first();
    let mut account = Account::default();
    let count = best.map(|seen| seen.segments.len() as f64);
    account.compare("segments", Thesis::Silent, count, "", "straight pieces of the red block's outline");
    let share = best.and_then(|seen| Some(f64::from(seen.shape_score?)));
    account.compare(
        "outline in perpendicular pairs",
        Thesis::Words("all of the lines"),
        share,
        "of its length",
        "within 9°, meeting near their ends; null where the outline is too short to tell",
    );
    account.sentence = match (count, share) {
        (Some(count), Some(share)) => format!(
            "{count:.0} segments make the outline of the red block in frame {TEMPLATE_FRAME}, and pairs that are \
             perpendicular within 9° explain {:.0} % of its length; the thesis found all lines perpendicular.",
            100.0 * share
        ),
        (Some(count), None) => format!("{count:.0} segments: the outline is too short to tell its shape."),
        _ => "The template is not found in the frame that it was taken from.".to_owned(),
    };
    if let Some(best) = best {
        let outcome = outcome_of(frame.size(), landmark, best);
        draw(&mut frame, &outcome, Layers::OUTLINE | Layers::SEGMENTS);
    }
    let around = lab.drive(simulator::SceneKind::Rink)?.region(TEMPLATE_FRAME, "red", 3.0)?;
    account.picture(&part(&frame, around), "Outline and segments, after Fig 4.4")?;
    Ok(account)
}

fn outcome_of(frame_size: SizePx, landmark: &Landmark, sighting: &Sighting) -> Outcome {
    let seen = LandmarkOutcome {
        landmark: landmark.id.clone(),
        digest: landmark.digest,
        instance: 0,
        prediction: None,
        gate: None,
        result: Ok(sighting.clone()),
        innovation_px: None,
        adaptation: None,
    };
    Outcome { frame_size, landmarks: vec![seen], ..Outcome::default() }
}

fn template(scene: &Synthetic) -> Result<Landmark, ExperimentError> {
    let options = LearnOptions {
        id: "red".to_owned(),
        shape: ShapeClass::Block,
        tolerance: Tolerance::Preset(Preset::RedBlock),
        template: Template::Exact,
        ..LearnOptions::default()
    };
    Ok(learn(&[(&scene.frame, scene.block)], &options)?)
}

fn find(frame: &Frame, landmark: &Landmark) -> Vec<Sighting> {
    register(frame, landmark, &Request::default(), &mut Workspace::default(), &mut NoProbe)
        .unwrap_or_default()
}
