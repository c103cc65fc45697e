//! Connected components of a binary picture, by runs.

use std::cmp::Reverse;

use crate::bitmask::{BitMask, Run};

/// One 8-connected component; its runs are [`Components::runs`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    first_run: u32,
    end_run: u32,
    /// Pixels.
    pub pixels: u64,
    /// First column.
    pub x_start: u32,
    /// The column after the last one.
    pub x_end: u32,
    /// First row.
    pub y_start: u32,
    /// The row after the last one.
    pub y_end: u32,
    /// Sum of the columns of all pixels.
    pub sum_x: u64,
    /// Sum of the rows of all pixels.
    pub sum_y: u64,
}

impl Component {
    const EMPTY: Self = Self {
        first_run: 0,
        end_run: 0,
        pixels: 0,
        x_start: u32::MAX,
        x_end: 0,
        y_start: u32::MAX,
        y_end: 0,
        sum_x: 0,
        sum_y: 0,
    };

    /// Columns of its bounding box.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.x_end - self.x_start
    }

    /// Rows of its bounding box.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.y_end - self.y_start
    }

    /// Mean column and row of its pixels, by pixel number: (0, 0) is the first pixel itself, not its corner.
    #[must_use]
    pub fn mean_pixel(&self) -> (f64, f64) {
        let pixels = self.pixels as f64;
        (self.sum_x as f64 / pixels, self.sum_y as f64 / pixels)
    }

    /// Sorts the largest first, of equal ones that whose first pixel comes first.
    #[must_use]
    pub fn largest_first(&self) -> (Reverse<u64>, u32) {
        (Reverse(self.pixels), self.first_run)
    }

    fn add(&mut self, run: Run) {
        let length = u64::from(run.length());
        self.end_run += 1;
        self.pixels += length;
        self.x_start = self.x_start.min(run.x_start);
        self.x_end = self.x_end.max(run.x_end);
        self.y_start = self.y_start.min(run.y);
        self.y_end = self.y_end.max(run.y + 1);
        self.sum_x += length * (u64::from(run.x_start) + u64::from(run.x_end) - 1) / 2;
        self.sum_y += length * u64::from(run.y);
    }
}

/// The 8-connected components of a binary picture, with the memory to find them again and again.
#[derive(Clone, Debug, Default)]
pub struct Components {
    /// In raster order while components are found.
    raster: Vec<Run>,
    /// Union-find over `raster`; a root is its own parent and the first run of its set.
    parent: Vec<u32>,
    /// For each run of `raster` its component.
    label: Vec<u32>,
    /// Runs grouped by component, each group in raster order.
    grouped: Vec<Run>,
    list: Vec<Component>,
}

impl Components {
    /// Finds all components of `mask`, in the raster order of their first pixels.
    pub fn find(&mut self, mask: &BitMask) {
        self.collect_and_join(mask);
        self.label_and_measure();
        self.group();
    }

    /// The components found last.
    #[must_use]
    pub fn list(&self) -> &[Component] {
        &self.list
    }

    /// The runs of one of the components found last, rows from the top, each from the left.
    #[must_use]
    pub fn runs(&self, component: &Component) -> &[Run] {
        &self.grouped[component.first_run as usize..component.end_run as usize]
    }

    /// Collects the runs and unites those that touch a run of the row above, corners included.
    fn collect_and_join(&mut self, mask: &BitMask) {
        self.raster.clear();
        self.parent.clear();
        let mut above = 0..0;
        for y in mask.touched_rows() {
            let first = self.raster.len();
            mask.append_runs(y, &mut self.raster);
            let row = first..self.raster.len();
            self.parent.extend(row.clone().map(|run| run as u32));
            let mut candidate = above.start;
            for run in row.clone() {
                let Run { x_start, x_end, .. } = self.raster[run];
                while candidate < above.end && self.raster[candidate].x_end < x_start {
                    candidate += 1;
                }
                let mut touching = candidate;
                while touching < above.end && self.raster[touching].x_start <= x_end {
                    unite(&mut self.parent, run as u32, touching as u32);
                    touching += 1;
                }
            }
            above = row;
        }
    }

    fn label_and_measure(&mut self) {
        self.list.clear();
        self.label.clear();
        for run in 0..self.raster.len() {
            let root = root(&mut self.parent, run as u32) as usize;
            if root == run {
                self.label.push(self.list.len() as u32);
                self.list.push(Component::EMPTY);
            } else {
                self.label.push(self.label[root]);
            }
            self.list[self.label[run] as usize].add(self.raster[run]);
        }
    }

