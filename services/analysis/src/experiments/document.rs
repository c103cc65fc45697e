//! All experiments as one HTML page that needs nothing beside itself.

use super::{Conclusion, Done, Picture, Thesis, Verdict, conclusions};
use crate::page::{Page, escaped, rounded};

/// The page.
#[must_use]
pub fn html(done: &[Done]) -> String {
    let mut page = Page::new("The thesis's experiments, done again");
    let count = |of: fn(&Done) -> usize| done.iter().map(of).sum::<usize>();
    page.paragraph(&format!(
        "{} experiments, {} figures beside the thesis's, {} pictures. The thesis's videos were not published: where it \
         used them, simulated drives with known truth stand in, so figures agree in kind, not in number. What cannot be \
         done again says so. Results that come from the thesis's own tables (Appendices B and C) can be compared exactly.",
        done.len(),
        count(|done| done.account.comparisons.len()),
        count(|done| done.account.pictures.len()),
    ));
    findings(&mut page, &conclusions(done));
    contents(&mut page, done);
    for one in done {
        experiment(&mut page, one);
    }
    page.finish()
}

/// Which of the thesis's conclusions hold.
fn findings(page: &mut Page, conclusions: &[Conclusion]) {
    if conclusions.is_empty() {
        return;
    }
    page.heading(2, "Which of the thesis's conclusions hold on these data");
    let of = |verdict: Verdict| conclusions.iter().filter(|one| one.verdict == verdict).count();
    page.paragraph(&format!(
        "Of {} conclusions, {} hold, {} hold in part and {} do not. Each verdict is computed from the figures below.",
        conclusions.len(),
        of(Verdict::Holds),
        of(Verdict::InPart),
        of(Verdict::Fails)
    ));
    page.raw("<ol class=\"verdicts\">");
    for conclusion in conclusions {
        let (class, name) = match conclusion.verdict {
            Verdict::Holds => ("yes", "holds"),
            Verdict::InPart => ("part", "in part"),
            Verdict::Fails => ("no", "does not hold"),
        };
        page.raw(&format!(
            "<li><b class=\"{class}\">{name}</b> {}<p>{}</p></li>",
            escaped(conclusion.statement),
            escaped(&conclusion.because)
        ));
    }
    page.raw("</ol>");
}

fn contents(page: &mut Page, done: &[Done]) {
    page.heading(2, "Contents");
    page.raw("<ul class=\"contents\">");
    for one in done {
        page.raw(&format!("<li><a href=\"#{}\">{}</a></li>", anchor(one), escaped(&heading(one))));
    }
    page.raw("</ul>");
}

fn experiment(page: &mut Page, done: &Done) {
    page.raw(&format!("<section id=\"{}\">", anchor(done)));
    page.heading(2, &heading(done));
    page.raw(&format!("<p class=\"says\">{}</p>", escaped(&done.account.sentence)));
    let rows = done.account.comparisons.iter().map(|comparison| {
        vec![
            comparison.quantity.clone(),
            thesis(comparison.thesis),
            comparison.ours.filter(|ours| ours.is_finite()).map_or_else(|| "–".to_owned(), rounded_small),
            comparison.unit.to_owned(),
            comparison.note.clone(),
        ]
    });
    let place =
        format!("Section {} of the thesis; {:.1} s of processor time", done.experiment.section, done.cpu_s);
    page.table(&place, &["quantity", "thesis", "ours", "unit", "note"], rows);
    pictures(page, &done.account.pictures);
    page.raw("</section>");
}

fn pictures(page: &mut Page, pictures: &[Picture]) {
    let is_drawing = |picture: &&Picture| matches!(picture, Picture::Svg { .. });
    for (class, wanted) in [("shots", false), ("plots", true)] {
        let mut shown = pictures.iter().filter(|picture| is_drawing(picture) == wanted).peekable();
        if shown.peek().is_none() {
            continue;
        }
        page.raw(&format!("<div class=\"grid {class}\">"));
        for picture in shown {
            match picture {
                Picture::Svg { svg, caption } => page.drawing(svg, caption),
                Picture::Pixels { media_type, base64, caption } => page.picture(media_type, base64, caption),
            }
        }
        page.raw("</div>");
    }
}

fn heading(done: &Done) -> String {
    format!("{} {}: {}", done.experiment.place.name(), done.experiment.number, done.experiment.title)
}

fn anchor(done: &Done) -> String {
    let number = done.experiment.number.replace([' ', ','], "");
    format!("{}-{number}", done.experiment.place.name().to_lowercase())
}

fn thesis(thesis: Thesis) -> String {
    match thesis {
        Thesis::Number(number) => rounded_small(number),
        Thesis::Words(words) => words.to_owned(),
        Thesis::Silent => "–".to_owned(),
    }
}

/// Parts of one with three places, whole numbers without any.
fn rounded_small(value: f64) -> String {
    match value {
        whole if whole.fract() == 0.0 && whole.abs() < 1e6 => format!("{whole:.0}"),
        part if part.abs() < 1.0 => format!("{part:.3}"),
        other => rounded(other),
    }
}
