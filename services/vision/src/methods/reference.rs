//! What the tests of the methods have in common: any pictures, and Fourier sums written out.

use proptest::prelude::*;

use super::border::Border;
use super::plane::Plane;

/// Planes of up to `most` × `most` pixels, some without any, with levels of several kinds.
pub(super) fn any_plane(most: u32) -> impl Strategy<Value = Plane> {
    (0..=most, 0..=most, any::<u64>(), 0u8..3).prop_map(|(width, height, seed, kind)| {
        let mut state = seed | 1;
        Plane::from_fn(crate::SizePx { width, height }, |x, y| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let noise = (state >> 40) as f32 / 65_536.0;
            match kind {
                0 => noise.floor(),
                1 => noise - 128.0,
                _ => ((x / 3 + y / 2) % 2 * 200) as f32,
            }
        })
    })
}

pub(super) fn any_border() -> impl Strategy<Value = Border> {
    prop_oneof![Just(Border::Nearest), Just(Border::Mirror), Just(Border::Wrap), Just(Border::Zero)]
}

/// Whether all values agree within `tolerance`, and the sizes exactly.
pub(super) fn assert_close(ours: &Plane, reference: &Plane, tolerance: f32) {
    assert_eq!(ours.size(), reference.size());
    let width = ours.width().max(1) as usize;
    for (at, (ours, reference)) in ours.values().iter().zip(reference.values()).enumerate() {
        let (x, y) = (at % width, at / width);
        assert!((ours - reference).abs() <= tolerance, "{ours} is not {reference} at ({x}, {y})");
    }
}
