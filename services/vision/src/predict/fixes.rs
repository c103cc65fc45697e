//! The last places measured of an object.

use std::fmt;
use std::ops::Deref;

use super::Fix;

/// The last fixes, newest first, at most [`MOST`](Self::MOST). They lie in the record itself, so that an object that is
/// taken up asks for no memory.
#[derive(Clone, Copy, Default)]
pub struct Fixes {
    list: [Fix; Self::MOST],
    count: usize,
}

impl Fixes {
    /// No method looks back further.
    pub const MOST: usize = 3;

    /// Puts a newer one before the others; the oldest is forgotten where there is no room.
    pub fn push_newest(&mut self, fix: Fix) {
        self.list.rotate_right(1);
        self.list[0] = fix;
        self.count = (self.count + 1).min(Self::MOST);
    }
}

impl Deref for Fixes {
    type Target = [Fix];

    fn deref(&self) -> &[Fix] {
        &self.list[..self.count]
    }
}

/// Those that come first; further ones are left out.
impl FromIterator<Fix> for Fixes {
    fn from_iter<I: IntoIterator<Item = Fix>>(fixes: I) -> Self {
        let mut this = Self::default();
        for (place, fix) in this.list.iter_mut().zip(fixes) {
            *place = fix;
            this.count += 1;
        }
        this
    }
}

impl PartialEq for Fixes {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for Fixes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::PointPx;

    fn fix(x: f32) -> Fix {
        Fix { centroid: PointPx::new(x, 0.0), ..Fix::default() }
    }

    #[test]
    fn the_newest_come_first_and_the_oldest_go() {
        let mut fixes = Fixes::default();
        for (at, seen) in [1, 2, 3, 3, 3].into_iter().enumerate() {
            fixes.push_newest(fix(at as f32));
            assert_eq!(fixes.len(), seen);
            assert_eq!(fixes[0], fix(at as f32));
        }
        assert_eq!(fixes, [fix(4.0), fix(3.0), fix(2.0), fix(9.0)].into_iter().collect());
        assert_ne!(fixes, [fix(4.0), fix(3.0)].into_iter().collect());
    }
}
