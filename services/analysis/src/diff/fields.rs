//! The fields of a result, one by one.

use vision::{ColorStats, Gate, LandmarkOutcome, Outcome, PointPx, Segment};

use super::Change;

/// What differs of the frame itself.
pub(super) fn of_frame(recorded: &Outcome, again: &Outcome) -> Vec<Change> {
    let version = |outcome: &Outcome| {
        format!("epoch {} version {}", outcome.set_version.epoch, outcome.set_version.version)
    };
    let size = |outcome: &Outcome| format!("{}x{}", outcome.frame_size.width, outcome.frame_size.height);
    let stamp = |outcome: &Outcome| format!("{} at {}", outcome.sequence, outcome.captured_at.nanos);
    let told = [
        ("set_version", version(recorded), version(again)),
        ("frame_size", size(recorded), size(again)),
        ("stamp", stamp(recorded), stamp(again)),
    ];
    let differing = told.into_iter().filter(|(_, recorded, again)| recorded != again);
    differing.map(|(field, recorded, again)| whole_frame(field, recorded, again)).collect()
}

/// A change that is no landmark's.
pub(super) fn whole_frame(field: &'static str, recorded: String, again: String) -> Change {
    Change { landmark: String::new(), instance: 0, field, recorded, again, difference: None }
}

/// An instance that only one of the results has.
pub(super) fn only(landmark: &LandmarkOutcome, recorded: &str, again: &str) -> Change {
    Change {
        landmark: landmark.landmark.clone(),
        instance: landmark.instance,
        field: "instance",
        recorded: recorded.to_owned(),
        again: again.to_owned(),
        difference: None,
    }
}

/// What differs of one instance.
pub(super) fn of_landmark(recorded: &LandmarkOutcome, again: &LandmarkOutcome) -> Vec<Change> {
    if recorded == again {
        return Vec::new();
    }
    let mut pair = Pair { recorded, again, changes: Vec::new() };
    pair.text("result", |it| {
        Some(it.result.as_ref().map_or_else(|miss| miss.name(), |_| "measured").to_owned())
    });
    if recorded.result.is_err() && again.result.is_err() {
        pair.text("miss", |it| it.result.as_ref().err().map(|miss| format!("{miss:?}")));
    }
    if recorded.result.is_ok() && again.result.is_ok() {
        pair.sighting();
    }
    pair.prior();
    pair.adaptation();
    pair.text("digest", |it| Some(it.digest.to_string()));
    if pair.changes.is_empty() {
        pair.text("other", |it| Some(format!("{it:?}")));
    }
    pair.changes
}

struct Pair<'a> {
    recorded: &'a LandmarkOutcome,
    again: &'a LandmarkOutcome,
    changes: Vec<Change>,
}

