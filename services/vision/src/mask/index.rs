//! Which of many colours accept a level: a set for every level of a channel, so that a look-up answers for all of them.

use crate::statistics::Bounds;

/// A bit for each colour.
pub(super) type Colours = u64;

/// So many colours fit into one index.
pub(super) const MOST_COLOURS: u32 = Colours::BITS;

/// For each level of a channel the colours of which something holds there.
type ByLevel = [Colours; 256];

/// Averages that up to 64 colours accept.
#[derive(Clone, Debug)]
pub(super) struct Index {
    /// Those that accept this level or a darker one.
    not_too_dark: [ByLevel; 3],
    /// Those that accept this level or a lighter one.
    not_too_light: [ByLevel; 3],
    /// Those that accept this level.
    accepting: [ByLevel; 3],
}

impl Default for Index {
    fn default() -> Self {
        let nothing = [[0; 256]; 3];
        Self { not_too_dark: nothing, not_too_light: nothing, accepting: nothing }
    }
}

impl Index {
    /// Forgets all colours.
    pub(super) fn clear(&mut self) {
        for by_level in self.not_too_dark.iter_mut().chain(&mut self.not_too_light) {
            by_level.fill(0);
        }
    }

    /// Adds a colour by what it accepts of R, G and B.
    pub(super) fn add(&mut self, colour: Colours, accepted: &[Bounds<u8>; 3]) {
        for (channel, bounds) in accepted.iter().enumerate() {
            self.not_too_dark[channel][usize::from(bounds.low)] |= colour;
            self.not_too_light[channel][usize::from(bounds.high)] |= colour;
        }
    }

    /// Ends the adding: spreads what stands at the bounds over the levels.
    #[inline(always)]
    pub(super) fn finish(&mut self) {
        let Self { not_too_dark, not_too_light, accepting } = self;
        for ((from, to), accepting) in not_too_dark.iter_mut().zip(not_too_light).zip(accepting) {
            for level in 1..from.len() {
                from[level] |= from[level - 1];
                to[255 - level] |= to[256 - level];
            }
            for ((accepting, from), to) in accepting.iter_mut().zip(from).zip(to) {
                *accepting = *from & *to;
            }
        }
    }

    /// Those that accept some level between these of a channel.
    #[inline(always)]
    pub(super) fn touching(&self, channel: usize, low: u8, high: u8) -> Colours {
        self.not_too_dark[channel][usize::from(high)] & self.not_too_light[channel][usize::from(low)]
    }

    /// Those that accept a colour.
    #[inline(always)]
    pub(super) fn accepting(&self, [red, green, blue]: [u8; 3]) -> Colours {
        let [by_red, by_green, by_blue] = &self.accepting;
        by_red[usize::from(red)] & by_green[usize::from(green)] & by_blue[usize::from(blue)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn look_ups_say_what_comparing_says(
            bounds in prop::collection::vec([(any::<u8>(), 0u8..80), (any::<u8>(), 0..80), (any::<u8>(), 0..80)], 1..=64),
            level: [u8; 3], reach in 0u8..40,
        ) {
            let bounds: Vec<_> = bounds
                .into_iter()
                .map(|channels| channels.map(|(low, reach)| Bounds { low, high: low.saturating_add(reach) }))
                .collect();
            let mut index = Index::default();
            for _ in 0..2 {
                index.clear();
                bounds.iter().enumerate().for_each(|(at, bounds)| index.add(1 << at, bounds));
                index.finish();
            }
            let high = level.map(|level| level.saturating_add(reach));
            for (at, bounds) in bounds.iter().enumerate() {
                let accepts = (0..3).all(|channel| bounds[channel].accept(level[channel]));
                prop_assert_eq!(index.accepting(level) >> at & 1 == 1, accepts);
                let touches = (0..3)
                    .all(|channel| bounds[channel].low <= high[channel] && bounds[channel].high >= level[channel]);
                let touching = (0..3).fold(Colours::MAX, |all, channel| all & index.touching(channel, level[channel], high[channel]));
                prop_assert_eq!(touching >> at & 1 == 1, touches);
            }
        }
    }
}
