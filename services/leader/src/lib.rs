//! The landmark set, published to Zenoh with a manifest, and its web face.
