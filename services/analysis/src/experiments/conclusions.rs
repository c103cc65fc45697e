//! The thesis's conclusions (chapter 5, and those in its chapters 3 and 4), judged by the figures found here.

use super::{Done, Place};

/// What became of a conclusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The figures say the same.
    Holds,
    /// Some figures do.
    InPart,
    /// They say otherwise.
    Fails,
}

/// A conclusion, and what the figures say of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Conclusion {
    /// In our words, with the section.
    pub statement: &'static str,
    /// What became of it.
    pub verdict: Verdict,
    /// By which figures.
    pub because: String,
}

/// Figures by place, number and quantity.
struct Figures<'a>(&'a [Done]);

impl Figures<'_> {
    fn get(&self, place: Place, number: &str, quantity: &str) -> Option<f64> {
        let done =
            self.0.iter().find(|done| done.experiment.place == place && done.experiment.number == number)?;
        done.account.comparisons.iter().find(|comparison| comparison.quantity == quantity)?.ours
    }

    fn figure(&self, number: &str, quantity: &str) -> Option<f64> {
        self.get(Place::Figure, number, quantity)
    }
}

/// Judges every conclusion for which the experiments were done.
#[must_use]
pub fn conclusions(done: &[Done]) -> Vec<Conclusion> {
    let judges: [fn(&Figures<'_>) -> Option<Conclusion>; 8] = [
        registered_in_every_frame,
        area_tells_the_distance,
        combining_ensures_the_match,
        angles_tell_the_object,
        noise_and_blur,
        octagon_when_near,
        prediction_helps,
        small_template_is_enough,
    ];
    judges.iter().filter_map(|judge| judge(&Figures(done))).collect()
}

/// Holds from `all` on, in part from `some` on.
fn graded(value: f64, all: f64, some: f64) -> Verdict {
    match value {
        value if value >= all => Verdict::Holds,
        value if value >= some => Verdict::InPart,
        _ => Verdict::Fails,
    }
}

fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}

fn registered_in_every_frame(figures: &Figures<'_>) -> Option<Conclusion> {
    let (red, blue) = (
        figures.figure("4.5", "red detection, faithful, likeliest component")?,
        figures.figure("4.7", "blue detection, faithful, likeliest component")?,
    );
    let adaptive = figures
        .figure("4.5", "red detection, adaptive")?
        .min(figures.figure("4.7", "blue detection, adaptive")?);
    let off = figures.get(Place::Section, "B, C", "red places off the track")?;
    Some(Conclusion {
        statement: "The red and the blue block were registered in every frame (chapter 5, 4.0.5).",
        verdict: graded(red.min(blue), 0.99, 0.9),
        because: format!(
            "With fixed statistics {} and {} of the frames here; the thesis's own table has {off:.0} red places that are \
             not the block. Following light and scale reaches {}.",
            percent(red),
            percent(blue),
            percent(adaptive)
        ),
    })
}

fn area_tells_the_distance(figures: &Figures<'_>) -> Option<Conclusion> {
    let (red, blue) = (figures.figure("4.5", "red area grows")?, figures.figure("4.7", "blue area grows")?);
    Some(Conclusion {
        statement: "The area generally grows as the camera comes nearer (4.0.5).",
        verdict: graded(red.min(blue), 0.9, 0.7),
        because: format!(
            "Over steps of 20 frames it grows in {} (red) and {} (blue) of them.",
            percent(red),
            percent(blue)
        ),
    })
}

fn combining_ensures_the_match(figures: &Figures<'_>) -> Option<Conclusion> {
    let leftmost = figures.figure("4.7", "blue false, as printed, leftmost component")?;
    let likeliest = figures.figure("4.7", "blue false, faithful, likeliest component")?;
    Some(Conclusion {
        statement: "Statistics and shape together ensure that the template is matched to itself (chapter 5).",
        verdict: graded(1.0 - likeliest, 0.99, 0.9),
        because: format!(
            "The blue block is confused in {} of the frames when the leftmost match is taken, in {} when size and shape \
             choose: choosing matters as much as matching.",
            percent(leftmost),
            percent(likeliest)
        ),
    })
}

