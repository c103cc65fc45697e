//! A picture source, published to Zenoh.
