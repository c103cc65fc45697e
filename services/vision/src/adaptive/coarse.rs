//! What tells at a glance that no pixel of a run may be the landmark's, by comparing bytes as they lie in the frame.
//!
//! The colours that match are enclosed by simpler sets: those of a cone by a box, those of a tint by least differences
//! between channels. Bounds are rounded outwards, so a colour outside all of them matches nothing. Comparisons are done
//! for every byte of a run, the first bytes of pixels count.

use super::face::PAIRS;

/// Pixels looked at together.
pub(crate) const RUN_PX: usize = 32;
const RUN_BYTES: usize = 3 * RUN_PX;
/// Two bytes more, for the channels of the byte that is last.
const SEEN_BYTES: usize = RUN_BYTES + 2;

/// 0xff for the bytes that begin a pixel.
const PIXEL_STARTS: [u8; RUN_BYTES] = {
    let mut starts = [0; RUN_BYTES];
    let mut at = 0;
    while at < RUN_BYTES {
        starts[at] = 0xff;
        at += 3;
    }
    starts
};

/// Simple sets around all colours that match.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coarse {
    boxes: Vec<Box3>,
    tint: Option<Differences>,
}

/// Lowest level and reach of each channel.
#[derive(Clone, Copy, Debug)]
struct Box3 {
    low: [u8; RUN_BYTES],
    reach: [u8; RUN_BYTES],
}

/// By how much the first channel of each pair exceeds the second at least; 0 asks for nothing.
#[derive(Clone, Copy, Debug)]
struct Differences {
    least: [u8; 6],
}

impl Coarse {
    /// Makes these the sets around `boxes` and the tint of such differences, in the same memory.
    pub(crate) fn enclose(&mut self, boxes: impl Iterator<Item = [(f32, f32); 3]>, tint: Option<[f32; 6]>) {
        let least = |differences: [f32; 6]| Differences {
            least: differences.map(|d| d.floor().clamp(0.0, 255.0) as u8),
        };
        self.boxes.clear();
        self.boxes.extend(boxes.filter_map(Box3::new));
        self.tint = tint.map(least);
    }

    /// Whether one of the first [`RUN_PX`] of these pixels may match; where there are fewer, black ones count, too.
    #[inline(always)]
    pub(crate) fn may_match(&self, rgb: &[u8]) -> bool {
        let padded: [u8; SEEN_BYTES];
        let bytes = match rgb.first_chunk() {
            Some(bytes) => bytes,
            None => {
                let mut bytes = [0; SEEN_BYTES];
                bytes[..rgb.len()].copy_from_slice(rgb);
                padded = bytes;
                &padded
            }
        };
        let mut any = false;
        // No iterators: their closures are not compiled for the instructions of the caller.
        for bounds in &self.boxes {
            any |= bounds.holds_any(bytes);
        }
        if let Some(tint) = &self.tint {
            any |= tint.holds_any(bytes);
        }
        any
    }
}

impl Box3 {
    fn new(bounds: [(f32, f32); 3]) -> Option<Self> {
        let mut this = Self { low: [0; RUN_BYTES], reach: [0; RUN_BYTES] };
        for (channel, (low, high)) in bounds.into_iter().enumerate() {
            let (low, high) = (low.floor().max(0.0), high.ceil().min(255.0));
            if low > high {
                return None;
            }
            for at in (channel..RUN_BYTES).step_by(3) {
                (this.low[at], this.reach[at]) = (low as u8, (high - low) as u8);
            }
        }
        Some(this)
    }

    #[inline(always)]
    fn holds_any(&self, bytes: &[u8; SEEN_BYTES]) -> bool {
        let mut inside = [0_u8; SEEN_BYTES];
        for at in 0..RUN_BYTES {
            inside[at] = u8::from(bytes[at].wrapping_sub(self.low[at]) <= self.reach[at]);
        }
        let mut any = 0;
        for at in 0..RUN_BYTES {
            any |= inside[at] & inside[at + 1] & inside[at + 2] & PIXEL_STARTS[at];
        }
        any != 0
    }
}

impl Differences {
    #[inline(always)]
    fn holds_any(&self, bytes: &[u8; SEEN_BYTES]) -> bool {
        let mut inside = PIXEL_STARTS;
        for (&(a, b), &least) in PAIRS.iter().zip(&self.least) {
            if least == 0 {
                continue;
            }
            for at in 0..RUN_BYTES {
                let more = bytes[at + a].saturating_sub(bytes[at + b]);
                inside[at] &= if more >= least { 0xff } else { 0 };
            }
        }
        let mut any = 0;
        for &inside in &inside {
            any |= inside;
        }
        any != 0
    }
}
