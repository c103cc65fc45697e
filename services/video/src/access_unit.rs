//! The NAL units of one picture: Annex B streams, the length-prefixed form of MP4, and what kind of picture it is.

use crate::bits::BitReader;
use crate::error::VideoError;

/// `nal_unit_type` of ITU-T H.264, Table 7-1; only those that matter here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NalKind {
    /// A slice of a picture that needs others (1).
    Slice,
    /// A slice of a picture that needs nothing before it (5).
    IdrSlice,
    /// Sequence parameter set (7).
    Sequence,
    /// Picture parameter set (8).
    Picture,
    /// Everything else: supplements, delimiters, and extensions that a base decoder leaves aside.
    Other,
}

impl NalKind {
    /// The kind of a NAL unit, by its header.
    #[must_use]
    pub fn of(nal: &[u8]) -> Self {
        match nal.first().map(|header| header & 0x1f) {
            Some(1) => Self::Slice,
            Some(5) => Self::IdrSlice,
            Some(7) => Self::Sequence,
            Some(8) => Self::Picture,
            _ => Self::Other,
        }
    }
}

/// The NAL units of an Annex B byte stream, start codes and trailing zeros taken off.
pub fn nal_units(stream: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = after_start_code(stream);
    std::iter::from_fn(move || {
        let here = rest?;
        let end = find_start_code(here);
        rest = after_start_code(&here[end..]);
        let mut nal = &here[..end];
        while let [head @ .., 0] = nal {
            nal = head;
        }
        Some(nal)
    })
    .filter(|nal| !nal.is_empty())
}

/// Where the next `00 00 01` begins, or the end.
fn find_start_code(stream: &[u8]) -> usize {
    stream.windows(3).position(|three| three == [0, 0, 1]).unwrap_or(stream.len())
}

fn after_start_code(stream: &[u8]) -> Option<&[u8]> {
    stream.get(find_start_code(stream) + 3..)
}

/// Appends `nal` to an Annex B byte stream.
pub fn append_nal(stream: &mut Vec<u8>, nal: &[u8]) {
    stream.extend_from_slice(&[0, 0, 0, 1]);
    stream.extend_from_slice(nal);
}

/// The NAL units of an MP4 sample, each behind its length in `length_bytes` bytes (ISO/IEC 14496-15, clause 5.3).
///
/// # Errors
/// When a length reaches beyond the sample.
pub fn length_prefixed(sample: &[u8], length_bytes: usize) -> Result<Vec<&[u8]>, VideoError> {
    let mut units = Vec::new();
    let mut rest = sample;
    while !rest.is_empty() {
        let cut = || VideoError::damaged("a NAL unit reaches beyond its sample");
        let (length, tail) = rest.split_at_checked(length_bytes).ok_or_else(cut)?;
        let length = length.iter().fold(0_usize, |value, &byte| value << 8 | usize::from(byte));
        let (unit, tail) = tail.split_at_checked(length).ok_or_else(cut)?;
        if !unit.is_empty() {
            units.push(unit);
        }
        rest = tail;
    }
    Ok(units)
}

/// Whether a slice is bidirectional: such pictures do not come in the order in which they are shown.
#[must_use]
pub fn is_bidirectional(slice: &[u8]) -> bool {
    let mut bits = BitReader::new(slice.get(1..).unwrap_or_default());
    let slice_type = bits.unsigned().and_then(|_first_macroblock| bits.unsigned());
    matches!(slice_type, Some(1 | 6))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_lie_between_start_codes_of_either_length() {
        let stream = [9, 9, 0, 0, 1, 0x67, 1, 0, 0, 0, 1, 0x68, 2, 0, 0, 1, 0, 0, 1, 0x65, 3, 0, 0];
        let units: Vec<&[u8]> = nal_units(&stream).collect();
        assert_eq!(units, [&[0x67, 1][..], &[0x68, 2], &[0x65, 3]]);
        let kinds: Vec<NalKind> = units.into_iter().map(NalKind::of).collect();
        assert_eq!(kinds, [NalKind::Sequence, NalKind::Picture, NalKind::IdrSlice]);
        assert_eq!(nal_units(&[0, 0, 0]).count(), 0);
    }

    #[test]
    fn length_prefixes_are_believed_only_within_the_sample() {
        let sample = [0, 0, 0, 2, 0x41, 7, 0, 0, 0, 0, 0, 0, 0, 1, 0x06];
        assert_eq!(length_prefixed(&sample, 4).unwrap(), [&[0x41, 7][..], &[0x06]]);
        assert!(length_prefixed(&sample[..9], 4).is_err());
        assert!(length_prefixed(&[0xff, 0xff, 0xff, 0xff, 1], 4).is_err());
    }

    #[test]
    fn bidirectional_slices_are_told_by_their_type() {
        assert!(is_bidirectional(&[0x01, 0b1010_0000]));
        assert!(!is_bidirectional(&[0x41, 0b1100_0000]));
        assert!(!is_bidirectional(&[0x41]));
    }
}
