//! Section 4.0.3, step 4: whether the doubled resolution helps to see the shape of a distant block (chapter 5).

use simulator::SceneKind;
use vision::doubled_grid::DoubledGrid;
use vision::hough::Hough;
use vision::mask::Masker;
use vision::outline::Outline;
use vision::{BitMask, Components, Frame, Landmark, NoProbe, RectPx, shape};

use crate::chart::{Axis, Chart, Extent, Mark, Series};
use crate::experiments::account::{Account, Thesis};
use crate::experiments::sampled::STEP;
use crate::experiments::{ExperimentError, Lab};

/// True area, and the fit of the outline to a block with and without doubling, 0 where it is too short to tell.
struct Fit {
    area_px2: f64,
    doubled: f64,
    single: f64,
}

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let fits = fits(lab)?;
    let mut account = Account::default();
    let (far, near) = fits.split_at(fits.len() / 2);
    let mut told = Vec::new();
    for (name, part, said) in
        [("far", far, "enlarges the gradients"), ("near", near, "distorts the gradients a little")]
    {
        let mean = |of: fn(&Fit) -> f64| part.iter().map(of).sum::<f64>() / part.len().max(1) as f64;
        let (doubled, single) = (mean(|fit| fit.doubled), mean(|fit| fit.single));
        let note = "mean over the frames of the half";
        account.compare(
            format!("fit to a block, {name}, doubled"),
            Thesis::Words(said),
            doubled,
            "0..1",
            note,
        );
        let note = "the same windows on every second place";
        account.compare(format!("fit to a block, {name}, not doubled"), Thesis::Silent, single, "0..1", note);
        told.push(format!(
            "{doubled:.2} on the doubled grid and {single:.2} on the original one in the {name} half"
        ));
    }
    account.sentence = format!(
        "The outline of the red block's mask fits a block with {} of the run. Doubling by nearest neighbours adds no \
         information, but lets windows begin at half pixels.",
        told.join(", with ")
    );
    let points = |of: fn(&Fit) -> f64| fits.iter().map(|fit| (fit.area_px2, of(fit))).collect();
    account.chart(&Chart {
        title: "Fit of the red block's outline to a block".to_owned(),
        x: Axis::new("true area, px²", Extent::DataFromZero),
        y: Axis::new("fit", Extent::Fixed(0.0, 1.05)),
        series: vec![
            Series::new("doubled", Mark::Dots, points(|fit| fit.doubled)),
            Series::new("not doubled", Mark::Dots, points(|fit| fit.single)),
        ],
    })?;
    Ok(account)
}

/// The fits in the sampled frames in which the mask has anything, the smallest block first.
fn fits(lab: &Lab) -> Result<Vec<Fit>, ExperimentError> {
    let (drive, landmark) = (lab.drive(SceneKind::Rink)?, lab.template(SceneKind::Rink, "red")?);
    let (mut tool, mut fits) = (Tool::default(), Vec::new());
    for number in drive.numbers().step_by(STEP) {
        let Ok(object) = drive.object(number, "red") else { continue };
        if let Some((doubled, single)) = tool.fits(&drive.frame(number)?, landmark) {
            fits.push(Fit { area_px2: object.area_px2, doubled, single });
        }
    }
    fits.sort_by(|a, b| a.area_px2.total_cmp(&b.area_px2));
    Ok(fits)
}

#[derive(Default)]
struct Tool {
    masker: Masker,
    mask: BitMask,
    components: Components,
    outline: Outline,
    hough: Hough,
}

impl Tool {
    /// The fit of the largest component with and without doubling; `None` where nothing matches.
    fn fits(&mut self, frame: &Frame, landmark: &Landmark) -> Option<(f64, f64)> {
        let grid = DoubledGrid::new(RectPx::whole(frame.size()), landmark.window_px)?;
        self.masker.find(frame, &grid, landmark, &mut self.mask, &mut NoProbe);
        let mut single = BitMask::new(self.mask.width().div_ceil(2), self.mask.height().div_ceil(2));
        for y in self.mask.touched_rows().filter(|y| y % 2 == 0) {
            for x in (0..self.mask.width()).step_by(2).filter(|&x| self.mask.get(x, y)) {
                single.set(x / 2, y / 2);
            }
        }
        let doubled = std::mem::take(&mut self.mask);
        let fit = self.fit(&doubled, landmark)?;
        self.mask = doubled;
        Some((fit, self.fit(&single, landmark).unwrap_or(0.0)))
    }

    fn fit(&mut self, mask: &BitMask, landmark: &Landmark) -> Option<f64> {
        self.components.find(mask);
        let largest = self.components.list().iter().max_by_key(|component| component.pixels)?;
        self.outline.trace(mask, self.components.runs(largest)[0]);
        let segments = self.hough.segments(&self.outline);
        Some(shape::fit(landmark.shape, &self.outline, segments).map_or(0.0, f64::from))
    }
}