fn angles_tell_the_object(figures: &Figures<'_>) -> Option<Conclusion> {
    let (at_3, at_9) =
        (figures.figure("4.1", "false passes at 3°")?, figures.figure("4.1", "false passes at 9°")?);
    Some(Conclusion {
        statement: "Perpendicular lines make it very probable that the region is the object (4.0.2).",
        verdict: graded(1.0 - at_9, 0.95, 0.5),
        because: format!(
            "Ten random segments pass the test in {} of the draws at 3° and {} at 9°.",
            percent(at_3),
            percent(at_9)
        ),
    })
}

fn noise_and_blur(figures: &Figures<'_>) -> Option<Conclusion> {
    let of = |condition: &str| figures.get(Place::Section, "5", &format!("red detection, {condition}"));
    let plain = of("as simulated")?;
    let lost = |condition: &str| Some((plain - of(condition)?).max(0.0));
    let (quantised, compressed, blurred) =
        (lost("16 levels a channel")?, lost("JPEG quality 15")?, lost("motion blur 11 px")?);
    let exposure = lost("exposure times 0.9")?.max(lost("exposure times 1.1")?);
    let worst = quantised.max(compressed).max(blurred);
    Some(Conclusion {
        statement: "Quantisation noise and blur from motion are the major sources of corrupt data (chapter 5).",
        verdict: if worst > exposure {
            Verdict::Holds
        } else if worst > 0.1 {
            Verdict::InPart
        } else {
            Verdict::Fails
        },
        because: format!(
            "Of {} detection, 16 levels a channel cost {}, JPEG of quality 15 {}, blur over 11 pixels {}; an exposure 10 % \
             off costs {}.",
            percent(plain),
            percent(quantised),
            percent(compressed),
            percent(blurred),
            percent(exposure)
        ),
    })
}

fn octagon_when_near(figures: &Figures<'_>) -> Option<Conclusion> {
    let (far, near) =
        (figures.figure("4.10", "octagon, far half")?, figures.figure("4.10", "octagon, near half")?);
    Some(Conclusion {
        statement: "Far away the stop sign is a blur and no octagon; nearer the octagon can be recognised (chapter 5).",
        verdict: if near >= 0.5 && far < near {
            Verdict::Holds
        } else if near > far {
            Verdict::InPart
        } else {
            Verdict::Fails
        },
        because: format!(
            "The outline's median fit to an octagon is {far:.2} in the far half of the drive and {near:.2} in the near one."
        ),
    })
}

fn prediction_helps(figures: &Figures<'_>) -> Option<Conclusion> {
    let rms = |method: &str| figures.figure("4.9", &format!("blue x RMS, {method}"));
    let (printed, last, gated) = (rms("printed")?, rms("persistence")?, rms("gated kalman")?);
    let faster = figures.get(Place::Section, "4.0.6", "red time, whole frame over prediction")?;
    Some(Conclusion {
        statement: "Predicting the place narrows the search and keeps false detections out; a Kalman filter would do better (4.0.6).",
        verdict: match (gated < printed && faster > 1.0, printed < last) {
            (true, true) => Verdict::Holds,
            (true, false) => Verdict::InPart,
            (false, _) => Verdict::Fails,
        },
        because: format!(
            "A gated Kalman filter misses the blue block's X by {gated:.2} px RMS and the search near it is {faster:.1} times \
             as fast; but equation 4.1 as printed, {printed:.2} px, is worse than taking the last place, {last:.2} px."
        ),
    })
}

fn small_template_is_enough(figures: &Figures<'_>) -> Option<Conclusion> {
    let (far, near) = (
        figures.figure("4.5", "red detection, far third")?,
        figures.figure("4.5", "red detection, near third")?,
    );
    Some(Conclusion {
        statement: "A template smaller than the object has minimal effect (4.0.5); but as the camera comes nearer the template is small and the gradients change (chapter 5).",
        verdict: graded(near, far.max(0.9), 0.5),
        because: format!(
            "With the template of frame 37 the red block is found in {} of the first third of the frames and in {} of the last.",
            percent(far),
            percent(near)
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conclusion_without_its_experiments_is_not_judged() {
        assert_eq!(conclusions(&[]), []);
        assert_eq!(
            [graded(1.0, 0.9, 0.5), graded(0.6, 0.9, 0.5), graded(0.1, 0.9, 0.5)],
            [Verdict::Holds, Verdict::InPart, Verdict::Fails]
        );
    }
}