impl Pair<'_> {
    fn sighting(&mut self) {
        self.point("centroid_px", |it| it.result.as_ref().ok().map(|seen| seen.centroid));
        self.number("area_px2", |it| it.result.as_ref().ok().map(|seen| seen.area_px2));
        self.number("mask_area_2x", |it| it.result.as_ref().ok().map(|seen| seen.mask_area_2x));
        self.number("shape_score", |it| it.result.as_ref().ok().and_then(|seen| seen.shape_score));
        self.number("score", |it| it.result.as_ref().ok().map(|seen| seen.score));
        self.number("distinctness", |it| it.result.as_ref().ok().map(|seen| seen.distinctness));
        self.numbers("observed", |it| it.result.as_ref().ok().map(|seen| statistics(&seen.observed)));
        self.outline("outline_px", |it| it.result.as_ref().map_or(&[][..], |seen| &seen.outline).to_vec());
        self.outline("segments_px", |it| {
            let segments = it.result.as_ref().map_or(&[][..], |seen| &seen.segments);
            segments.iter().flat_map(|&Segment { from, to }| [from, to]).collect()
        });
    }

    fn prior(&mut self) {
        self.point("predicted_px", |it| it.prediction.map(|prior| prior.centroid));
        self.number("predicted_area_px2", |it| it.prediction.map(|prior| prior.area_px2));
        self.numbers("predicted_covariance_px2", |it| {
            it.prediction.map(|prior| prior.covariance_px2.to_vec())
        });
        self.numbers("gate_px", |it| {
            it.gate.map(|Gate { centre, radius_x_px, radius_y_px }| {
                vec![centre.x, centre.y, radius_x_px, radius_y_px]
            })
        });
        self.number("innovation_px", |it| it.innovation_px);
    }

    fn adaptation(&mut self) {
        self.number("gain", |it| it.adaptation.map(|adapted| adapted.gain));
        self.number("haze", |it| it.adaptation.map(|adapted| adapted.haze));
        self.numbers("noise_variance", |it| it.adaptation.map(|adapted| adapted.noise_variance.to_vec()));
        self.number("window_px", |it| it.adaptation.map(|adapted| adapted.window_px.into()));
        self.number("tolerance_scale", |it| it.adaptation.map(|adapted| adapted.tolerance_scale));
        self.text("full_frame", |it| it.adaptation.map(|adapted| adapted.full_frame.to_string()));
    }

    fn text(&mut self, field: &'static str, of: impl Fn(&LandmarkOutcome) -> Option<String>) {
        let (recorded, again) = (of(self.recorded), of(self.again));
        if recorded != again {
            self.change(field, recorded, again, None);
        }
    }

    fn number(&mut self, field: &'static str, of: impl Fn(&LandmarkOutcome) -> Option<f32>) {
        let (recorded, again) = (of(self.recorded), of(self.again));
        if recorded != again {
            let by = recorded.zip(again).map(|(old, new)| f64::from(new) - f64::from(old));
            let text = |number: Option<f32>| number.map(|number| number.to_string());
            self.change(field, text(recorded), text(again), by);
        }
    }

    fn point(&mut self, field: &'static str, of: impl Fn(&LandmarkOutcome) -> Option<PointPx>) {
        let (recorded, again) = (of(self.recorded), of(self.again));
        if recorded != again {
            let by = recorded.zip(again).map(|(old, new)| f64::from(old.distance_px(new)));
            let text = |point: Option<PointPx>| point.map(|point| format!("{} {}", point.x, point.y));
            self.change(field, text(recorded), text(again), by);
        }
    }

    /// The difference is that of the number which differs most.
    fn numbers(&mut self, field: &'static str, of: impl Fn(&LandmarkOutcome) -> Option<Vec<f32>>) {
        let (recorded, again) = (of(self.recorded), of(self.again));
        if recorded != again {
            let by = recorded.as_ref().zip(again.as_ref()).map(|(old, new)| {
                let each = old.iter().zip(new).map(|(old, new)| (f64::from(*new) - f64::from(*old)).abs());
                each.fold(0.0, f64::max)
            });
            let text = |numbers: Option<Vec<f32>>| {
                numbers.map(|numbers| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" "))
            };
            self.change(field, text(recorded), text(again), by);
        }
    }

    /// The difference is the largest distance of a point of either from the nearest point of the other.
    fn outline(&mut self, field: &'static str, of: impl Fn(&LandmarkOutcome) -> Vec<PointPx>) {
        let (recorded, again) = (of(self.recorded), of(self.again));
        if recorded != again {
            let by = furthest(&recorded, &again).zip(furthest(&again, &recorded)).map(|(a, b)| a.max(b));
            let text = |points: &[PointPx]| Some(format!("{} points", points.len()));
            self.change(field, text(&recorded), text(&again), by);
        }
    }

    fn change(
        &mut self,
        field: &'static str,
        recorded: Option<String>,
        again: Option<String>,
        by: Option<f64>,
    ) {
        self.changes.push(Change {
            landmark: self.recorded.landmark.clone(),
            instance: self.recorded.instance,
            field,
            recorded: recorded.unwrap_or_default(),
            again: again.unwrap_or_default(),
            difference: by,
        });
    }
}

fn statistics(stats: &ColorStats) -> Vec<f32> {
    stats.mean.into_iter().chain(stats.variance).collect()
}

fn furthest(from: &[PointPx], to: &[PointPx]) -> Option<f64> {
    let nearest =
        |point: &PointPx| to.iter().map(|other| f64::from(point.distance_px(*other))).min_by(f64::total_cmp);
    from.iter().filter_map(nearest).max_by(f64::total_cmp)
}
