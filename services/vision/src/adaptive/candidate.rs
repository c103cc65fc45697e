//! Objects that may be the landmark, in a part of the frame.

use super::board;
use super::choose::{self, Form};
use super::disc;
use super::face::LETTERING_BRIGHTNESS;
use super::like::Marker;
use super::likeness::{Light, Likeness};
use super::memory::{List, Memory, sorted};
use super::patch::Patch;
use super::seeds::{LEAST_SEED_PX, Seeds};
use super::segment::{self, Parts, Segmented};
use super::soft_edge::{self, Edge};
use super::window;
use crate::bitmask::BitMask;
use crate::frame::Frame;
use crate::geometry::{PointPx, RectPx};
use crate::landmark::{ColorStats, Landmark, ShapeClass};

/// Seeds that fill more of the frame than this are background.
const LARGEST_SEED: f32 = 0.3;
/// Signs whose parts fill this much of their hull are filled.
const FILLED_SOLIDITY: f32 = 0.55;
/// Blocks that fill this much of their hull have no gaps.
const WHOLE_SOLIDITY: f32 = 0.8;
/// What is more like a shadow than like the landmark keeps this part of its score.
const IF_SHADOW: f32 = 0.3;
/// Haze is told from about so many pixels.
const HAZE_SAMPLES: usize = 300;
/// Seeds larger than this show an outline, px.
const DISC_SIZE_PX: u32 = 20;
/// A sign's tint is looked for pale and deep: what is pale joins with things of a similar tint, what is deep falls
/// apart on small signs.
const PALEST: [f32; 3] = [0.3, 0.45, 0.62];
/// And alone, without the sign's own shades, whose tolerances a brick wall may meet: of round signs.
const DEEP_TINT: f32 = 0.84;
/// Deeper than any colour: only the sign's own shades count, which tell it from a brick wall behind it.
const OWN_SHADES: f32 = 2.0;
/// Where something scores so much, a plain landmark is not looked for within stricter tolerances, which tell it from a
/// surface of nearly its colour.
const CLEAR_SCORE: f32 = 0.5;

/// What is searched for and where.
#[derive(Clone, Copy)]
pub(crate) struct Search<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) region: RectPx,
    pub(crate) landmark: &'a Landmark,
    pub(crate) likeness: Likeness<'a>,
    /// The light that is most likely.
    pub(crate) light: Light,
    pub(crate) noise_variance: [f32; 3],
    /// Standard deviation of the frame's blur.
    pub(crate) blur_px: f32,
    /// At most this many seeds are looked at closely.
    pub(crate) limit: usize,
}

/// One object that may be the landmark.
#[derive(Debug)]
pub(crate) struct Candidate<'m> {
    pub(crate) object: Patch<'m>,
    pub(crate) centroid: PointPx,
    pub(crate) area_px2: f32,
    /// Brightness and haze over the descriptor's.
    pub(crate) light: Light,
    /// The six statistics of its best window.
    pub(crate) observed: ColorStats,
    /// Side of that window on the doubled grid.
    pub(crate) window_px: u16,
    /// The likeness's tolerance over the descriptor's.
    pub(crate) tolerance_scale: f32,
    /// Whether the picture's border cuts it, or something covers a part of it.
    pub(crate) cut: bool,
    /// How much it looks like the landmark, 0..1.
    pub(crate) score: f32,
    /// The same if something covers a part of it.
    pub(crate) score_if_covered: f32,
    /// The same if it is one more beside others that are known.
    pub(crate) score_if_further: f32,
}

impl Candidate<'_> {
    /// The same with its pixels in memory that lasts longer.
    pub(super) fn kept_in(self, memory: &Memory) -> Candidate<'_> {
        Candidate { object: self.object.copy_in(memory), ..self }
    }

    /// Takes it for the part of a known object that something leaves in view.
    pub(crate) fn take_for_a_part(&mut self) {
        (self.cut, self.score) = (true, self.score_if_covered);
    }

    /// Whether `point` lies on the object or next to its middle.
    pub(crate) fn covers(&self, point: PointPx) -> bool {
        let near_px = 0.25 * self.area_px2.sqrt();
        let (x, y) = (point.x - self.object.rect.x as f32, point.y - self.object.rect.y as f32);
        self.centroid.distance_px(point) <= near_px || self.object.get(x.floor() as i32, y.floor() as i32)
    }
}

/// Finds candidates, with the memory to do so again and again.
#[derive(Debug, Default)]
pub(crate) struct Finder {
    marker: Marker,
    like: BitMask,
    /// What of `like` stays when paler tints do not count.
    deep: BitMask,
    seeds: Seeds,
}

