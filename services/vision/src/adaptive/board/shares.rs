//! How much the pixels of a rectangle belong to a sign, and the box that they fill.

use super::field::{Area, Field};
use super::outline;
use super::{BELONGS, Board, LEAST_PX};
use crate::adaptive::memory::{CollectIn, List, Memory};
use crate::adaptive::mixture::Mixtures;
use crate::adaptive::patch::Patch;
use crate::adaptive::segment;
use crate::frame::Frame;
use crate::geometry::RectPx;

/// The smallest sum of a box.
const LEAST_SUM: f32 = 4.0;
/// Columns of a box that belong to the sign by less than this are hidden by something.
const SEEN: f32 = 0.3;
/// A pixel that belongs to the sign by this is one of it.
const OWN: f32 = 0.5;
/// What a post leaves of a sign on both sides of it differs by so much in its rows, and is so far apart, as parts of the
/// sign's height.
const POST_SLACK: f32 = 0.12;
const POST_WIDTH: f32 = 0.3;
/// Lettering is taken to be as light as the lightest of a board's pixels but for this part of them.
const GLARE: f32 = 0.03;

/// A rectangle of the frame seen as a sign's surroundings.
pub(super) struct Shares<'a> {
    frame: &'a Frame,
    mixtures: &'a Mixtures,
    rect: RectPx,
    /// How much each pixel belongs to the sign, and which part of it is lettering.
    belongs: List<'a, f32>,
    lettered: List<'a, f32>,
}

impl<'a> Shares<'a> {
    /// What lies around `bounds`.
    pub(super) fn around(
        memory: &'a Memory,
        frame: &'a Frame,
        bounds: RectPx,
        mixtures: &'a Mixtures,
    ) -> Self {
        let rect = segment::surroundings(bounds, frame);
        let pixels = rect.width as usize * rect.height as usize;
        let list = || List::with_capacity_in(pixels, memory);
        let (mut belongs, mut lettered) = (list(), list());
        for y in rect.y..rect.y + rect.height {
            let row = &frame.row(y)[3 * rect.x as usize..][..3 * rect.width as usize];
            for pixel in row.as_chunks::<3>().0 {
                let share = mixtures.share(*pixel);
                belongs.push(share.belongs);
                lettered.push(share.lettered);
            }
        }
        Self { frame, mixtures, rect, belongs, lettered }
    }

    /// The fullest box beside `others`, which are known.
    pub(super) fn board(&self, others: &[RectPx]) -> Option<Board> {
        let mut rest = self.belongs.clone();
        let width = self.rect.width as i32;
        for (x, y) in
            others.iter().flat_map(|other| self.area_of(*other).clipped(width, self.height()).places())
        {
            rest[(y * width + x) as usize] = 0.0;
        }
        let field = Field::new(width as usize, rest);
        let (fullest, sum) = field.fullest_box(BELONGS)?;
        let area = outline::plainest(&field, fullest).clipped(width, self.height());
        let large = sum >= LEAST_SUM && area.width() >= LEAST_PX.0 && area.height() >= LEAST_PX.1;
        large.then(|| self.judged(area))
    }

    /// Two boxes, the left one first, as one sign that a post stands before, where that can be: they have the same rows, and
    /// next to nothing is between them.
    pub(super) fn behind_post(
        memory: &'a Memory,
        frame: &'a Frame,
        mixtures: &'a Mixtures,
        (left, right): (RectPx, RectPx),
    ) -> Option<(Self, Board)> {
        let end = left.x + left.width;
        let height = left.height.max(right.height) as f32;
        let slack = 1 + (POST_SLACK * height) as u32;
        let same_rows = left.y.abs_diff(right.y) <= slack
            && (left.y + left.height).abs_diff(right.y + right.height) <= slack;
        if !same_rows || right.x < end || (right.x - end) as f32 > 2.0 + POST_WIDTH * height {
            return None;
        }
        let (top, bottom) = (left.y.min(right.y), (left.y + left.height).max(right.y + right.height));
        let width = right.x + right.width - left.x;
        let bounds = RectPx { x: left.x, y: top, width, height: bottom - top };
        let shares = Self::around(memory, frame, bounds, mixtures);
        let board = shares.judged(shares.area_of(bounds));
        Some((shares, board))
    }

