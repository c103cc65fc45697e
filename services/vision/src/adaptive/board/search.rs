//! The search for boards: where pixels of the sign lie together, boxes are looked for one after the other.

use super::Board;
use super::shares::Shares;
use crate::adaptive::candidate::{Candidate, Search};
use crate::adaptive::likeness::Light;
use crate::adaptive::memory::{CollectIn, List, sorted};
use crate::adaptive::mixture::{Mixtures, TwoColours};
use crate::adaptive::patch::Patch;
use crate::adaptive::seeds::{LEAST_SEED_PX, Seeds};
use crate::adaptive::{soft_edge, window};
use crate::bitmask::BitMask;
use crate::geometry::RectPx;

/// Lights tried where nothing is known of it, over the most likely one.
const GAINS: [f32; 5] = [1.0, 0.89, 1.12, 0.8, 1.25];
/// After so many of them, what scores so much has told the light, which is nearly the same on all signs.
const LIKELY_GAINS: usize = 3;
const CLEAR_SCORE: f32 = 0.8;
/// Pixels that belong to a sign by this are seeds.
const SEED: f32 = 0.5;
/// Signs that overlap are parted in at most so many rounds.
const ROUNDS: usize = 4;
/// Of two boxes that share this part of the smaller one, only one is a sign.
const SAME: f32 = 0.3;
/// Parts on both sides of a post make a sign of at least this score.
const BEHIND_POST: f32 = 0.3;
/// A border is no wider than this part of a sign's size, nor than this, px.
const BORDER: f32 = 0.045;
const WIDEST_BORDER_PX: f32 = 4.0;

/// A candidate and its box.
type Found<'m> = (RectPx, Candidate<'m>);

/// The search under one light.
#[derive(Clone, Copy)]
struct Pass<'a> {
    search: &'a Search<'a>,
    colours: &'a TwoColours,
    mixtures: &'a Mixtures,
}

/// Adds what looks like the sign among the pixels of its tint, `like`; `belonging` and `seeds` are memory to do so.
pub(in crate::adaptive) fn find<'m>(
    search: &Search<'_>,
    like: &BitMask,
    belonging: &mut BitMask,
    seeds: &mut Seeds,
    boards: &mut List<'m, Candidate<'m>>,
) {
    let Some(face) = search.likeness.face() else { return };
    let colours = face.colours();
    let gains = if search.likeness.is_light_unknown() { &GAINS[..] } else { &GAINS[..1] };
    let mut found: List<'m, Found<'m>> = List::new_in(boards.bump());
    for (tried, gain) in gains.iter().enumerate() {
        if tried >= LIKELY_GAINS && found.iter().any(|(_, candidate)| candidate.score >= CLEAR_SCORE) {
            break;
        }
        let mixtures = colours.under(gain * search.light.gain, search.noise_variance);
        let pass = Pass { search, colours, mixtures: &mixtures };
        mark(search, like, &mixtures, belonging);
        pass.boards(belonging, seeds, &mut found);
    }
    let mut known: List<'_, RectPx> = List::new_in(boards.bump());
    for (area, candidate) in sorted(found, |a, b| b.1.score.total_cmp(&a.1.score)) {
        if !known.iter().any(|known| is_same(*known, area)) {
            known.push(area);
            boards.push(candidate);
        }
    }
}

/// The pixels of `like` that belong to the sign under one light.
fn mark(search: &Search<'_>, like: &BitMask, mixtures: &Mixtures, belonging: &mut BitMask) {
    belonging.reset(like.width(), like.height());
    for y in like.touched_rows() {
        let row = &search.frame.row(search.region.y + y)[3 * search.region.x as usize..];
        like.each_run(y, |run| {
            let pixels = row[3 * run.x_start as usize..3 * run.x_end as usize].as_chunks::<3>().0;
            for (x, pixel) in (run.x_start..).zip(pixels) {
                if mixtures.share(*pixel).belongs >= SEED {
                    belonging.set(x, y);
                }
            }
        });
    }
}

fn is_same(a: RectPx, b: RectPx) -> bool {
    let common = |a: u32, b: u32, c: u32, d: u32| (a + b).min(c + d).saturating_sub(a.max(c));
    let both = common(a.x, a.width, b.x, b.width) * common(a.y, a.height, b.y, b.height);
    both as f32 >= SAME * (a.width * a.height).min(b.width * b.height) as f32
}

