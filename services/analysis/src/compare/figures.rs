//! What became of each method, in figures.

use std::collections::BTreeMap;

use serde::Serialize;

use super::race::Lane;
use crate::score::{Claim, quantile, score};
use crate::truth::Truth;

/// One method over one landmark's frames. Rates are parts of the frames; what is unknown is null.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MethodFigures {
    /// Its name.
    pub method: &'static str,
    /// Frames with a claim.
    pub claimed_rate: Option<f64>,
    /// With truth: frames measured rightly, of those that show the object.
    pub detection_rate: Option<f64>,
    /// With truth: frames claimed somewhere else, of the same.
    pub false_rate: Option<f64>,
    /// With truth: frames without the object in which something was claimed.
    pub false_when_absent: Option<u64>,
    /// With truth: median distance of right centres from the true ones.
    pub centre_median_px: Option<f64>,
    /// Its 95th percentile.
    pub centre_p95_px: Option<f64>,
    /// With truth: median of |area / true area − 1| of right claims.
    pub area_abs_median_relative: Option<f64>,
    /// Without truth: frames in which the claim lies where most of the others do, of those in which two or more agree.
    pub agreement_rate: Option<f64>,
    /// Claims further than an object's size from the one in the frame before, of consecutive claims.
    pub jump_rate: Option<f64>,
    /// Median thread CPU time of a frame, without decoding.
    pub cpu_median_ms: Option<f64>,
    /// Its 95th percentile.
    pub cpu_p95_ms: Option<f64>,
}

/// Judged by truth.
pub(super) fn by_truth(lane: &Lane, truth: &Truth) -> MethodFigures {
    let claims: BTreeMap<u64, Vec<Claim>> =
        lane.claims.iter().map(|(number, claim)| (*number, vec![*claim])).collect();
    let score = score(truth, &claims);
    MethodFigures {
        detection_rate: score.detection_rate,
        false_rate: score.false_rate,
        false_when_absent: Some(score.false_when_absent),
        centre_median_px: score.centre_median_px,
        centre_p95_px: score.centre_p95_px,
        area_abs_median_relative: score.area_abs_median_relative,
        ..without_judge(lane)
    }
}

/// Judged by each other.
pub(super) fn by_agreement(lanes: &[Lane], numbers: &[u64]) -> Vec<MethodFigures> {
    let common: BTreeMap<u64, Claim> =
        numbers.iter().filter_map(|number| Some((*number, common(lanes, *number)?))).collect();
    let figures = lanes.iter().map(|lane| {
        let agrees = |(number, common): &(&u64, &Claim)| {
            lane.claims.get(number).is_some_and(|claim| near(claim, common))
        };
        let agreed = common.iter().filter(agrees).count();
        let agreement_rate = (!common.is_empty()).then(|| agreed as f64 / common.len() as f64);
        MethodFigures { agreement_rate, ..without_judge(lane) }
    });
    figures.collect()
}

/// The claim in a frame that most others lie near to; `None` where no two do.
fn common(lanes: &[Lane], number: u64) -> Option<Claim> {
    let claims: Vec<Claim> = lanes.iter().filter_map(|lane| lane.claims.get(&number).copied()).collect();
    let supporters = |claim: &Claim| claims.iter().filter(|other| near(other, claim)).count();
    let best = claims
        .iter()
        .copied()
        .reduce(|best, claim| if supporters(&claim) > supporters(&best) { claim } else { best })?;
    (supporters(&best) >= 2).then_some(best)
}

/// Whether two claims are one object: their centres lie within half its size, or 3 px.
fn near(one: &Claim, other: &Claim) -> bool {
    let size_px = one.area_px2.max(other.area_px2).max(0.0).sqrt();
    one.centre.distance_px(other.centre) <= (0.5 * size_px).max(3.0)
}

fn without_judge(lane: &Lane) -> MethodFigures {
    let frames = lane.cost_ms.len();
    let mut cost_ms: Vec<f64> = lane.cost_ms.iter().map(|(_, ms)| *ms).collect();
    let mut pairs = 0;
    let mut jumps = 0;
    for (number, claim) in &lane.claims {
        if let Some(before) = number.checked_sub(1).and_then(|before| lane.claims.get(&before)) {
            pairs += 1;
            let size_px = before.area_px2.max(claim.area_px2).max(1.0).sqrt();
            jumps += u64::from(before.centre.distance_px(claim.centre) > size_px);
        }
    }
    MethodFigures {
        method: lane.method.name(),
        claimed_rate: (frames > 0).then(|| lane.claims.len() as f64 / frames as f64),
        jump_rate: (pairs > 0).then(|| jumps as f64 / pairs as f64),
        cpu_median_ms: quantile(&mut cost_ms, 0.5),
        cpu_p95_ms: quantile(&mut cost_ms, 0.95),
        ..MethodFigures::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Method;
    use vision::PointPx;

    fn lane(method: Method, xs: &[f32]) -> Lane {
        let claim = |x: f32| Claim { centre: PointPx::new(x, 50.0), area_px2: 100.0, score: 1.0 };
        Lane {
            method,
            claims: (1..)
                .zip(xs)
                .filter(|(_, x)| x.is_finite())
                .map(|(number, x)| (number, claim(*x)))
                .collect(),
            cost_ms: (1..).zip(xs).map(|(number, _)| (number, 2.0)).collect(),
            truth: None,
        }
    }

    #[test]
    fn who_stands_alone_does_not_agree() {
        let lanes = [
            lane(Method::Faithful, &[10.0, 12.0, 90.0]),
            lane(Method::Adaptive, &[11.0, 12.0, 14.0]),
            lane(Method::ColourBlob, &[60.0, f32::NAN, 15.0]),
        ];
        let figures = by_agreement(&lanes, &[1, 2, 3]);
        let rates: Vec<Option<f64>> = figures.iter().map(|figures| figures.agreement_rate).collect();
        assert_eq!(rates, [Some(2.0 / 3.0), Some(1.0), Some(1.0 / 3.0)]);
        assert_eq!(figures[0].jump_rate, Some(0.5));
        assert_eq!((figures[2].claimed_rate, figures[2].jump_rate), (Some(2.0 / 3.0), None));
        assert_eq!(figures[0].cpu_median_ms, Some(2.0));
    }
}
