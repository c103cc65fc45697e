//! Counting right and wrong claims.

use vision::{LandmarkOutcome, Sighting};

use crate::scene::Seen;

/// Signs that are seen together are counted from this size on; smaller ones stand in a column of their own.
const LEAST_AREA_PX2: f64 = 80.0;

pub(crate) const HEADER: &str =
    "source landmark frames detected false extra median_px p95_px area% absent% swaps small";

/// What the frames of one landmark said.
pub(crate) struct Tally {
    frames: u64,
    views: u64,
    detected: u64,
    wrong: u64,
    extra: u64,
    absent: u64,
    claimed_absent: u64,
    small: (u64, u64),
    errors_px: Vec<f64>,
    area_errors: Vec<f64>,
    /// The instance that last stood for each object, and how often that changed.
    instances: Vec<Option<u32>>,
    swaps: u64,
    loud: bool,
}

fn tolerance_px(seen: &Seen) -> f64 {
    (0.5 * seen.area_px2.sqrt()).max(3.0)
}

fn off_px(seen: &Seen, claim: &Sighting) -> f64 {
    let (dx, dy) =
        (f64::from(claim.centroid.x) - seen.centre_px[0], f64::from(claim.centroid.y) - seen.centre_px[1]);
    dx.hypot(dy)
}

impl Tally {
    pub(crate) fn new(objects: usize) -> Self {
        Self {
            frames: 0,
            views: 0,
            detected: 0,
            wrong: 0,
            extra: 0,
            absent: 0,
            claimed_absent: 0,
            small: (0, 0),
            errors_px: Vec::new(),
            area_errors: Vec::new(),
            instances: vec![None; objects],
            swaps: 0,
            loud: std::env::var_os("SCORE_SCENES_FRAMES").is_some(),
        }
    }

    /// Counts frame number `at`: what there is to see and what was claimed.
    pub(crate) fn count(&mut self, at: usize, truth: &[Option<&Seen>], outcomes: &[LandmarkOutcome]) {
        let claims: Vec<(u32, &Sighting)> =
            outcomes.iter().filter_map(|o| o.result.as_ref().ok().map(|seen| (o.instance, seen))).collect();
        let visible: Vec<&Seen> =
            truth.iter().flatten().copied().filter(|seen| seen.visible >= 0.05).collect();
        if visible.is_empty() {
            self.absent += 1;
            self.claimed_absent += u64::from(!claims.is_empty());
        } else {
            self.frames += 1;
        }
        let is_right =
            |claim: &Sighting| visible.iter().any(|seen| off_px(seen, claim) <= tolerance_px(seen));
        let wrong = claims.iter().filter(|(_, claim)| !is_right(claim)).count() as u64;
        let best = claims.iter().max_by(|a, b| a.1.score.total_cmp(&b.1.score));
        let best_is_wrong = !visible.is_empty() && best.is_some_and(|(_, claim)| !is_right(claim));
        if !visible.is_empty() {
            self.wrong += u64::from(best_is_wrong);
            self.extra += wrong - u64::from(best_is_wrong);
        }
        for (object, seen) in truth.iter().enumerate() {
            if let Some(seen) = seen.filter(|seen| seen.visible >= 0.5) {
                self.count_view(at, object, truth.len(), seen, &claims);
            }
        }
        if self.loud && wrong > 0 {
            for (instance, claim) in claims.iter().filter(|(_, claim)| !is_right(claim)) {
                println!(
                    "  {} wrong #{instance} {:.0},{:.0} area {:.0} score {:.2}",
                    at + 1,
                    claim.centroid.x,
                    claim.centroid.y,
                    claim.area_px2,
                    claim.score
                );
            }
        }
    }

    fn count_view(
        &mut self,
        at: usize,
        object: usize,
        objects: usize,
        seen: &Seen,
        claims: &[(u32, &Sighting)],
    ) {
        let near = claims.iter().filter(|(_, claim)| off_px(seen, claim) <= tolerance_px(seen));
        let found = near.max_by(|a, b| a.1.score.total_cmp(&b.1.score));
        if objects > 1 && seen.area_px2 < LEAST_AREA_PX2 {
            self.small.0 += u64::from(found.is_some());
            self.small.1 += 1;
        } else {
            self.views += 1;
            self.detected += u64::from(found.is_some());
        }
        let Some((instance, claim)) = found else {
            if self.loud {
                println!(
                    "  {} missed object {object} {:.0},{:.0} area {:.0} visible {:.2}",
                    at + 1,
                    seen.centre_px[0],
                    seen.centre_px[1],
                    seen.area_px2,
                    seen.visible
                );
            }
            return;
        };
        let before = self.instances[object].replace(*instance);
        self.swaps += u64::from(before.is_some_and(|before| before != *instance));
        self.errors_px.push(off_px(seen, claim));
        self.area_errors.push((f64::from(claim.area_px2) / seen.area_px2 - 1.0).abs());
    }
}

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

/// One line of the table.
pub(crate) fn line(source: &str, landmark: &str, tally: &Tally) -> String {
    let rate = |count: u64, of: u64| if of == 0 { f64::NAN } else { count as f64 / of as f64 };
    format!(
        "{source} {landmark} {} {:.3} {:.3} {:.3} {:.2} {:.2} {:.1} {:.1} {} {:.2}",
        tally.frames,
        rate(tally.detected, tally.views),
        rate(tally.wrong, tally.frames),
        rate(tally.extra, tally.frames),
        quantile(&tally.errors_px, 0.5),
        quantile(&tally.errors_px, 0.95),
        100.0 * quantile(&tally.area_errors, 0.5),
        100.0 * rate(tally.claimed_absent, tally.absent),
        tally.swaps,
        rate(tally.small.0, tally.small.1),
    )
}
