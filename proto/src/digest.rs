//! The digests of a landmark and of a set, as the comments of `landmark.proto` define them.

use sha2::{Digest as _, Sha256};
use vision::{ColorStats, Digest, Landmark, ShapeClass};

use crate::v1;

/// SHA-256 over what a landmark says, its id included and its revision left out.
#[must_use]
pub fn landmark_digest(landmark: &Landmark) -> Digest {
    let mut hash = Sha256::new();
    hash.update(little_endian_count(landmark.id.len()));
    hash.update(&landmark.id);
    hash.update(u32::from(landmark.window_px.width).to_le_bytes());
    hash.update(u32::from(landmark.window_px.height).to_le_bytes());
    hash.update(little_endian_count(landmark.shades.len()));
    for shade in &landmark.shades {
        update_with_stats(&mut hash, shade);
    }
    update_with_stats(&mut hash, &landmark.tolerance);
    hash.update((shape_number(landmark.shape) as u32).to_le_bytes());
    match landmark.size_m {
        None => hash.update([0]),
        Some(size_m) => {
            hash.update([1]);
            hash.update(size_m.to_le_bytes());
        }
    }
    Digest(hash.finalize().into())
}

/// SHA-256 over the digests of a set's landmarks, in the order given: that of their ids.
pub fn set_digest(landmarks_by_id: impl IntoIterator<Item = Digest>) -> Digest {
    let mut hash = Sha256::new();
    for digest in landmarks_by_id {
        hash.update(digest.0);
    }
    Digest(hash.finalize().into())
}

/// The wire's number of a shape class.
pub(crate) const fn shape_number(shape: ShapeClass) -> v1::ShapeClass {
    match shape {
        ShapeClass::Any => v1::ShapeClass::Any,
        ShapeClass::Block => v1::ShapeClass::Block,
        ShapeClass::Rectangle => v1::ShapeClass::Rectangle,
        ShapeClass::Octagon => v1::ShapeClass::Octagon,
        ShapeClass::Triangle => v1::ShapeClass::Triangle,
        ShapeClass::Circle => v1::ShapeClass::Circle,
    }
}

fn little_endian_count(count: usize) -> [u8; 4] {
    u32::try_from(count).unwrap_or(u32::MAX).to_le_bytes()
}

fn update_with_stats(hash: &mut Sha256, stats: &ColorStats) {
    for value in stats.mean.iter().chain(&stats.variance) {
        hash.update(value.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use vision::WindowPx;

    use super::*;

    /// The example of the comment in `landmark.proto`.
    fn documented_landmark() -> Landmark {
        Landmark {
            id: "red".into(),
            revision: 7,
            window_px: WindowPx { width: 12, height: 8 },
            shades: vec![ColorStats { mean: [176.5, 32.0, 41.25], variance: [90.0, 60.5, 55.0] }],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape: ShapeClass::Block,
            size_m: Some(0.4),
            digest: Digest::default(),
        }
    }

    #[test]
    fn the_documented_test_vector_holds() {
        let comment = include_str!("../waymark/v1/landmark.proto");
        let digest = landmark_digest(&documented_landmark()).to_string();
        assert!(comment.contains(&digest), "landmark.proto does not list {digest}");
        let set = set_digest([landmark_digest(&documented_landmark())]).to_string();
        assert!(comment.contains(&set), "landmark.proto does not list {set}");
    }

    #[test]
    fn every_field_but_the_revision_counts() {
        let original = landmark_digest(&documented_landmark());
        let changes: [fn(&mut Landmark); 8] = [
            |landmark| landmark.id.push('2'),
            |landmark| landmark.window_px.width += 1,
            |landmark| landmark.window_px.height += 1,
            |landmark| landmark.shades[0].variance[2] += 1.0,
            |landmark| landmark.shades.push(ColorStats::default()),
            |landmark| landmark.tolerance.mean[0] += 1.0,
            |landmark| landmark.shape = ShapeClass::Any,
            |landmark| landmark.size_m = None,
        ];
        for change in changes {
            let mut landmark = documented_landmark();
            change(&mut landmark);
            assert_ne!(landmark_digest(&landmark), original, "{landmark:?}");
        }
        let later = Landmark { revision: 8, ..documented_landmark() };
        assert_eq!(landmark_digest(&later), original);
    }
}
