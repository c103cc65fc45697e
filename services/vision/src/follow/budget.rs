//! The bound on work per frame.

/// Pixels that may still be searched in this frame.
pub(super) struct Budget {
    left_px: u64,
}

impl Budget {
    pub(super) fn new(budget_px: u64) -> Self {
        Self { left_px: budget_px }
    }

    pub(super) fn is_spent(&self) -> bool {
        self.left_px == 0
    }

    /// Pays for a search of that many pixels.
    pub(super) fn spend(&mut self, pixels: u64) {
        self.left_px = self.left_px.saturating_sub(pixels);
    }
}
