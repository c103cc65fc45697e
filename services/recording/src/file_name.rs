//! Names of recordings: `{vehicle}-{UTC time}-{number}.mcap`, with `.active` behind while being written.
//!
//! The number grows by one per file of a vehicle in a directory, so that names neither collide nor sort
//! wrongly when the wall clock jumps; the time is there for people.

use std::{cmp::Ordering, fmt};

/// Extension of a finished recording.
pub(crate) const FINISHED: &str = ".mcap";
/// Extension of a recording that is being written, or whose writer died.
pub(crate) const ACTIVE: &str = ".mcap.active";

/// Extension of a recording for the moment between its creation and its lock.
pub(crate) const STARTING: &str = ".starting";

/// The name of a recording, without extension.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct FileName {
    /// Vehicle id.
    pub vehicle: String,
    /// Start in UTC, `YYYYMMDDTHHMMSSZ`.
    pub utc: String,
    /// Place in the vehicle's series.
    pub number: u64,
}

impl FileName {
    /// A name for a file begun at `unix_ns`.
    pub fn new(vehicle: &str, unix_ns: u64, number: u64) -> Self {
        Self { vehicle: vehicle.to_owned(), utc: utc_from_unix_ns(unix_ns), number }
    }

    /// Reads a file name with either extension; `None` for anything not named by [`FileName`].
    pub fn parse(name: &str) -> Option<Self> {
        let stem = name.strip_suffix(ACTIVE).or_else(|| name.strip_suffix(FINISHED))?;
        let (rest, number) = stem.rsplit_once('-')?;
        let (vehicle, utc) = rest.rsplit_once('-')?;
        let digits = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
        let utc_is_time = utc.len() == 16
            && utc.as_bytes()[8] == b'T'
            && utc.ends_with('Z')
            && digits(&utc[..8])
            && digits(&utc[9..15]);
        (is_vehicle(vehicle) && utc_is_time && !number.is_empty() && digits(number)).then_some(())?;
        Some(Self { vehicle: vehicle.to_owned(), utc: utc.to_owned(), number: number.parse().ok()? })
    }

    /// The name while being written.
    pub fn active(&self) -> String {
        format!("{self}{ACTIVE}")
    }

    /// The name when finished.
    pub fn finished(&self) -> String {
        format!("{self}{FINISHED}")
    }
}

impl fmt::Display for FileName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}-{:04}", self.vehicle, self.utc, self.number)
    }
}

impl PartialOrd for FileName {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for FileName {
    /// By vehicle, then by age: the number decides, not the clock.
    fn cmp(&self, other: &Self) -> Ordering {
        (&self.vehicle, self.number, &self.utc).cmp(&(&other.vehicle, other.number, &other.utc))
    }
}

/// Whether `id` may stand in a file name: `[a-z0-9][a-z0-9_-]{0,62}`.
pub(crate) fn is_vehicle(id: &str) -> bool {
    let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit();
    let bytes = id.as_bytes();
    (1..=63).contains(&bytes.len())
        && plain(bytes[0])
        && bytes.iter().all(|&b| plain(b) || b == b'_' || b == b'-')
}

/// Civil UTC time. The proleptic Gregorian calendar counted from 1 March of year 0, so that the leap day
/// ends each year (Hinnant, "chrono-compatible low-level date algorithms", `civil_from_days`).
fn utc_from_unix_ns(unix_ns: u64) -> String {
    let seconds = unix_ns / 1_000_000_000;
    let (days, second) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (h, m, s) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}{month:02}{day:02}T{h:02}{m:02}{s:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_carry_civil_utc_time() {
        for (unix_s, utc) in [
            (0, "19700101T000000Z"),
            (951_827_696, "20000229T123456Z"),
            (1_709_251_199, "20240229T235959Z"),
            (1_709_251_200, "20240301T000000Z"),
            (4_102_444_800, "21000101T000000Z"),
        ] {
            assert_eq!(FileName::new("car", unix_s * 1_000_000_000, 3).utc, utc);
        }
    }

    #[test]
    fn names_survive_a_round_trip() {
        let name = FileName::new("car-1-b", 1_700_000_000_000_000_000, 12_345);
        assert_eq!(FileName::parse(&name.active()), Some(name.clone()));
        assert_eq!(FileName::parse(&name.finished()), Some(name));
    }

    #[test]
    fn foreign_names_are_left_alone() {
        for name in [
            "holiday.mcap",
            "car-20240229T235959Z-1.txt",
            "../car-20240229T235959Z-1.mcap",
            "car-20240229T235959Z-.mcap",
            "car-2024022xT235959Z-1.mcap",
            "Car-20240229T235959Z-1.mcap",
            "car-2024022\u{e9}T235959Z-1.mcap",
        ] {
            assert_eq!(FileName::parse(name), None, "{name}");
        }
    }

    #[test]
    fn the_number_orders_names_when_the_clock_steps_back() {
        let before = FileName::new("car", 7_200_000_000_000, 1);
        let after_step_back = FileName::new("car", 3_600_000_000_000, 2);
        assert!(before < after_step_back);
    }
}