    /// Sorts the runs by component, keeping their order: a counting sort on the counts taken while measuring.
    fn group(&mut self) {
        let mut start = 0;
        for component in &mut self.list {
            let runs = component.end_run;
            component.first_run = start;
            component.end_run = start;
            start += runs;
        }
        self.grouped.clear();
        self.grouped.resize(self.raster.len(), Run::default());
        for (run, &label) in self.raster.iter().zip(&self.label) {
            let component = &mut self.list[label as usize];
            self.grouped[component.end_run as usize] = *run;
            component.end_run += 1;
        }
    }
}

/// The set's first run; halves the path on the way.
fn root(parent: &mut [u32], mut run: u32) -> u32 {
    while parent[run as usize] != run {
        parent[run as usize] = parent[parent[run as usize] as usize];
        run = parent[run as usize];
    }
    run
}

fn unite(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mask_of(width: u32, height: u32, pixels: &[bool]) -> BitMask {
        let mut mask = BitMask::new(width, height);
        for (at, _) in pixels.iter().enumerate().filter(|&(_, &set)| set) {
            mask.set(at as u32 % width, at as u32 / width);
        }
        mask
    }

    /// The obvious way: spread labels from pixel to pixel until nothing changes.
    fn labels_by_flooding(mask: &BitMask) -> Vec<Vec<(u32, u32)>> {
        let mut seen = BitMask::new(mask.width(), mask.height());
        let mut components = Vec::new();
        for (y, x) in (0..mask.height()).flat_map(|y| (0..mask.width()).map(move |x| (y, x))) {
            if !mask.get(x, y) || seen.get(x, y) {
                continue;
            }
            seen.set(x, y);
            let (mut pixels, mut next) = (vec![(y, x)], 0);
            while next < pixels.len() {
                let (py, px) = pixels[next];
                next += 1;
                for (ny, nx) in (py.saturating_sub(1)..=py + 1)
                    .flat_map(|ny| (px.saturating_sub(1)..=px + 1).map(move |nx| (ny, nx)))
                {
                    if mask.get(nx, ny) && !seen.get(nx, ny) {
                        seen.set(nx, ny);
                        pixels.push((ny, nx));
                    }
                }
            }
            pixels.sort_unstable();
            components.push(pixels);
        }
        components
    }

    proptest! {
        #[test]
        fn runs_find_what_flooding_finds(
            (width, height, pixels) in (1u32..90, 1u32..12).prop_flat_map(|(width, height)| {
                let pixels = prop::collection::vec(prop::bool::weighted(0.4), (width * height) as usize);
                (Just(width), Just(height), pixels)
            }),
        ) {
            let mask = mask_of(width, height, &pixels);
            let mut components = Components::default();
            components.find(&mask);
            let flooded = labels_by_flooding(&mask);
            prop_assert_eq!(components.list().len(), flooded.len());
            for (component, pixels) in components.list().iter().zip(flooded) {
                let ours: Vec<_> = components.runs(component).iter()
                    .flat_map(|run| (run.x_start..run.x_end).map(move |x| (run.y, x))).collect();
                prop_assert_eq!(component.pixels, pixels.len() as u64);
                prop_assert_eq!(component.sum_x, pixels.iter().map(|&(_, x)| u64::from(x)).sum::<u64>());
                prop_assert_eq!(component.sum_y, pixels.iter().map(|&(y, _)| u64::from(y)).sum::<u64>());
                prop_assert_eq!(component.x_start, pixels.iter().map(|&(_, x)| x).min().unwrap());
                prop_assert_eq!(component.x_end, pixels.iter().map(|&(_, x)| x + 1).max().unwrap());
                prop_assert_eq!((component.y_start, component.y_end), (pixels[0].0, pixels[pixels.len() - 1].0 + 1));
                prop_assert_eq!(ours, pixels);
            }
        }
    }

    #[test]
    fn corners_connect() {
        let mut mask = BitMask::new(4, 2);
        mask.set(0, 0);
        mask.set(1, 1);
        mask.set(3, 0);
        let mut components = Components::default();
        components.find(&mask);
        let pixels: Vec<_> = components.list().iter().map(|component| component.pixels).collect();
        assert_eq!(pixels, [2, 1]);
    }
}
