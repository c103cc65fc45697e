//! Rows of numbers in pieces of sixteen, aligned to cache lines.
//!
//! Arrays by value and plain loops over them, as in `mask::chunk`: whatever the instruction set, each loop becomes a few
//! whole instructions. Neighbours come from shifting pieces, not from reading across the ends of cache lines, which
//! halves the time.

/// Numbers in a piece.
pub(super) const LANES: usize = 16;

/// Sixteen neighbouring numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(super) struct Piece(pub(super) [f32; LANES]);

/// Pieces that hold `width` numbers.
pub(super) fn pieces(width: usize) -> usize {
    width.div_ceil(LANES)
}

impl Piece {
    /// `of` each of the sixteen places.
    #[inline(always)]
    pub(super) fn each(of: impl Fn(usize) -> f32) -> Self {
        let mut piece = Self::default();
        for lane in 0..LANES {
            piece.0[lane] = of(lane);
        }
        piece
    }

    /// These numbers moved one place on, behind the last of `before`.
    #[inline(always)]
    pub(super) fn behind(&self, before: &Self) -> Self {
        Self::each(|lane| if lane == 0 { before.0[LANES - 1] } else { self.0[(lane + LANES - 1) % LANES] })
    }

    /// These numbers moved one place back, before the first of `after`.
    #[inline(always)]
    pub(super) fn ahead(&self, after: &Self) -> Self {
        Self::each(|lane| if lane == LANES - 1 { after.0[0] } else { self.0[(lane + 1) % LANES] })
    }
}

/// Writes a row into pieces; the places after its end keep what they hold.
#[inline(always)]
pub(super) fn load(row: &[f32], pieces: &mut [Piece]) {
    for (piece, values) in pieces.iter_mut().zip(row.chunks(LANES)) {
        piece.0[..values.len()].copy_from_slice(values);
    }
}

/// Reads a row out of pieces.
#[inline(always)]
pub(super) fn store(pieces: &[Piece], row: &mut [f32]) {
    for (piece, values) in pieces.iter().zip(row.chunks_mut(LANES)) {
        values.copy_from_slice(&piece.0[..values.len()]);
    }
}