    fn judged(&self, area: Area) -> Board {
        let (mut n, mut filled, mut pale, mut pale2) = (0.0_f32, 0.0_f32, 0.0_f32, 0.0_f32);
        for (x, y) in self.in_view(area).into_iter().flat_map(Area::places) {
            let (belongs, lettered) = (self.belongs[self.at(x, y)], self.lettered[self.at(x, y)]);
            n += 1.0;
            filled += belongs;
            pale += lettered;
            pale2 += lettered * lettered;
        }
        let n = n.max(1.0);
        let spread = (pale2 / n - (pale / n).powi(2)).max(0.0).sqrt();
        let sides = outline::beside(area).map(|side| self.mean(side));
        let around = sides.into_iter().sum::<f32>() / sides.len() as f32;
        Board { area, fill: filled / n, around, pale: pale / n, spread }
    }

    /// What of a box nothing hides: posts stand before some of its columns from top to bottom.
    fn in_view(&self, area: Area) -> List<'a, Area> {
        let mut parts: List<'_, Area> = List::new_in(self.memory());
        for x in area.left..area.right {
            let column = Area { left: x, right: x + 1, ..area };
            if self.mean(column) < SEEN {
                continue;
            }
            match parts.last_mut() {
                Some(part) if part.right == x => part.right = x + 1,
                _ => parts.push(column),
            }
        }
        parts
    }

    /// Where it lies.
    fn memory(&self) -> &'a Memory {
        self.belongs.bump()
    }

    /// How much the pixels of a box belong to the sign on average; 0 outside.
    fn mean(&self, area: Area) -> f32 {
        let area = area.clipped(self.rect.width as i32, self.height());
        let sum: f32 = area.places().map(|(x, y)| self.belongs[self.at(x, y)]).sum();
        sum / area.pixels().max(1.0)
    }

    /// A board's pixels that belong to the sign and those between them, with room around them.
    pub(super) fn patch(&self, board: &Board) -> Patch<'a> {
        let rect = segment::surroundings(self.in_frame(board), self.frame);
        let part = |area: Area| {
            let belongs = |x: i32, y: i32| {
                let (x, y) = (x + rect.x as i32 - self.rect.x as i32, y + rect.y as i32 - self.rect.y as i32);
                let inside = (area.left..area.right).contains(&x) && (area.top..area.bottom).contains(&y);
                inside && self.belongs[self.at(x, y)] >= OWN
            };
            Patch::from_fn(self.memory(), rect, belongs).convex()
        };
        let parts = self.in_view(board.area).into_iter().map(part);
        parts.fold(Patch::empty(self.memory(), rect), |all, part| all.with(&part))
    }

    /// The sign's own colour and its lettering's: that as light as any of it is seen, which is no lighter than it is.
    pub(super) fn colours(&self, board: &Board) -> ([f32; 3], [f32; 3]) {
        let pixel = |(x, y): (i32, i32)| self.frame.pixel(self.rect.x + x as u32, self.rect.y + y as u32);
        let lettered = board.area.places().filter_map(|place| self.mixtures.lettered(pixel(place)));
        let mut lettered: List<'_, f32> = lettered.collect_in(self.memory());
        let at = ((1.0 - GLARE) * lettered.len() as f32) as usize;
        let lightest =
            if at < lettered.len() { *lettered.select_nth_unstable_by(at, f32::total_cmp).1 } else { 1.0 };
        (self.mixtures.mixed(0.0), self.mixtures.mixed(lightest.max(1.0)))
    }

    /// A board as a rectangle of the frame.
    pub(super) fn in_frame(&self, board: &Board) -> RectPx {
        let Area { left, top, .. } = board.area;
        RectPx {
            x: self.rect.x + left as u32,
            y: self.rect.y + top as u32,
            width: board.area.width() as u32,
            height: board.area.height() as u32,
        }
    }

    fn area_of(&self, rect: RectPx) -> Area {
        let (left, top) = (rect.x as i32 - self.rect.x as i32, rect.y as i32 - self.rect.y as i32);
        Area { left, top, right: left + rect.width as i32, bottom: top + rect.height as i32 }
    }

    fn height(&self) -> i32 {
        self.rect.height as i32
    }

    fn at(&self, x: i32, y: i32) -> usize {
        (y * self.rect.width as i32 + x) as usize
    }
}
