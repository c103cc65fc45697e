//! Connected pixels that may be the landmark's, to be looked at closely one after the other.

use std::cmp::Reverse;
use std::ops::RangeInclusive;

use super::candidate::Search;
use super::memory::Memory;
use super::patch::Patch;
use super::segment;
use crate::bitmask::BitMask;
use crate::components::{Component, Components};
use crate::geometry::{PointPx, RectPx};

/// Fewer like pixels than this are no seed.
pub(super) const LEAST_SEED_PX: u64 = 5;
/// Parts of a sign that lettering separates lie within this many sizes of its largest part.
const PARTS_REACH: f32 = 0.5;

/// The seeds of a mask, with the memory to find them again and again.
#[derive(Debug, Default)]
pub(super) struct Seeds {
    components: Components,
    /// The numbers of the components that are seeds, the largest first.
    order: Vec<u32>,
    /// Emptied for each seed, so that it grows with what one seed takes, not with all of them.
    scratch: Memory,
}

impl Seeds {
    /// Makes these the connected sets of `mask` of so many pixels.
    pub(super) fn find(&mut self, mask: &BitMask, pixels: RangeInclusive<u64>) {
        let Self { components, order, scratch: _ } = self;
        components.find(mask);
        let list = components.list();
        order.clear();
        order.extend((0..list.len() as u32).filter(|&at| pixels.contains(&list[at as usize].pixels)));
        order.sort_unstable_by_key(|&at| (Reverse(list[at as usize].pixels), at));
    }

    pub(super) fn len(&self) -> usize {
        self.order.len()
    }

    /// Seed number `at`.
    pub(super) fn seed(&self, at: usize) -> Seed<'_> {
        let Self { components, order, scratch: _ } = self;
        Seed { component: &components.list()[order[at] as usize], components, order }
    }

    /// The same with memory for the work on it, which is empty again.
    pub(super) fn seed_and_scratch(&mut self, at: usize) -> (Seed<'_>, &Memory) {
        self.scratch.reset();
        (self.seed(at), &self.scratch)
    }

    /// Memory for the work on what is put together from several seeds, empty again.
    pub(super) fn scratch(&mut self) -> &Memory {
        self.scratch.reset();
        &self.scratch
    }
}

/// One seed among the others.
#[derive(Clone, Copy)]
pub(super) struct Seed<'a> {
    component: &'a Component,
    components: &'a Components,
    order: &'a [u32],
}

impl<'a> Seed<'a> {
    /// Centre of gravity of its pixels, in the frame.
    pub(super) fn centre(&self, search: &Search<'_>) -> PointPx {
        let (x, y) = self.component.mean_pixel();
        PointPx::new(
            (f64::from(search.region.x) + x + 0.5) as f32,
            (f64::from(search.region.y) + y + 0.5) as f32,
        )
    }

    /// The part of the frame that it spans.
    pub(super) fn bounds(&self, search: &Search<'_>) -> RectPx {
        let Component { x_start, y_start, .. } = *self.component;
        let (x, y) = (search.region.x + x_start, search.region.y + y_start);
        RectPx { x, y, width: self.component.width(), height: self.component.height() }
    }

    /// Its pixels, with room around them.
    pub(super) fn alone<'s>(&self, search: &Search<'_>, scratch: &'s Memory) -> Patch<'s> {
        self.patch_with(search, std::iter::empty(), scratch)
    }

    /// Its pixels and those of the parts of a sign that lettering separates from it, its largest one; `None` where there
    /// are none.
    pub(super) fn with_parts<'s>(&self, search: &Search<'_>, scratch: &'s Memory) -> Option<Patch<'s>> {
        if !search.landmark.shape.is_sign() {
            return None;
        }
        let others = self.order.iter().map(|&at| &self.components.list()[at as usize]);
        let parts = others.filter(|other| self.belongs(other));
        parts.clone().next()?;
        Some(self.patch_with(search, parts, scratch))
    }

    fn belongs(&self, other: &Component) -> bool {
        let seed = self.component;
        let reach = (PARTS_REACH * (seed.width().max(seed.height())) as f32) as u32;
        let apart = |a: (u32, u32), b: (u32, u32)| b.0.saturating_sub(a.1).max(a.0.saturating_sub(b.1));
        let dx = apart((seed.x_start, seed.x_end), (other.x_start, other.x_end));
        let dy = apart((seed.y_start, seed.y_end), (other.y_start, other.y_end));
        let itself =
            (seed.x_start, seed.y_start, seed.pixels) == (other.x_start, other.y_start, other.pixels);
        !itself && dx.max(dy) <= reach && 20 * other.pixels >= seed.pixels && other.pixels <= seed.pixels
    }

    fn patch_with<'s>(
        &self,
        search: &Search<'_>,
        parts: impl Iterator<Item = &'a Component> + Clone,
        scratch: &'s Memory,
    ) -> Patch<'s> {
        let all = std::iter::once(self.component).chain(parts);
        let around = |bounds: (u32, u32, u32, u32), part: &Component| {
            let (left, top) = (bounds.0.min(part.x_start), bounds.1.min(part.y_start));
            (left, top, bounds.2.max(part.x_end), bounds.3.max(part.y_end))
        };
        let (left, top, right, bottom) = all.clone().fold((u32::MAX, u32::MAX, 0, 0), around);
        let (x, y) = (search.region.x + left, search.region.y + top);
        let bounds = RectPx { x, y, width: right - left, height: bottom - top };
        let rect = segment::surroundings(bounds, search.frame);
        Patch::from_runs(scratch, rect, search.region, all.flat_map(|part| self.components.runs(part)))
    }
}
