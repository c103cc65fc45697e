//! What a leader tells its followers to look for.

use std::fmt;
use std::sync::Arc;

/// The six statistics of thesis 4.0.1: mean (levels) and population variance (levels²) of R, G and B.
///
/// The same shape serves for tolerances: how far each statistic may be off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ColorStats {
    /// Mean of R, G, B in 8-bit levels.
    pub mean: [f32; 3],
    /// Population variance of R, G, B in levels².
    pub variance: [f32; 3],
}

impl ColorStats {
    /// The same mean and the same variance in every channel, as Table D.1 gives tolerances.
    #[must_use]
    pub const fn uniform(mean: f32, variance: f32) -> Self {
        Self { mean: [mean; 3], variance: [variance; 3] }
    }
}

/// The averaging window of thesis 4.0.3 step 3, in samples of the doubled grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct WindowPx {
    /// N_h: columns of the doubled grid, at least 1.
    pub width: u16,
    /// M_h: rows of the doubled grid, at least 1.
    pub height: u16,
}

impl WindowPx {
    /// The largest window side that a descriptor may ask for.
    pub const MAX_SIDE: u16 = 512;

    /// A square window.
    #[must_use]
    pub const fn square(side: u16) -> Self {
        Self { width: side, height: side }
    }
}

/// The class of outline that a landmark shows when it is large enough to show one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ShapeClass {
    /// No statement about the shape.
    #[default]
    Any,
    /// Perpendicular pairs of segments (thesis 4.0.2).
    Block,
    /// Two parallel pairs, any aspect: road signs.
    Rectangle,
    /// Eight sides in steps of 45°.
    Octagon,
    /// Three sides.
    Triangle,
    /// A circle or a mildly foreshortened one.
    Circle,
}

impl ShapeClass {
    /// Every class, in the order of the wire's enum.
    pub const ALL: [Self; 6] =
        [Self::Any, Self::Block, Self::Rectangle, Self::Octagon, Self::Triangle, Self::Circle];

    /// Whether objects of this class carry lettering and a border that belong to them, as road signs do.
    #[must_use]
    pub const fn is_sign(self) -> bool {
        matches!(self, Self::Rectangle | Self::Octagon | Self::Triangle | Self::Circle)
    }

    /// Whether objects of this class are as wide as high, with no corner that stands out.
    pub(crate) const fn is_round(self) -> bool {
        matches!(self, Self::Octagon | Self::Circle)
    }

    /// Whether objects of this class are upright boxes beside roads, of which several may overlap.
    pub(crate) const fn is_board(self) -> bool {
        matches!(self, Self::Rectangle)
    }

    /// The name used on the command line and on pages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Any => "any",
            Self::Block => "block",
            Self::Rectangle => "rectangle",
            Self::Octagon => "octagon",
            Self::Triangle => "triangle",
            Self::Circle => "circle",
        }
    }
}

/// SHA-256 over a landmark's content; computed where the wire is known, opaque here.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Digest(pub [u8; 32]);

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Digest({self})")
    }
}

/// A landmark descriptor: what to look for and how exactly it must match.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// `[a-z0-9][a-z0-9_-]{0,62}`, unique in its set.
    pub id: String,
    /// Raised by the leader with every change of this landmark's content.
    pub revision: u64,
    /// The averaging window, on the doubled grid.
    pub window_px: WindowPx,
    /// One set of six statistics for each shade; the masks of all shades are united. Never empty.
    pub shades: Vec<ColorStats>,
    /// How far each statistic may be off, bounds inclusive.
    pub tolerance: ColorStats,
    /// The outline it shows when it is large enough.
    pub shape: ShapeClass,
    /// Physical width of the object in metres, where known.
    pub size_m: Option<f32>,
    /// SHA-256 of the content.
    pub digest: Digest,
}

/// Which state of the leader's set this is; a greater pair is newer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SetVersion {
    /// Counts the leader's starts.
    pub epoch: u64,
    /// Counts changes within the epoch.
    pub version: u64,
}

/// All landmarks in force at one moment, sorted by id.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LandmarkSet {
    /// The state of the leader's set.
    pub version: SetVersion,
    /// The landmarks, sorted by id.
    pub landmarks: Vec<Arc<Landmark>>,
}
