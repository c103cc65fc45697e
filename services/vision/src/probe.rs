//! Timing from outside: the shell owns the clock, the stages only say where they are.

/// A stage of one frame's path through this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Steps 2 and 4–6 of thesis 4.0.3: windowed means and variances.
    Statistics,
    /// Steps 7–9: comparison with the six parameters.
    Mask,
    /// Connected components of the mask.
    Components,
    /// The outline that feeds the Hough transform.
    Outline,
    /// Step 10.
    Hough,
    /// Steps 11 and 12.
    Shape,
    /// Step 13.
    Measure,
}

impl Stage {
    /// Every stage in the order of the path.
    pub const ALL: [Self; 7] = [
        Self::Statistics,
        Self::Mask,
        Self::Components,
        Self::Outline,
        Self::Hough,
        Self::Shape,
        Self::Measure,
    ];

    /// The name used in figures and metrics.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Statistics => "statistics",
            Self::Mask => "mask",
            Self::Components => "components",
            Self::Outline => "outline",
            Self::Hough => "hough",
            Self::Shape => "shape",
            Self::Measure => "measure",
        }
    }
}

/// Hears which stage begins and ends; the default does nothing and costs nothing.
pub trait StageProbe {
    /// `stage` begins.
    fn begin(&mut self, stage: Stage) {
        let _ = stage;
    }

    /// `stage` ends.
    fn end(&mut self, stage: Stage) {
        let _ = stage;
    }
}

/// The probe that does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProbe;

impl StageProbe for NoProbe {}