impl Finder {
    /// The objects in the searched region that look like the landmark, best first.
    pub(crate) fn candidates<'m>(
        &mut self,
        search: &Search<'_>,
        memory: &'m Memory,
    ) -> List<'m, Candidate<'m>> {
        let mut found = List::new_in(memory);
        if search.likeness.face().is_none() {
            self.plain(search, &mut found);
        } else if search.landmark.shape.is_board() {
            self.boards(search, &mut found);
        } else {
            self.lettered(search, &mut found);
        }
        without_overlaps(sorted(found, |a, b| b.score.total_cmp(&a.score)), memory)
    }

    fn plain<'m>(&mut self, search: &Search<'_>, found: &mut List<'m, Candidate<'m>>) {
        let Self { marker, like, deep, seeds } = self;
        marker.mark(search.frame, search.region, &search.likeness, like);
        from_seeds(search, like, seeds, found);
        if !is_clear(found) {
            let likeness = search.likeness.stricter(found.bump());
            marker.refine(search.frame, search.region, &likeness, like, deep);
            from_seeds(&Search { likeness, ..*search }, deep, seeds, found);
        }
    }

    fn boards<'m>(&mut self, search: &Search<'_>, found: &mut List<'m, Candidate<'m>>) {
        let Self { marker, like, deep, seeds } = self;
        marker.mark(search.frame, search.region, &search.likeness.with_palest(PALEST[0]), like);
        board::find(search, like, deep, seeds, found);
    }

    fn lettered<'m>(&mut self, search: &Search<'_>, found: &mut List<'m, Candidate<'m>>) {
        let Self { marker, like, deep, seeds } = self;
        let palest = search.likeness.with_palest(PALEST[0]);
        marker.mark(search.frame, search.region, &palest, like);
        let deep_tint = search.landmark.shape.is_round().then_some(DEEP_TINT);
        for palest in PALEST.into_iter().chain(deep_tint).chain([OWN_SHADES]) {
            let likeness = search.likeness.with_palest(palest);
            let likeness = if palest == DEEP_TINT { likeness.by_tint_alone() } else { likeness };
            marker.refine(search.frame, search.region, &likeness, like, deep);
            from_seeds(&Search { likeness, ..*search }, deep, seeds, found);
        }
    }
}

fn is_clear(found: &[Candidate<'_>]) -> bool {
    found.iter().any(|known| known.score >= CLEAR_SCORE)
}

/// Adds what the connected sets of a mask are.
fn from_seeds<'m>(search: &Search<'_>, mask: &BitMask, seeds: &mut Seeds, all: &mut List<'m, Candidate<'m>>) {
    let frame_px = search.frame.width() as f32 * search.frame.height() as f32;
    seeds.find(mask, LEAST_SEED_PX..=(LARGEST_SEED * frame_px) as u64);
    let (known, memory) = (all.len(), all.bump());
    for at in 0..seeds.len().min(search.limit) {
        let (seed, scratch) = seeds.seed_and_scratch(at);
        let centre = seed.centre(search);
        if all[known..].iter().any(|known| known.covers(centre)) {
            continue;
        }
        let alone = seed.alone(search, scratch);
        let whole = seed.with_parts(search, scratch);
        let found = [candidate(search, &alone), round_candidate(search, &alone)];
        let found = found.into_iter().chain([whole.and_then(|whole| candidate(search, &whole))]);
        all.extend(found.flatten().map(|candidate| candidate.kept_in(memory)));
    }
}

fn candidate<'s>(search: &Search<'_>, seed: &Patch<'s>) -> Option<Candidate<'s>> {
    let parts = if search.landmark.shape.is_sign() { Parts::All } else { Parts::Largest };
    let Segmented { object: seen, is_shadow } = segment::object(search.frame, seed, &search.likeness, parts)?;
    let form = Form::of(&seen);
    let sign = search.landmark.shape.is_sign() && form.solidity >= FILLED_SOLIDITY;
    let (object, form) = match search.landmark.shape {
        _ if sign => (seen.convex(), form),
        ShapeClass::Block => whole_block(seen, form),
        _ => (seen, form),
    };
    let edge = if sign { border(search, &object) } else { Edge::Plain };
    let mut candidate = measured(search, object, &form, edge)?;
    if is_shadow {
        candidate.score *= IF_SHADOW;
        candidate.score_if_covered *= IF_SHADOW;
    }
    Some(candidate)
}

