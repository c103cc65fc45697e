//! The bound on work per frame.

/// Pixels that may still be searched in this frame.
pub(super) struct Budget {
    left_px: u64,
}

impl Budget {
    pub(super) fn new(budget_px: u64) -> Self {
        Self { left_px: budget_px }
    }

    /// Pays for a search of that many pixels; `None` when nothing is left to pay with.
    pub(super) fn spend(&mut self, pixels: u64) -> Option<()> {
        let affordable = self.left_px > 0;
        self.left_px = self.left_px.saturating_sub(pixels);
        affordable.then_some(())
    }
}
