//! The comparison as one HTML page that needs nothing beside itself.

use super::race::{Course, Lane};
use super::{CompareError, Judge, Method, MethodFigures, Race, findings};
use crate::chart::{Chart, Extent, Mark, Series, series_colour};
use crate::page::{Page, escaped, or_dash, percent, rounded};
use crate::score::Claim;

/// Errors above this are drawn at it: they are something else.
const MOST_ERROR_PX: f64 = 30.0;

/// The page.
///
/// # Errors
/// When a chart cannot be drawn.
pub fn html(races: &[Race]) -> Result<String, CompareError> {
    let mut page = Page::new("Methods of registration, compared");
    page.paragraph(
        "Each method saw the same frames, one after the other, and claimed at most one place a frame. Processor time is \
         that of the thread, without decoding. A method that needs a picture of the object was given the first in which the \
         adaptive registration saw it.",
    );
    if races.len() > 1 {
        overview(&mut page, races);
    }
    for race in races {
        section(&mut page, race)?;
    }
    page.heading(2, "The methods");
    page.table(
        "",
        &["method", "what it does"],
        Method::ALL.map(|method| vec![method.name().to_owned(), method.says().to_owned()]),
    );
    Ok(page.finish())
}

fn title(race: &Race) -> String {
    let camera = race.camera.as_ref().map_or_else(String::new, |camera| format!(", camera {camera}"));
    format!("{} in {}{camera}", race.landmark, race.input)
}

fn overview(page: &mut Page, races: &[Race]) {
    page.heading(2, "Findings");
    for race in races {
        page.raw(&format!(
            "<p class=\"says\"><b>{}</b>: {}</p>",
            escaped(&title(race)),
            escaped(&findings(race))
        ));
    }
}

fn section(page: &mut Page, race: &Race) -> Result<(), CompareError> {
    page.heading(2, &title(race));
    page.raw(&format!("<p class=\"says\">{}</p>", escaped(&findings(race))));
    let judge = match race.judge {
        Judge::Truth => "judged by truth",
        Judge::Agreement => "without truth: judged by agreement and persistence",
    };
    let template = or_dash(race.template_frame);
    page.paragraph(&format!(
        "{} frames, {} more could not be decoded; {judge}; picture of the object from frame {template}.",
        race.frames, race.lost
    ));
    match race.judge {
        Judge::Truth => by_truth(page, &race.methods),
        Judge::Agreement => by_agreement(page, &race.methods),
    }
    key(page, &race.course);
    page.raw("<div class=\"grid plots\">");
    for chart in charts(&race.course) {
        page.drawing(&chart.svg()?, "");
    }
    page.raw("</div>");
    shots(page, race);
    Ok(())
}

fn by_truth(page: &mut Page, methods: &[MethodFigures]) {
    let rows = methods.iter().map(|figures| {
        vec![
            figures.method.to_owned(),
            percent(figures.detection_rate),
            percent(figures.false_rate),
            or_dash(figures.false_when_absent),
            or_dash(figures.centre_median_px.map(rounded)),
            or_dash(figures.centre_p95_px.map(rounded)),
            percent(figures.area_abs_median_relative),
            percent(figures.jump_rate),
            or_dash(figures.cpu_median_ms.map(rounded)),
            or_dash(figures.cpu_p95_ms.map(rounded)),
        ]
    });
    page.table(
        "Detected and false: of the frames that show at least half of the object. Centre and area: medians over right claims. CPU: median of a frame.",
        &["method", "detected", "false", "false, absent", "centre, px", "95 %", "area error", "jumps", "CPU, ms", "95 %"],
        rows,
    );
}

fn by_agreement(page: &mut Page, methods: &[MethodFigures]) {
    let rows = methods.iter().map(|figures| {
        vec![
            figures.method.to_owned(),
            percent(figures.claimed_rate),
            percent(figures.agreement_rate),
            percent(figures.jump_rate),
            or_dash(figures.cpu_median_ms.map(rounded)),
            or_dash(figures.cpu_p95_ms.map(rounded)),
        ]
    });
    page.table(
        "Agrees: of the frames in which any two methods claim the same place. Jumps: further than the object's size within a frame.",
        &["method", "claims", "agrees", "jumps", "CPU, ms", "95 %"],
        rows,
    );
}

fn charts(course: &Course) -> Vec<Chart> {
    let over_frames = |title: &str, of: &dyn Fn(&Lane) -> Vec<(f64, f64)>| {
        let series = course.lanes.iter().map(|lane| Series::new(lane.method.name(), Mark::Dots, of(lane)));
        Chart::over_frames(title, series.collect())
    };
    let claimed = |lane: &Lane, of: &dyn Fn(u64, &Claim) -> Option<f64>| -> Vec<(f64, f64)> {
        lane.claims.iter().filter_map(|(number, claim)| Some((*number as f64, of(*number, claim)?))).collect()
    };
    let mut charts = Vec::new();
    if course.truth.is_some() {
        let mut chart = over_frames("Error of the centre, px; 30 and more at the top", &|lane| {
            claimed(lane, &|number, claim| {
                let object =
                    lane.truth.as_ref()?.frames.get(&number).filter(|object| object.visible >= 0.5)?;
                Some(f64::from(claim.centre.distance_px(object.centre)).min(MOST_ERROR_PX))
            })
        });
        chart.y.extent = Extent::Fixed(0.0, MOST_ERROR_PX + 1.0);
        charts.push(chart);
    } else {
        charts.push(over_frames("Claimed x, px", &|lane| {
            claimed(lane, &|_, claim| Some(f64::from(claim.centre.x)))
        }));
        charts.push(over_frames("Claimed y, px", &|lane| {
            claimed(lane, &|_, claim| Some(f64::from(claim.centre.y)))
        }));
    }
    let mut area =
        over_frames("Area, px²", &|lane| claimed(lane, &|_, claim| Some(f64::from(claim.area_px2))));
    if let Some(truth) = &course.truth {
        let areas = truth
            .frames
            .iter()
            .filter_map(|(number, object)| Some((*number as f64, f64::from(object.area_px2?))));
        let areas: Vec<(f64, f64)> = areas.collect();
        let most = areas.iter().map(|(_, area)| *area).fold(0.0, f64::max);
        if most > 0.0 {
            area.y.extent = Extent::Fixed(0.0, 2.0 * most);
            area.series.push(Series::new("truth", Mark::Line, areas));
        }
    }
    charts.push(area);
    charts.push(over_frames("Processor time, log₁₀ ms", &|lane| {
        lane.cost_ms.iter().map(|(number, ms)| (*number as f64, ms.max(1e-3).log10())).collect()
    }));
    charts
}

/// Which colour is whose.
fn key(page: &mut Page, course: &Course) {
    let names = course.lanes.iter().map(|lane| lane.method.name());
    let keys = names.enumerate().map(|(at, name)| {
        let [red, green, blue] = series_colour(at);
        format!("<span><i style=\"background:rgb({red},{green},{blue})\"></i>{name}</span>")
    });
    page.raw(&format!("<div class=\"key\">{}</div>", keys.collect::<String>()));
}

fn shots(page: &mut Page, race: &Race) {
    if race.course.shots.is_empty() {
        return;
    }
    page.heading(4, "Frames in which the methods went worst");
    if race.course.truth.is_some() {
        page.paragraph("Squares: claims, in the colours above. White cross: truth.");
    }
    page.raw("<div class=\"grid\">");
    for shot in &race.course.shots {
        page.picture("image/jpeg", &shot.base64, &shot.caption);
    }
    page.raw("</div>");
}
