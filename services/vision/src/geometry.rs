//! Points, rectangles and segments in frame pixels (corner origin, x right, y down).

/// A point in frame pixels; the centre of the first pixel is (0.5, 0.5).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointPx {
    /// Column, growing to the right.
    pub x: f32,
    /// Row, growing downwards.
    pub y: f32,
}

impl PointPx {
    /// The point (`x`, `y`).
    #[must_use]
    pub const fn new(x: f32, y: f32) -> Self {
        Self { x, y }
    }

    /// Euclidean distance to `other` in pixels.
    #[must_use]
    pub fn distance_px(self, other: Self) -> f32 {
        (self.x - other.x).hypot(self.y - other.y)
    }
}

/// Width and height of a picture in whole pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SizePx {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// An axis-parallel rectangle of whole pixels: columns `x..x + width`, rows `y..y + height`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct RectPx {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl RectPx {
    /// The whole of a picture of that size.
    #[must_use]
    pub const fn whole(size: SizePx) -> Self {
        Self { x: 0, y: 0, width: size.width, height: size.height }
    }

    /// The part of this rectangle that lies inside a picture of that size, `None` where nothing does.
    #[must_use]
    pub fn clipped_to(self, size: SizePx) -> Option<Self> {
        let right = self.x.saturating_add(self.width).min(size.width);
        let bottom = self.y.saturating_add(self.height).min(size.height);
        (self.x < right && self.y < bottom).then(|| Self {
            x: self.x,
            y: self.y,
            width: right - self.x,
            height: bottom - self.y,
        })
    }
}

/// A straight piece of an outline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Segment {
    /// One end.
    pub from: PointPx,
    /// The other end.
    pub to: PointPx,
}

impl Segment {
    /// Euclidean length in pixels.
    #[must_use]
    pub fn length_px(self) -> f32 {
        self.from.distance_px(self.to)
    }

    /// Direction modulo 180°, in radians within `0..π`, measured from the x axis towards y (clockwise on the screen).
    #[must_use]
    pub fn direction_rad(self) -> f32 {
        (self.to.y - self.from.y).atan2(self.to.x - self.from.x).rem_euclid(std::f32::consts::PI)
    }
}
