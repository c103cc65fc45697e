//! Landmark descriptors.

use vision::learn::MAX_SHADES;
use vision::{ColorStats, Digest, Landmark, ShapeClass, WindowPx};

use super::check::{InvalidField, count_within, digest};
use super::stats::{bounded_stats, stats_to_wire};
use crate::digest::{landmark_digest, shape_number};
use crate::keys::Id;
use crate::v1;

/// The largest object that is believed, in metres.
const MAX_SIZE_M: f32 = 1_000.0;

/// The wire's form of a landmark that was published in `epoch`. The digest sent is computed, not copied.
#[must_use]
pub fn landmark_to_wire(landmark: &Landmark, epoch: u64) -> v1::Landmark {
    v1::Landmark {
        id: landmark.id.clone(),
        revision: landmark.revision,
        epoch,
        window_width_px: landmark.window_px.width.into(),
        window_height_px: landmark.window_px.height.into(),
        shades: landmark.shades.iter().map(stats_to_wire).collect(),
        tolerance: Some(stats_to_wire(&landmark.tolerance)),
        shape: shape_number(landmark.shape).into(),
        size_m: landmark.size_m,
        digest: landmark_digest(landmark).0.to_vec(),
    }
}

/// A published landmark and the epoch of its publication.
///
/// # Errors
/// The first field that is not allowed. A digest that is not that of the content counts as such.
pub fn landmark_from_wire(wire: &v1::Landmark) -> Result<(Landmark, u64), InvalidField> {
    let revision = count_within("revision", wire.revision, 1..=u64::MAX)?;
    let landmark = Landmark { revision, ..landmark_draft_from_wire(wire)? };
    let claimed = digest("digest", &wire.digest)?;
    require_digest(claimed, landmark.digest)?;
    Ok((landmark, wire.epoch))
}

/// A landmark that no leader has published yet: without a revision (0), and its digest may be left out.
///
/// # Errors
/// The first field that is not allowed. A digest that is given and is not that of the content counts as such.
pub fn landmark_draft_from_wire(wire: &v1::Landmark) -> Result<Landmark, InvalidField> {
    let mut landmark = Landmark {
        id: Id::new("id", &wire.id)?.as_str().to_owned(),
        revision: wire.revision,
        window_px: WindowPx {
            width: window_side("window_width_px", wire.window_width_px)?,
            height: window_side("window_height_px", wire.window_height_px)?,
        },
        shades: shades(&wire.shades)?,
        tolerance: bounded_stats("tolerance", wire.tolerance.as_ref())?,
        shape: shape(wire.shape)?,
        size_m: wire.size_m.map(size).transpose()?,
        digest: Digest::default(),
    };
    landmark.digest = landmark_digest(&landmark);
    if !wire.digest.is_empty() {
        require_digest(digest("digest", &wire.digest)?, landmark.digest)?;
    }
    Ok(landmark)
}

fn require_digest(claimed: Digest, computed: Digest) -> Result<(), InvalidField> {
    if claimed == computed {
        return Ok(());
    }
    let allowed = format!("{computed}, which is the digest of the content");
    Err(InvalidField::new("digest", claimed, allowed))
}

fn window_side(field: &str, side: u32) -> Result<u16, InvalidField> {
    let side = count_within(field, side.into(), 1..=WindowPx::MAX_SIDE.into())?;
    u16::try_from(side).map_err(|_| InvalidField::new(field, side, WindowPx::MAX_SIDE))
}

fn shades(wire: &[v1::ColorStats]) -> Result<Vec<ColorStats>, InvalidField> {
    if wire.is_empty() || wire.len() > MAX_SHADES {
        let value = format_args!("a list of {}", wire.len());
        return Err(InvalidField::new("shades", value, format_args!("1 to {MAX_SHADES} shades")));
    }
    let shade = |(at, stats)| bounded_stats(format_args!("shades[{at}]"), Some(stats));
    wire.iter().enumerate().map(shade).collect()
}

fn size(size_m: f32) -> Result<f32, InvalidField> {
    if size_m > 0.0 && size_m <= MAX_SIZE_M {
        return Ok(size_m);
    }
    let allowed = format_args!("greater than 0, at most {MAX_SIZE_M} metres");
    Err(InvalidField::new("size_m", format_args!("{size_m:?}"), allowed))
}

