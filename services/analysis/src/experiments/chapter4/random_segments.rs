//! Figure 4.1: random line segments, of which the perpendicular ones are kept.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use vision::hough::OutlineSegment;
use vision::shape::is_perpendicular_to_any;

use crate::chart::{Axis, Chart, Extent, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::{ExperimentError, Lab};

/// Segments in the thesis's draw.
const SEGMENTS: usize = 10;
const DRAWS: usize = 1_000;
const SEED: u64 = 41;
/// Side of the square that segments lie in; as large as a block's outline on the doubled grid, in whose units the test
/// of corners counts.
const SIDE: f64 = 100.0;

/// The experiment.
pub(in crate::experiments) fn run(_: &Lab) -> Result<Account, ExperimentError> {
    let draws = draws(SEGMENTS);
    let at_3 = share(&draws, |draw| passes(draw, 3.0));
    let at_9 = share(&draws, |draw| passes(draw, 9.0));
    let kept = |degrees: f64| {
        let kept: usize =
            draws.iter().map(|draw| draw.iter().filter(|one| has_partner(one, draw, degrees)).count()).sum();
        kept as f64 / (DRAWS * SEGMENTS) as f64
    };
    let meeting = share(&draws, |draw| draw.iter().any(|one| is_perpendicular_to_any(one, draw)));
    let mut account = Account::default();
    let single = Thesis::Words("passes, in the one draw that is shown");
    account.compare(
        "false passes at 3°",
        single,
        at_3,
        "of draws",
        "random segments that the bare test of angles takes for a block",
    );
    account.compare("false passes at 9°", Thesis::Silent, at_9, "of draws", "the tolerance of section 4.0.5");
    account.compare("segments kept at 3°", Thesis::Silent, kept(3.0), "of segments", "");
    account.compare("segments kept at 9°", Thesis::Silent, kept(9.0), "of segments", "");
    account.compare(
        "false passes at 9° where sides must meet",
        Thesis::Silent,
        meeting,
        "of draws",
        "the test used here: perpendicular, and crossing near an end of both",
    );
    account.sentence = format!(
        "Of {DRAWS} draws of {SEGMENTS} random segments the bare test of angles passes {:.0} % at 3° and {:.0} % at 9°: \
         alone it tells nothing about an object. Demanding that the two sides meet near their ends lowers the {:.0} % to {:.0} %.",
        100.0 * at_3,
        100.0 * at_9,
        100.0 * at_9,
        100.0 * meeting
    );
    // The thesis shows one that passes; so does this.
    if let Some(passing) = draws.iter().find(|draw| passes(draw, 3.0)) {
        account.chart(&plot("One draw: 10 random segments", passing.iter()))?;
        let kept = passing.iter().filter(|one| has_partner(one, passing, 3.0));
        account.chart(&plot("Those with a perpendicular partner within 3°", kept))?;
    }
    account.chart(&by_tolerance())?;
    Ok(account)
}

fn draws(segments: usize) -> Vec<Vec<OutlineSegment>> {
    let mut random = Pcg32::seed_from_u64(SEED);
    let mut point = || (SIDE * random.random::<f64>(), SIDE * random.random::<f64>());
    let mut segment = || OutlineSegment { from: point(), to: point(), ..OutlineSegment::default() };
    (0..DRAWS).map(|_| (0..segments).map(|_| segment()).collect()).collect()
}

fn share(draws: &[Vec<OutlineSegment>], test: impl Fn(&[OutlineSegment]) -> bool) -> f64 {
    draws.iter().filter(|draw| test(draw)).count() as f64 / draws.len() as f64
}

/// Whether the thesis's test finds a block: some two segments are perpendicular, wherever they lie.
fn passes(draw: &[OutlineSegment], degrees: f64) -> bool {
    draw.iter().any(|one| has_partner(one, draw, degrees))
}

fn has_partner(one: &OutlineSegment, draw: &[OutlineSegment], degrees: f64) -> bool {
    draw.iter().any(|other| {
        let between = (one.heading_rad() - other.heading_rad()).to_degrees().rem_euclid(180.0);
        (between - 90.0).abs() <= degrees
    })
}

fn plot<'a>(title: &str, segments: impl Iterator<Item = &'a OutlineSegment>) -> Chart {
    let ends = segments.flat_map(|segment| [segment.from, segment.to]).collect();
    Chart {
        title: title.to_owned(),
        x: Axis::new("", Extent::Fixed(0.0, SIDE)),
        y: Axis::new("", Extent::Fixed(0.0, SIDE)),
        series: vec![Series::new("", Mark::Pairs, ends)],
    }
}

fn by_tolerance() -> Chart {
    let series = [4, 6, SEGMENTS].map(|segments| {
        let draws = draws(segments);
        let rate = |degrees: u32| 100.0 * share(&draws, |draw| passes(draw, f64::from(degrees)));
        let points = (1..=15).map(|degrees| (f64::from(degrees), rate(degrees))).collect();
        Series::new(format!("{segments} segments"), Mark::Line, points)
    });
    Chart {
        title: "Random draws that pass the bare test of angles".to_owned(),
        x: Axis::new("tolerance, degrees", Extent::Data),
        y: Axis::new("passes, %", Extent::Fixed(0.0, 105.0)),
        series: series.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perpendicular_is_counted_modulo_half_a_turn() {
        let segment = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            OutlineSegment { to: (cos, sin), ..OutlineSegment::default() }
        };
        for (other, degrees, partner) in
            [(92.0, 3.0, true), (-88.0, 3.0, true), (272.0, 3.0, true), (85.0, 3.0, false), (85.0, 9.0, true)]
        {
            let draw = [segment(0.0), segment(other)];
            assert_eq!(has_partner(&draw[0], &draw, degrees), partner, "{other}° within {degrees}°");
        }
    }
}
