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
    let judges: [fn(&Figures<'_>) -> Option<Conclusion>; 13] = [
        synthetic_is_easy,
        noise_and_blur,
        flow_is_difficult,
        edges_need_more,
        combining_ensures_the_match,
        registered_in_every_frame,
        doubling_helps,
        octagon_when_near,
        grey_loses_colour,
        angles_tell_the_object,
        small_template_is_enough,
        area_tells_the_distance,
        prediction_helps,
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

fn synthetic_is_easy(figures: &Figures<'_>) -> Option<Conclusion> {
    let block = figures.figure("4.3", "centre error")?;
    let synthetic = figures.figure("3.3", "its distance from the block")?;
    let acquired = figures.figure("3.7", "detection over the run, grey")?;
    let easy = block < 1.0 && synthetic < 3.0;
    Some(Conclusion {
        statement: "The methods work well on noiseless synthetic data and are troublesome on a camera's (chapter 5, 3.3).",
        verdict: match (easy, acquired < 0.9) {
            (true, true) => Verdict::Holds,
            (true, false) | (false, true) => Verdict::InPart,
            (false, false) => Verdict::Fails,
        },
        because: format!(
            "On the synthetic picture the method is {block:.2} px off and cross correlation {synthetic:.1} px; on the rink \
             cross correlation of brightness finds the red block in {} of the frames.",
            percent(acquired)
        ),
    })
}

fn flow_is_difficult(figures: &Figures<'_>) -> Option<Conclusion> {
    let moving = figures.get(Place::Section, "2.8", "pixels that move")?;
    let contrast =
        |id: &str| figures.get(Place::Section, "2.8", &format!("{id} block against its surroundings"));
    let most = contrast("red")?.max(contrast("blue")?);
    Some(Conclusion {
        statement: "Optical flow hardly registers standing objects while the camera moves, since everything moves (chapter 5).",
        verdict: if moving > 0.5 && most < 1.0 { Verdict::Holds } else { Verdict::InPart },
        because: format!(
            "{} of the rink's pixels move, and a block's flow differs from its surroundings' by at most {most:.2} px.",
            percent(moving)
        ),
    })
}

fn edges_need_more(figures: &Figures<'_>) -> Option<Conclusion> {
    let lines = figures.figure("3.6", "strongest lines on blocks")?;
    let edges = figures.figure("3.5", "strongest edges on blocks")?;
    Some(Conclusion {
        statement: "Edges and the Hough transform are a start, but register no object by themselves (chapter 5, 3.2.2).",
        verdict: graded(1.0 - lines.max(edges), 0.9, 0.5),
        because: format!(
            "On the rink {} of the strongest edges and {} of the strongest lines belong to blocks.",
            percent(edges),
            percent(lines)
        ),
    })
}

/// Fits closer than this are alike.
const CLEAR_FIT: f64 = 0.02;

fn doubling_helps(figures: &Figures<'_>) -> Option<Conclusion> {
    let fit = |part: &str, how: &str| {
        figures.get(Place::Section, "4.0.3", &format!("fit to a block, {part}, {how}"))
    };
    let (far, far_single) = (fit("far", "doubled")?, fit("far", "not doubled")?);
    let (near, near_single) = (fit("near", "doubled")?, fit("near", "not doubled")?);
    Some(Conclusion {
        statement: "Doubling the resolution helps to see the shape of a distant block, and distorts it a little when near (chapter 5).",
        verdict: match (far > far_single + CLEAR_FIT, near < near_single - CLEAR_FIT) {
            (true, true) => Verdict::Holds,
            (true, false) => Verdict::InPart,
            (false, _) => Verdict::Fails,
        },
        because: format!(
            "The outline's fit to a block is {far:.2} with doubling and {far_single:.2} without in the far half of the run, \
             {near:.2} and {near_single:.2} in the near half."
        ),
    })
}

fn grey_loses_colour(figures: &Figures<'_>) -> Option<Conclusion> {
    let of = |way: &str| figures.figure("3.7", &format!("detection over the run, {way}"));
    let (grey, colour) = (of("grey")?, of("colour")?);
    Some(Conclusion {
        statement: "Cross correlation suffers from seeing brightness only: colour is lost (3.3).",
        verdict: if colour > grey { Verdict::Holds } else { Verdict::Fails },
        because: format!(
            "With one template it finds the red block in {} of the frames by brightness and in {} by colour.",
            percent(grey),
            percent(colour)
        ),
    })
}

fn registered_in_every_frame(figures: &Figures<'_>) -> Option<Conclusion> {
    let of = |number: &str, quantity: &str| figures.figure(number, quantity);
    let likeliest = of("4.5", "red detection, faithful, likeliest component")?
        .min(of("4.7", "blue detection, faithful, likeliest component")?);
    let red = of("4.5", "red detection, as printed, leftmost component")?;
    let blue = of("4.7", "blue detection, as printed, leftmost component")?;
    let off = figures.get(Place::Section, "B, C", "red places off the track")?;
    Some(Conclusion {
        statement: "The red and the blue block were registered in every frame (chapter 5, 4.0.5).",
        verdict: match (likeliest >= 0.99, red.min(blue) >= 0.99 && off == 0.0) {
            (true, true) => Verdict::Holds,
            (true, false) => Verdict::InPart,
            (false, _) => Verdict::Fails,
        },
        because: format!(
            "Both show in the mask of {} of the frames here, but the component that the thesis took is the block in {} (red) \
             and {} (blue), and {off:.0} red places of its own table are not the block.",
            percent(likeliest),
            percent(red),
            percent(blue)
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
    let blocks = figures
        .figure("4.5", "red false, faithful, likeliest component")?
        .max(figures.figure("4.7", "blue false, faithful, likeliest component")?);
    let sign = figures.figure("4.10", "false, faithful")?;
    Some(Conclusion {
        statement: "Statistics and shape together ensure that the template is matched to itself (chapter 5).",
        verdict: match (blocks <= 0.01, sign <= 0.01) {
            (true, true) => Verdict::Holds,
            (true, false) | (false, true) => Verdict::InPart,
            (false, false) => Verdict::Fails,
        },
        because: format!(
            "With fixed statistics something else is taken for a block in {} of the frames, for the stop sign in {}.",
            percent(blocks),
            percent(sign)
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
    let far = figures.figure("4.5", "red detection, far third")?;
    let near = figures.figure("4.5", "red detection, near third")?;
    let off_px = figures.figure("4.5", "red centre error, faithful, likeliest component")?;
    let found = graded(near, far.max(0.9), 0.5);
    Some(Conclusion {
        statement: "A template smaller than the object has minimal effect (4.0.5).",
        verdict: if found == Verdict::Holds && off_px > 1.0 { Verdict::InPart } else { found },
        because: format!(
            "With the template of frame 37 the red block is found in {} of the first third of its frames and in {} of the \
             last; but its centre is {off_px:.1} px off in the median, since one face of the block matches and not all.",
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
