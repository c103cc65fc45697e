//! Section 4.0.6: a search near the prediction is faster and keeps false detections out.

use simulator::SceneKind;
use vision::gate::search_gate;
use vision::predict::{Fix, PredictionMethod, Predictor};
use vision::register::{Request, Workspace, register};
use vision::{NoProbe, RectPx};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::lab::score_claims;
use crate::experiments::{ExperimentError, Lab};
use crate::score::{Claim, Score};
use crate::stage_times::thread_cpu_ns;

/// Frames without a sighting after which all of the frame is searched again.
const PATIENCE: u32 = 5;

/// Where a frame is searched.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Search {
    WholeFrame,
    NearPrediction,
}

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let mut account = Account::default();
    let mut told = Vec::new();
    for id in ["red", "blue"] {
        let (whole, whole_us) = searched(lab, id, Search::WholeFrame)?;
        let (near, near_us) = searched(lab, id, Search::NearPrediction)?;
        let faster = whole_us / near_us;
        account.compare(
            format!("{id} time, whole frame over prediction"),
            Thesis::Words("significantly reduced search area"),
            faster,
            "times",
            format!("median CPU of one registration, {whole_us:.0} and {near_us:.0} µs"),
        );
        account.compare(
            format!("{id} false, whole frame"),
            Thesis::Silent,
            whole.false_rate,
            "of frames",
            "faithful",
        );
        account.compare(
            format!("{id} false, near the prediction"),
            Thesis::Words("eliminated"),
            near.false_rate,
            "of frames",
            "faithful, within the gate of a Kalman filter",
        );
        account.compare(
            format!("{id} detection, near the prediction"),
            Thesis::Silent,
            near.detection_rate,
            "of frames",
            "",
        );
        told.push(format!(
            "the {id} block is registered {faster:.1} times as fast, with {:.1} % false instead of {:.1} %",
            100.0 * near.false_rate.unwrap_or(0.0),
            100.0 * whole.false_rate.unwrap_or(0.0)
        ));
    }
    account.sentence = format!(
        "Searched near its prediction only, {}. The text has knowledge of the place increase the processing time.",
        told.join("; ")
    );
    Ok(account)
}

/// The score, and the median CPU time of one registration in µs.
fn searched(lab: &Lab, id: &str, search: Search) -> Result<(Score, f64), ExperimentError> {
    let (drive, landmark) = (lab.drive(SceneKind::Rink)?, lab.template(SceneKind::Rink, id)?);
    let mut workspace = Workspace::default();
    let (mut claims, mut times_us) = (Vec::with_capacity(drive.len()), Vec::with_capacity(drive.len()));
    let mut track: Option<(Predictor, u32)> = None;
    for number in drive.numbers() {
        let (frame, captured_at) = (drive.frame(number)?, drive.captured_at(number));
        let prior = track
            .as_ref()
            .filter(|_| search == Search::NearPrediction)
            .map(|(track, _)| track.predict(captured_at));
        let region: Option<RectPx> = prior.as_ref().and_then(|prior| search_gate(prior).bounds(frame.size()));
        let request = Request { region, prediction: prior.as_ref(), ..Request::default() };
        let before_ns = thread_cpu_ns();
        let seen = register(&frame, landmark, &request, &mut workspace, &mut NoProbe);
        times_us.push((thread_cpu_ns() - before_ns) as f64 * 1e-3);
        let best = seen.ok().and_then(|seen| seen.into_iter().next());
        if let Some(best) = &best {
            let fix = Fix { captured_at, centroid: best.centroid, area_px2: best.area_px2 };
            match &mut track {
                Some((track, missed)) => {
                    track.update(fix);
                    *missed = 0;
                }
                None => track = Some((Predictor::new(PredictionMethod::Kalman, fix), 0)),
            }
        } else if let Some((_, missed)) = &mut track {
            *missed += 1;
        }
        track = track.filter(|(_, missed)| *missed < PATIENCE);
        claims.push(best.as_ref().map(Claim::from));
    }
    let score = score_claims(drive, id, drive.numbers(), |number| claims[number - 1].into_iter().collect());
    Ok((score, crate::score::quantile(&mut times_us, 0.5).unwrap_or(f64::NAN)))
}