/// A block whose face is another colour within a frame of its own is whole when the frame goes all around, or nearly so:
/// something may cover a corner, or a gap let the background in. Faces of blocks are convex.
fn whole_block(seen: Patch<'_>, form: Form) -> (Patch<'_>, Form) {
    if form.solidity >= WHOLE_SOLIDITY {
        return (seen, form);
    }
    let whole = seen.convex();
    let border = whole.without(&whole.eroded(1));
    let near = seen.dilated((0.04 * (whole.count() as f32).sqrt()).round().max(1.0) as i32);
    let open = border.without(&near).count() as f32 / border.count().max(1) as f32;
    // The emptier the hull, the plainer that it is a frame: two blocks side by side are more than half full.
    if open > 0.5 * (1.0 - form.solidity) {
        return (seen, form);
    }
    let form = Form { solidity: 1.0 - open, ..Form::of(&whole) };
    (whole, form)
}

/// A sign too small to show its outline, near a seed.
fn round_candidate<'s>(search: &Search<'_>, seed: &Patch<'s>) -> Option<Candidate<'s>> {
    let face = search.likeness.face()?;
    let bounds = seed.bounds()?;
    if !search.landmark.shape.is_round() || bounds.width.max(bounds.height) > DISC_SIZE_PX {
        return None;
    }
    let found = disc::find(seed.memory(), search.frame, seed.rect, bounds, face)?;
    let (disc_px, seed_px) = (found.mask.count(), seed.count());
    let common_px = seed_px - seed.without(&found.mask).count();
    let fitted = Some(common_px as f32 / (disc_px + seed_px - common_px) as f32);
    let form = Form { lettering: found.lettering, fitted, ..Form::ROUND };
    let edge = border(search, &found.mask);
    let mut candidate = measured(search, found.mask, &form, edge)?;
    candidate.score *= found.clear.sqrt();
    candidate.score_if_covered *= found.clear.sqrt();
    candidate.score_if_further *= found.clear.sqrt();
    // Mixed pixels all around are most of so small a sign: the fitted disc tells its middle better than they do.
    candidate.centroid = found.centre;
    Some(candidate)
}

fn measured<'s>(search: &Search<'_>, object: Patch<'s>, form: &Form, edge: Edge) -> Option<Candidate<'s>> {
    let (centroid, area_px2) = soft_edge::centroid_and_area(search.frame, &object, edge)?;
    let (window_px, observed) = window::best(search, &object, area_px2)?;
    let factors = choose::factors(search, &object, form, area_px2, &observed);
    let cut = object.touches_border(search.frame.width(), search.frame.height());
    let seen = search.likeness.nearest(observed.mean);
    let light = Light { gain: seen.gain, haze: haze(search, &object) };
    let tolerance_scale = search.likeness.tolerance_scale(search.landmark, light.gain);
    Some(Candidate {
        object,
        centroid,
        area_px2,
        light,
        observed,
        window_px,
        tolerance_scale,
        cut,
        score: factors.whole(),
        score_if_covered: factors.covered(),
        score_if_further: factors.further(),
    })
}

/// White that the object's own colours have more than the descriptor's, levels; signs are known by their tint, which haze
/// leaves as it is.
fn haze(search: &Search<'_>, object: &Patch<'_>) -> f32 {
    if search.likeness.face().is_some() {
        return 0.0;
    }
    let (mut n, mut sum) = (0.0_f32, 0.0_f32);
    for pixel in segment::sampled(search.frame, object, HAZE_SAMPLES) {
        if search.likeness.matches(pixel) {
            sum += search.likeness.haze(pixel.map(f32::from));
            n += 1.0;
        }
    }
    if n > 0.0 { sum / n } else { search.light.haze }
}

/// A sign's border: light and without a tint, wider on larger signs.
fn border(search: &Search<'_>, object: &Patch<'_>) -> Edge {
    let brightest = search.landmark.shades.iter().flat_map(|shade| shade.mean).fold(0.0, f32::max);
    let level = (LETTERING_BRIGHTNESS * search.light.gain * brightest).min(255.0);
    let size_px = (object.count() as f32).sqrt();
    Edge::Bordered { color: [level; 3], width_px: (0.06 * size_px).round().clamp(1.0, 6.0) as i32 }
}

fn without_overlaps<'m>(
    found: impl Iterator<Item = Candidate<'m>>,
    memory: &'m Memory,
) -> List<'m, Candidate<'m>> {
    let mut kept: List<'_, Candidate<'_>> = List::new_in(memory);
    for candidate in found {
        if !kept.iter().any(|better| better.covers(candidate.centroid) || candidate.covers(better.centroid)) {
            kept.push(candidate);
        }
    }
    kept
}
