//! Names of fleets, vehicles, cameras, landmarks, routes and instances.

use std::fmt;

/// A name that is safe as a chunk of a key expression, a file name and a metric's label: `[a-z0-9][a-z0-9_-]{0,62}`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id(String);

/// A name that is no [`Id`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} is {value:?}; allowed: {}", Id::ALLOWED)]
pub struct InvalidId {
    /// What the name was to name.
    pub field: &'static str,
    /// The name.
    pub value: String,
}

impl Id {
    /// What an id may look like, for people.
    pub const ALLOWED: &'static str = "[a-z0-9][a-z0-9_-]{0,62}";
    /// The longest id, in characters.
    pub const MAX_LENGTH: usize = 63;

    /// The id `value`; `field` says in an error what it was to name.
    ///
    /// # Errors
    /// When it is empty, longer than 63 characters, or has other characters.
    pub fn new(field: &'static str, value: &str) -> Result<Self, InvalidId> {
        if Self::accepts(value) {
            return Ok(Self(value.to_owned()));
        }
        // A hostile name may be long; the message need not be.
        let value = value.chars().take(2 * Self::MAX_LENGTH).collect();
        Err(InvalidId { field, value })
    }

    /// Whether `value` is an id.
    #[must_use]
    pub fn accepts(value: &str) -> bool {
        let inner =
            |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_' || byte == b'-';
        let first = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit();
        value.len() <= Self::MAX_LENGTH && value.bytes().next().is_some_and(first) && value.bytes().all(inner)
    }

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl AsRef<str> for Id {
    fn as_ref(&self) -> &str {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_lower_case_short_and_free_of_separators() {
        let longest = "a".repeat(63);
        for good in ["a", "0", "red", "stop-sign_2", longest.as_str()] {
            assert!(Id::accepts(good), "{good}");
        }
        let too_long = "a".repeat(64);
        for bad in ["", "-a", "_a", "A", "a b", "a/b", "a*", "ä", "..", "a.b", "@a", "a\0", too_long.as_str()]
        {
            assert!(!Id::accepts(bad), "{bad}");
        }
    }

    #[test]
    fn the_error_names_the_field_the_value_and_what_is_allowed() {
        let error = Id::new("vehicle", "Truck 7").unwrap_err();
        assert_eq!(error.to_string(), "vehicle is \"Truck 7\"; allowed: [a-z0-9][a-z0-9_-]{0,62}");
    }

    #[test]
    fn a_long_name_does_not_make_a_long_message() {
        let error = Id::new("vehicle", &"x".repeat(1 << 20)).unwrap_err();
        assert!(error.to_string().len() < 200);
    }
}
