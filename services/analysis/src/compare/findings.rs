//! What the figures say, in a few sentences. Nothing here knows which method should win.

use std::cmp::Ordering;

use super::{Judge, MethodFigures, Race};

/// Detected at least so often, a method is of use.
const OF_USE: f64 = 0.9;

/// A paragraph on a race.
#[must_use]
pub fn findings(race: &Race) -> String {
    let mut said = match race.judge {
        Judge::Truth => by_truth(&race.methods),
        Judge::Agreement => by_agreement(&race.methods),
    };
    said.extend(cheapest(race));
    if race.template_frame.is_none() {
        said.push(
            "The adaptive registration never saw the object, so methods that need a picture of it had none."
                .to_owned(),
        );
    }
    said.join(" ")
}

fn rate(value: Option<f64>) -> f64 {
    value.unwrap_or(0.0)
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{:.1} %", 100.0 * value))
}

/// Who does better: found, less what is wrong; of equals, who is nearer.
fn better(a: &MethodFigures, b: &MethodFigures) -> Ordering {
    let merit = |figures: &MethodFigures| rate(figures.detection_rate) - rate(figures.false_rate);
    merit(a).total_cmp(&merit(b)).then(error_px(b).total_cmp(&error_px(a)))
}

fn error_px(figures: &MethodFigures) -> f64 {
    figures.centre_median_px.unwrap_or(f64::INFINITY)
}

fn by_truth(methods: &[MethodFigures]) -> Vec<String> {
    let mut said = Vec::new();
    let Some(best) = methods.iter().max_by(|a, b| better(a, b)) else { return said };
    said.push(format!(
        "{} does best: it finds the object in {} of the frames that show it and is wrong in {}.",
        best.method,
        percent(best.detection_rate),
        percent(best.false_rate)
    ));
    let of_use = methods.iter().filter(|figures| rate(figures.detection_rate) >= 0.5);
    let nearest = of_use.filter(|figures| figures.centre_median_px.is_some());
    if let Some(nearest) = nearest.min_by(|a, b| error_px(a).total_cmp(&error_px(b))) {
        let [median, p95] =
            [nearest.centre_median_px, nearest.centre_p95_px].map(|px| px.unwrap_or(f64::NAN));
        said.push(format!(
            "Of those that find it in half of the frames or more, {} places it best: {median:.2} px off in the median, {p95:.2} px in 95 of 100.",
            nearest.method
        ));
    }
    let worst = methods.iter().max_by(|a, b| rate(a.false_rate).total_cmp(&rate(b.false_rate)));
    if let Some(worst) = worst.filter(|worst| rate(worst.false_rate) > 0.05) {
        said.push(format!("{} is wrong most often, in {}.", worst.method, percent(worst.false_rate)));
    }
    said.extend(thesis_against_adaptive(methods));
    said
}

/// What following light and scale gains over fixed statistics.
fn thesis_against_adaptive(methods: &[MethodFigures]) -> Option<String> {
    let of = |name: &str| methods.iter().find(|figures| figures.method == name);
    let (faithful, adaptive) = (of("faithful")?, of("adaptive")?);
    let gain = 100.0 * (rate(adaptive.detection_rate) - rate(faithful.detection_rate));
    let word = if gain >= 0.0 { "gains" } else { "loses" };
    Some(format!(
        "Against the thesis's fixed statistics, adapting {word} {:.1} points of detection.",
        gain.abs()
    ))
}

fn by_agreement(methods: &[MethodFigures]) -> Vec<String> {
    let agreement = |figures: &&MethodFigures| rate(figures.agreement_rate) - rate(figures.jump_rate);
    let mut said = vec!["Nothing says where the object really was. Agreement is no truth: methods may agree on something else.".to_owned()];
    if let Some(best) = methods.iter().max_by(|a, b| agreement(a).total_cmp(&agreement(b))) {
        said.push(format!(
            "{} agrees most with the others and with itself: in {} of the frames in which any two agree, with jumps in {}.",
            best.method,
            percent(best.agreement_rate),
            percent(best.jump_rate)
        ));
    }
    if let Some(restless) = methods
        .iter()
        .filter(|figures| rate(figures.jump_rate) > 0.05)
        .max_by(|a, b| rate(a.jump_rate).total_cmp(&rate(b.jump_rate)))
    {
        said.push(format!(
            "{} jumps most, in {} of its steps.",
            restless.method,
            percent(restless.jump_rate)
        ));
    }
    said
}

/// The least costly method that is of use, and what the best one costs.
fn cheapest(race: &Race) -> Option<String> {
    let found = |figures: &&MethodFigures| match race.judge {
        Judge::Truth => rate(figures.detection_rate) >= OF_USE && rate(figures.false_rate) <= 1.0 - OF_USE,
        Judge::Agreement => rate(figures.agreement_rate) >= OF_USE,
    };
    let cost = |figures: &&MethodFigures| figures.cpu_median_ms.unwrap_or(f64::INFINITY);
    let cheapest = race.methods.iter().filter(found).min_by(|a, b| cost(a).total_cmp(&cost(b)));
    Some(match cheapest {
        Some(cheapest) => format!(
            "Of those right in nine frames of ten, {} is the cheapest: {:.2} ms of processor time a frame.",
            cheapest.method, cheapest.cpu_median_ms?
        ),
        None => "None is right in nine frames of ten.".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_that_find_all_the_nearer_one_does_best() {
        let method = |method, detection_rate, centre_median_px| MethodFigures {
            method,
            detection_rate: Some(detection_rate),
            false_rate: Some(0.0),
            centre_median_px: Some(centre_median_px),
            centre_p95_px: Some(9.0),
            ..MethodFigures::default()
        };
        let said = by_truth(&[method("near", 1.0, 0.2), method("far", 1.0, 3.0), method("rare", 0.3, 0.1)]);
        assert!(said[0].starts_with("near does best"), "{said:?}");
        assert!(said[1].contains("near places it best"), "{said:?}");
    }
}
