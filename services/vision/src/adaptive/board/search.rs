//! The search for boards: where pixels of the sign lie together, boxes are looked for one after the other.

use super::Board;
use super::shares::Shares;
use crate::adaptive::candidate::{Candidate, LEAST_SEED_PX, Search};
use crate::adaptive::likeness::Light;
use crate::adaptive::mixture::{Mixtures, TwoColours};
use crate::adaptive::patch::Patch;
use crate::adaptive::{soft_edge, window};
use crate::bitmask::BitMask;
use crate::components::{Component, Components};
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
type Found = (RectPx, Candidate);

/// The search under one light.
#[derive(Clone, Copy)]
struct Pass<'a> {
    search: &'a Search<'a>,
    colours: &'a TwoColours,
    mixtures: &'a Mixtures,
}

/// What looks like the sign among the pixels of its tint, `like`; `belonging` and `components` are memory to do so.
pub(in crate::adaptive) fn find(
    search: &Search<'_>,
    like: &BitMask,
    belonging: &mut BitMask,
    components: &mut Components,
) -> Vec<Candidate> {
    let Some(face) = search.likeness.face() else { return Vec::new() };
    let colours = face.colours();
    let gains = if search.likeness.is_light_unknown() { &GAINS[..] } else { &GAINS[..1] };
    let mut found: Vec<Found> = Vec::new();
    for (tried, gain) in gains.iter().enumerate() {
        if tried >= LIKELY_GAINS && found.iter().any(|(_, candidate)| candidate.score >= CLEAR_SCORE) {
            break;
        }
        let mixtures = colours.under(gain * search.light.gain, search.noise_variance);
        let pass = Pass { search, colours, mixtures: &mixtures };
        mark(search, like, &mixtures, belonging);
        found.extend(pass.boards(belonging, components));
    }
    found.sort_by(|a, b| b.1.score.total_cmp(&a.1.score));
    let mut kept: Vec<Found> = Vec::new();
    for (area, candidate) in found {
        if !kept.iter().any(|(known, _)| is_same(*known, area)) {
            kept.push((area, candidate));
        }
    }
    kept.into_iter().map(|(_, candidate)| candidate).collect()
}

/// The pixels of `like` that belong to the sign under one light.
fn mark(search: &Search<'_>, like: &BitMask, mixtures: &Mixtures, belonging: &mut BitMask) {
    belonging.reset(like.width(), like.height());
    let mut runs = Vec::new();
    for y in like.touched_rows() {
        runs.clear();
        like.append_runs(y, &mut runs);
        let row = &search.frame.row(search.region.y + y)[3 * search.region.x as usize..];
        for run in &runs {
            let pixels = row[3 * run.x_start as usize..3 * run.x_end as usize].as_chunks::<3>().0;
            for (x, pixel) in (run.x_start..).zip(pixels) {
                if mixtures.share(*pixel).belongs >= SEED {
                    belonging.set(x, y);
                }
            }
        }
    }
}

fn is_same(a: RectPx, b: RectPx) -> bool {
    let common = |a: u32, b: u32, c: u32, d: u32| (a + b).min(c + d).saturating_sub(a.max(c));
    let both = common(a.x, a.width, b.x, b.width) * common(a.y, a.height, b.y, b.height);
    both as f32 >= SAME * (a.width * a.height).min(b.width * b.height) as f32
}

impl Pass<'_> {
    /// The boxes among the pixels that belong to signs.
    fn boards(&self, belonging: &mut BitMask, components: &mut Components) -> Vec<Found> {
        let (mut known, mut found): (Vec<RectPx>, Vec<Found>) = (Vec::new(), Vec::new());
        for round in 0..ROUNDS {
            components.find(belonging);
            let mut seeds: Vec<&Component> =
                components.list().iter().filter(|seed| seed.pixels >= LEAST_SEED_PX).collect();
            seeds.sort_by_key(|seed| std::cmp::Reverse(seed.pixels));
            let before = known.len();
            for seed in seeds.iter().take(self.search.limit) {
                let bounds = self.bounds(seed);
                // Only what is next to a box that was found may be another one.
                if round > 0 && !known.iter().any(|area| is_near(*area, bounds)) {
                    continue;
                }
                let shares = Shares::around(self.search.frame, bounds, self.mixtures);
                let Some(board) = shares.board(&known) else { continue };
                let area = shares.in_frame(&board);
                known.push(area);
                found.extend(self.candidate(&shares, &board).map(|candidate| (area, candidate)));
            }
            if known.len() == before {
                break;
            }
            known[before..].iter().for_each(|area| self.clear(belonging, *area));
        }
        self.join_behind_posts(&mut known, &mut found);
        found
    }

    fn bounds(&self, seed: &Component) -> RectPx {
        let (x, y) = (self.search.region.x + seed.x_start, self.search.region.y + seed.y_start);
        RectPx { x, y, width: seed.width(), height: seed.height() }
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
    fn join_behind_posts(&self, known: &mut [RectPx], found: &mut Vec<Found>) {
        known.sort_by_key(|area| area.x);
        for (at, left) in known.iter().enumerate() {
            for right in &known[at + 1..] {
                let whole = Shares::behind_post(self.search.frame, self.mixtures, (*left, *right));
                let Some((shares, board)) = whole else { continue };
                let joined = self.candidate(&shares, &board);
                if let Some(joined) = joined.filter(|joined| joined.score >= BEHIND_POST) {
                    found.retain(|(area, _)| area != left && area != right);
                    found.push((shares.in_frame(&board), joined));
                }
            }
        }
    }

    fn candidate(&self, shares: &Shares<'_>, board: &Board) -> Option<Candidate> {
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
    fn mean(&self, object: &Patch) -> [f32; 3] {
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
