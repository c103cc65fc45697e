//! Pictures made smaller, for people to look at, and parts of them.

use vision::{Frame, RectPx};

/// The picture at most `width_px` wide, each pixel the mean of those it stands for.
#[must_use]
pub fn smaller(frame: &Frame, width_px: u32) -> Frame {
    if frame.width() <= width_px || width_px == 0 {
        return frame.clone();
    }
    let height_px =
        (u64::from(frame.height()) * u64::from(width_px) / u64::from(frame.width())).max(1) as u32;
    let columns = bounds(frame.width(), width_px);
    let rows = bounds(frame.height(), height_px);
    let mut rgb = Vec::with_capacity(width_px as usize * height_px as usize * 3);
    for rows in rows.windows(2) {
        for columns in columns.windows(2) {
            rgb.extend(mean(frame, columns[0]..columns[1], rows[0]..rows[1]));
        }
    }
    // As many pixels as the size says.
    Frame::from_rgb(width_px, height_px, rgb).unwrap_or_else(|_| frame.clone())
}

/// The part of the picture under `region`, as far as it lies inside.
#[must_use]
pub fn part(frame: &Frame, region: RectPx) -> Frame {
    let RectPx { x, y, width, height } = region.clipped_to(frame.size()).unwrap_or_default();
    let rows = (y..y + height).map(|row| &frame.row(row)[3 * x as usize..3 * (x + width) as usize]);
    // As many pixels as the size says.
    Frame::from_rgb(width, height, rows.flatten().copied().collect()).unwrap_or_default()
}

/// Where each of `to` pixels begins among `from`, and where the last ends.
fn bounds(from: u32, to: u32) -> Vec<u32> {
    (0..=to).map(|at| (u64::from(at) * u64::from(from) / u64::from(to)) as u32).collect()
}

fn mean(frame: &Frame, columns: std::ops::Range<u32>, rows: std::ops::Range<u32>) -> [u8; 3] {
    let count = (columns.len() * rows.len()).max(1) as u32;
    let mut sum = [0_u32; 3];
    for y in rows {
        let row = &frame.row(y)[3 * columns.start as usize..3 * columns.end as usize];
        for pixel in row.chunks_exact(3) {
            sum.iter_mut().zip(pixel).for_each(|(sum, level)| *sum += u32::from(*level));
        }
    }
    sum.map(|sum| ((sum + count / 2) / count) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_clipped() {
        let frame = Frame::from_rgb(3, 2, (0..18).collect()).unwrap();
        let right = part(&frame, RectPx { x: 2, y: 0, width: 9, height: 9 });
        assert_eq!((right.width(), right.height(), right.rgb()), (1, 2, &[6, 7, 8, 15, 16, 17][..]));
    }

    #[test]
    fn each_pixel_is_a_mean_and_small_pictures_stay() {
        let rgb = (0..4 * 2).flat_map(|at| [if at % 2 == 0 { 10 } else { 20 }; 3]).collect();
        let frame = Frame::from_rgb(4, 2, rgb).unwrap();
        let small = smaller(&frame, 2);
        assert_eq!((small.width(), small.height(), small.rgb()), (2, 1, &[15; 6][..]));
        assert_eq!(smaller(&frame, 4).rgb(), frame.rgb());
    }
}