fn shape(number: i32) -> Result<ShapeClass, InvalidField> {
    Ok(match v1::ShapeClass::try_from(number) {
        Ok(v1::ShapeClass::Any) => ShapeClass::Any,
        Ok(v1::ShapeClass::Block) => ShapeClass::Block,
        Ok(v1::ShapeClass::Rectangle) => ShapeClass::Rectangle,
        Ok(v1::ShapeClass::Octagon) => ShapeClass::Octagon,
        Ok(v1::ShapeClass::Triangle) => ShapeClass::Triangle,
        Ok(v1::ShapeClass::Circle) => ShapeClass::Circle,
        Ok(v1::ShapeClass::Unspecified) | Err(_) => {
            return Err(InvalidField::new(
                "shape",
                number,
                "a ShapeClass of waymark.v1 other than UNSPECIFIED",
            ));
        }
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::arbitrary::landmarks;

    fn wire() -> v1::Landmark {
        let stats = |mean, variance| v1::ColorStats { mean: vec![mean; 3], variance: vec![variance; 3] };
        let mut wire = v1::Landmark {
            id: "red".into(),
            revision: 1,
            epoch: 3,
            window_width_px: 12,
            window_height_px: 12,
            shades: vec![stats(100.0, 50.0)],
            tolerance: Some(stats(15.0, 50.0)),
            shape: v1::ShapeClass::Block.into(),
            size_m: Some(0.4),
            digest: Vec::new(),
        };
        wire.digest = landmark_draft_from_wire(&wire).unwrap().digest.0.to_vec();
        wire
    }

    fn refusal(change: impl FnOnce(&mut v1::Landmark)) -> InvalidField {
        let mut wire = wire();
        change(&mut wire);
        landmark_from_wire(&wire).unwrap_err()
    }

    #[test]
    fn the_epoch_comes_along() {
        assert_eq!(landmark_from_wire(&wire()).unwrap().1, 3);
    }

    #[test]
    fn numbers_that_are_none_and_numbers_out_of_range_are_refused() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 1e38, 255.5] {
            assert_eq!(refusal(|wire| wire.shades[0].mean[1] = value).field, "shades[0].mean[1]");
            assert_eq!(
                refusal(|wire| wire.tolerance.as_mut().unwrap().mean[2] = value).field,
                "tolerance.mean[2]"
            );
        }
        for value in [f32::NAN, f32::INFINITY, -0.001, 16_257.0] {
            assert_eq!(refusal(|wire| wire.shades[0].variance[0] = value).field, "shades[0].variance[0]");
        }
        for value in [f32::NAN, 0.0, -1.0, f32::INFINITY, 1001.0] {
            assert_eq!(refusal(|wire| wire.size_m = Some(value)).field, "size_m");
        }
    }

    #[test]
    fn windows_without_extent_or_beyond_the_limit_are_refused() {
        for side in [0, 513, u32::MAX] {
            assert_eq!(refusal(|wire| wire.window_width_px = side).field, "window_width_px");
            let refused = refusal(|wire| wire.window_height_px = side);
            assert_eq!(refused.to_string(), format!("window_height_px is {side}; allowed: 1 to 512"));
        }
    }

    #[test]
    fn missing_parts_are_refused_rather_than_defaulted() {
        assert_eq!(refusal(|wire| wire.shades.clear()).field, "shades");
        assert_eq!(refusal(|wire| wire.shades = vec![wire.shades[0].clone(); 17]).field, "shades");
        assert_eq!(refusal(|wire| wire.tolerance = None).field, "tolerance");
        assert_eq!(refusal(|wire| wire.shades[0].mean.truncate(2)).field, "shades[0].mean");
        assert_eq!(refusal(|wire| wire.revision = 0).field, "revision");
        assert_eq!(refusal(|wire| wire.id = "Red".into()).field, "id");
    }

    #[test]
    fn unknown_enum_values_are_refused() {
        for number in [0, 7, -1, i32::MAX] {
            let refused = refusal(|wire| wire.shape = number);
            assert_eq!((refused.field.as_str(), refused.value), ("shape", number.to_string()));
        }
    }

    #[test]
    fn a_digest_of_other_content_is_refused() {
        assert_eq!(refusal(|wire| wire.digest[0] ^= 1).field, "digest");
        assert_eq!(refusal(|wire| wire.digest.clear()).field, "digest");
        assert_eq!(refusal(|wire| wire.window_width_px = 10).field, "digest");
    }

    #[test]
    fn a_draft_needs_neither_revision_nor_digest() {
        let draft = v1::Landmark { revision: 0, digest: Vec::new(), ..wire() };
        assert_eq!(landmark_draft_from_wire(&draft).unwrap().digest.0.to_vec(), wire().digest);
        let wrong = v1::Landmark { digest: vec![0; 32], ..draft };
        assert_eq!(landmark_draft_from_wire(&wrong).unwrap_err().field, "digest");
    }

    proptest! {
        #[test]
        fn every_landmark_survives_the_wire(landmark in landmarks(), epoch: u64) {
            let wire = landmark_to_wire(&landmark, epoch);
            prop_assert_eq!(landmark_from_wire(&wire), Ok((landmark, epoch)));
        }
    }
}
