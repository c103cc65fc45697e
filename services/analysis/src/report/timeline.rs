//! When each landmark was measured, and when and why it was not: a strip for each, time from left to right.

use std::collections::BTreeSet;

use crate::drive::CameraDrive;
use crate::page::{Page, escaped};

const WIDTH: f64 = 1000.0;

/// What a strip shows at a frame, and its colour.
const COLOURS: [(&str, &str); 9] = [
    ("measured", "#2f9e5b"),
    ("no_colour", "#d64545"),
    ("outside_frame", "#8d99ae"),
    ("outside_gate", "#e08e2b"),
    ("wrong_shape", "#b65fcf"),
    ("too_small", "#e0c12b"),
    ("occluded", "#6b4f3a"),
    ("skipped", "#4aa3df"),
    ("not registered", "#e4e8ee"),
];

/// Writes the strips of all landmarks of a camera.
pub(super) fn write(page: &mut Page, drive: &CameraDrive, ids: &[&str]) {
    page.heading(4, "Detection over time");
    let mut shown: BTreeSet<&str> = BTreeSet::new();
    let mut strips = String::from("<div class=\"strip\">");
    for id in ids {
        let states = states(drive, id);
        shown.extend(states.iter().copied());
        strips.push_str(&format!("<b>{}</b>{}", escaped(id), strip(&states)));
    }
    let last = drive.frames.len();
    strips.push_str(&format!(
        "<span></span><div class=\"axis\"><span>frame 1</span><span>{last}</span></div></div>"
    ));
    page.raw(&strips);
    let key = COLOURS.iter().filter(|(name, _)| shown.contains(name));
    let key: String = key
        .map(|(name, colour)| {
            format!("<span><i style=\"background:{colour}\"></i>{}</span>", name.replace('_', " "))
        })
        .collect();
    page.raw(&format!("<div class=\"key\">{key}</div>"));
}

fn states(drive: &CameraDrive, id: &str) -> Vec<&'static str> {
    let state = |frame: &crate::drive::DriveFrame| {
        let Some(outcome) = &frame.outcome else { return "not registered" };
        let mut of_landmark = outcome.landmarks.iter().filter(|landmark| landmark.landmark == id);
        let Some(first) = of_landmark.clone().next() else { return "not registered" };
        match (of_landmark.any(|landmark| landmark.result.is_ok()), &first.result) {
            (true, _) | (_, Ok(_)) => "measured",
            (false, Err(miss)) => miss.name(),
        }
    };
    drive.frames.values().map(state).collect()
}

/// One rectangle for each run of equal states.
fn strip(states: &[&str]) -> String {
    let scale = WIDTH / states.len().max(1) as f64;
    let (mut rectangles, mut from) = (String::new(), 0);
    for run in states.chunk_by(|a, b| a == b) {
        let colour = COLOURS.iter().find(|(name, _)| *name == run[0]).map_or("#000", |(_, colour)| colour);
        let (x, width) = (from as f64 * scale, run.len() as f64 * scale);
        rectangles.push_str(&format!(
            "<rect x=\"{x:.2}\" width=\"{width:.2}\" height=\"20\" fill=\"{colour}\"><title>frames {}–{}: {}</title></rect>",
            from + 1,
            from + run.len(),
            run[0].replace('_', " ")
        ));
        from += run.len();
    }
    format!("<svg viewBox=\"0 0 {WIDTH} 20\" preserveAspectRatio=\"none\" role=\"img\">{rectangles}</svg>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_state_are_one_rectangle() {
        let svg = strip(&["measured", "measured", "no_colour", "measured"]);
        assert_eq!(svg.matches("<rect").count(), 3);
        assert!(
            svg.contains("frames 1–2: measured") && svg.contains("x=\"500.00\" width=\"250.00\""),
            "{svg}"
        );
    }
}
