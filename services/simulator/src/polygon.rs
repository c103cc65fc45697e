//! Convex polygons on the picture: hull, clipping, difference, area and centroid, all exact.

/// A point on the picture, frame pixels (x, y).
pub(crate) type Point = [f64; 2];

/// Pieces smaller than this are rounding, px².
const SLIVER_PX2: f64 = 1e-9;

/// Twice the signed area of a triangle; positive when the turn a → b → c goes from the x axis towards the y axis.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The convex hull (Andrew's monotone chain), turning from x towards y; empty below three points.
pub(crate) fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return Vec::new();
    }
    let mut chain = half_hull(points.iter().copied());
    chain.extend(half_hull(points.iter().rev().copied()));
    chain
}

fn half_hull(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut chain: Vec<Point> = Vec::new();
    for point in points {
        while let [.., before, last] = chain[..] {
            if turn(before, last, point) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain.pop();
    chain
}

/// The part of `polygon` on the side of the line a → b that `side` (±1) says (Sutherland and Hodgman).
fn cut(polygon: &[Point], a: Point, b: Point, side: f64) -> Vec<Point> {
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (i, &to) in polygon.iter().enumerate() {
        let from = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (before, after) = (side * turn(a, b, from), side * turn(a, b, to));
        if (before > 0.0) != (after > 0.0) {
            let at = before / (before - after);
            kept.push([from[0] + (to[0] - from[0]) * at, from[1] + (to[1] - from[1]) * at]);
        }
        if after > 0.0 {
            kept.push(to);
        }
    }
    kept
}

/// The part of `polygon` inside the rectangle from (0, 0) to (`width`, `height`).
pub(crate) fn inside_frame(polygon: &[Point], width: f64, height: f64) -> Vec<Point> {
    let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
    let mut inside =
        (0..4).fold(polygon.to_vec(), |rest, i| cut(&rest, corners[i], corners[(i + 1) % 4], 1.0));
    // Where a long edge meets the border, rounding may leave its end a hair outside.
    inside.iter_mut().for_each(|[x, y]| (*x, *y) = (x.clamp(0.0, width), y.clamp(0.0, height)));
    inside
}

/// Takes the convex `occluder` (turning from x towards y) out of the disjoint convex `pieces`.
pub(crate) fn subtract(pieces: Vec<Vec<Point>>, occluder: &[Point]) -> Vec<Vec<Point>> {
    let occluder_box = bounds(occluder);
    let mut left = Vec::with_capacity(pieces.len());
    for piece in pieces {
        if !boxes_meet(bounds(&piece), occluder_box) {
            left.push(piece);
            continue;
        }
        let mut rest = piece;
        for (i, &a) in occluder.iter().enumerate() {
            let b = occluder[(i + 1) % occluder.len()];
            let outside = cut(&rest, a, b, -1.0);
            if Moments::of(&outside).area_px2 > SLIVER_PX2 {
                left.push(outside);
            }
            rest = cut(&rest, a, b, 1.0);
        }
    }
    left
}

/// Left, top, right, bottom; inverted infinities for no points.
pub(crate) fn bounds(polygon: &[Point]) -> [f64; 4] {
    let nothing = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    polygon.iter().fold(nothing, |[left, top, right, bottom], &[x, y]| {
        [left.min(x), top.min(y), right.max(x), bottom.max(y)]
    })
}

fn boxes_meet(a: [f64; 4], b: [f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// Area and first moments; they add up over disjoint pieces.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    pub(crate) area_px2: f64,
    x: f64,
    y: f64,
}

impl Moments {
    /// By triangles from the first corner, which keeps the numbers small and the rounding with them.
    pub(crate) fn of(polygon: &[Point]) -> Self {
        let Some((&origin, others)) = polygon.split_first() else { return Self::default() };
        let mut sum = Self::default();
        for pair in others.windows(2) {
            let area = turn(origin, pair[0], pair[1]) / 2.0;
            sum.area_px2 += area;
            sum.x += area * (origin[0] + pair[0][0] + pair[1][0]) / 3.0;
            sum.y += area * (origin[1] + pair[0][1] + pair[1][1]) / 3.0;
        }
        if sum.area_px2 < 0.0 { Self { area_px2: -sum.area_px2, x: -sum.x, y: -sum.y } } else { sum }
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self { area_px2: self.area_px2 + other.area_px2, x: self.x + other.x, y: self.y + other.y }
    }

    pub(crate) fn centroid(self) -> Point {
        [self.x / self.area_px2, self.y / self.area_px2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Point; 4] = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];

    fn area(pieces: &[Vec<Point>]) -> f64 {
        pieces.iter().map(|piece| Moments::of(piece).area_px2).sum()
    }

    #[test]
    fn the_hull_drops_what_lies_inside() {
        let mut points = SQUARE.to_vec();
        points.extend([[1.0, 1.0], [2.0, 0.0], [3.0, 2.5]]);
        let hull = hull(points);
        assert_eq!(hull.len(), 4);
        assert_eq!(Moments::of(&hull).area_px2, 16.0);
        assert_eq!(Moments::of(&hull).centroid(), [2.0, 2.0]);
    }

    #[test]
    fn the_frame_cuts_a_polygon() {
        let inside = inside_frame(&[[-2.0, 1.0], [3.0, 1.0], [3.0, 9.0], [-2.0, 9.0]], 640.0, 5.0);
        assert_eq!(bounds(&inside), [0.0, 1.0, 3.0, 5.0]);
    }

    #[test]
    fn a_difference_keeps_what_is_not_covered() {
        let hole = hull(vec![[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.0, 2.0]]);
        let left = subtract(vec![SQUARE.to_vec()], &hole);
        assert!((area(&left) - 14.0).abs() < 1e-12);
        let twice = subtract(left, &hole);
        assert!((area(&twice) - 14.0).abs() < 1e-12);
        let corner = hull(vec![[3.0, 3.0], [9.0, 3.0], [9.0, 9.0], [3.0, 9.0]]);
        assert!((area(&subtract(twice, &corner)) - 13.0).abs() < 1e-12);
        assert!(subtract(vec![hole], &SQUARE).is_empty());
    }
}