impl Pass<'_> {
    /// Adds the boxes among the pixels that belong to signs.
    fn boards<'m>(&self, belonging: &mut BitMask, seeds: &mut Seeds, all: &mut List<'m, Found<'m>>) {
        let memory = all.bump();
        let (mut known, mut found) = (List::new_in(memory), List::new_in(memory));
        for round in 0..ROUNDS {
            seeds.find(belonging, LEAST_SEED_PX..=u64::MAX);
            let before = known.len();
            for at in 0..seeds.len().min(self.search.limit) {
                let (seed, scratch) = seeds.seed_and_scratch(at);
                let bounds = seed.bounds(self.search);
                // Only what is next to a box that was found may be another one.
                if round > 0 && !known.iter().any(|area| is_near(*area, bounds)) {
                    continue;
                }
                let shares = Shares::around(scratch, self.search.frame, bounds, self.mixtures);
                let Some(board) = shares.board(&known) else { continue };
                let area = shares.in_frame(&board);
                known.push(area);
                let candidate = self.candidate(&shares, &board);
                found.extend(candidate.map(|candidate| (area, candidate.kept_in(memory))));
            }
            if known.len() == before {
                break;
            }
            known[before..].iter().for_each(|area| self.clear(belonging, *area));
        }
        self.join_behind_posts(known, &mut found, seeds);
        all.append(&mut found);
    }

    /// Takes a box and what is mixed around it out of the pixels.
    fn clear(&self, belonging: &mut BitMask, area: RectPx) {
        let span = |start: u32, length: u32, from: u32, limit: u32| {
            let start = start.saturating_sub(from);
            start.saturating_sub(1).min(limit)..(start + length + 1).min(limit)
        };
        let region = self.search.region;
        let columns = span(area.x, area.width, region.x, region.width);
        for y in span(area.y, area.height, region.y, region.height) {
            belonging.clear_run(y, columns.start, columns.end);
        }
    }

    /// Takes two boxes for one sign where a post may hide what is between them.
    fn join_behind_posts<'m>(
        &self,
        known: List<'m, RectPx>,
        found: &mut List<'m, Found<'m>>,
        seeds: &mut Seeds,
    ) {
        let memory = known.bump();
        let known: List<'_, RectPx> = sorted(known, |a, b| a.x.cmp(&b.x)).collect_in(memory);
        for (at, left) in known.iter().enumerate() {
            for right in &known[at + 1..] {
                let scratch = seeds.scratch();
                let whole = Shares::behind_post(scratch, self.search.frame, self.mixtures, (*left, *right));
                let Some((shares, board)) = whole else { continue };
                let joined = self.candidate(&shares, &board);
                if let Some(joined) = joined.filter(|joined| joined.score >= BEHIND_POST) {
                    found.retain(|(area, _)| area != left && area != right);
                    found.push((shares.in_frame(&board), joined.kept_in(memory)));
                }
            }
        }
    }

    fn candidate<'s>(&self, shares: &Shares<'s>, board: &Board) -> Option<Candidate<'s>> {
        let Self { search, colours, .. } = *self;
        let object = shares.patch(board);
        let widest_px = (BORDER * (object.count() as f32).sqrt()).round().clamp(1.0, WIDEST_BORDER_PX);
        let (centroid, area_px2) =
            soft_edge::within_border(search.frame, &object, shares.colours(board), widest_px as i32)?;
        let (window_px, observed) = window::best(search, &object, area_px2)?;
        let gain = colours.gain_of(self.mean(&object));
        let score = board.score(search, colours, area_px2, gain);
        Some(Candidate {
            centroid,
            area_px2,
            light: Light { gain, haze: 0.0 },
            observed,
            window_px,
            tolerance_scale: search.likeness.tolerance_scale(search.landmark, gain),
            cut: object.touches_border(search.frame.width(), search.frame.height()),
            object,
            score,
            score_if_covered: score,
            score_if_further: score,
        })
    }

    /// The mean colour of an object without its mixed edge.
    fn mean(&self, object: &Patch<'_>) -> [f32; 3] {
        let inner = object.eroded(1);
        let inner = if inner.count() >= 6 { &inner } else { object };
        let (mut n, mut sum) = (0.0_f32, [0.0_f32; 3]);
        for (x, y) in inner.set_places() {
            let pixel = self.search.frame.pixel(object.rect.x + x as u32, object.rect.y + y as u32);
            n += 1.0;
            sum.iter_mut().zip(pixel).for_each(|(total, level)| *total += f32::from(level));
        }
        sum.map(|total| total / n.max(1.0))
    }
}

/// Whether `bounds` begin within the height of a box beside it.
fn is_near(area: RectPx, bounds: RectPx) -> bool {
    let apart = |a: u32, b: u32, c: u32, d: u32| c.saturating_sub(a + b).max(a.saturating_sub(c + d));
    let (dx, dy) = (
        apart(area.x, area.width, bounds.x, bounds.width),
        apart(area.y, area.height, bounds.y, bounds.height),
    );
    dx.max(dy) <= area.height
}
