//! The wire: generated messages, key expressions, attachment, and conversion to and from the domain.
