//! Wire messages ↔ domain values.
//!
//! `…_to_wire` cannot fail. `…_from_wire` believes nothing: a value that the domain does not allow becomes an
//! [`InvalidField`] that names the field, the value and the limit, and is never replaced by a default. Fields that
//! this version does not know were dropped by the decoder; enum values that it does not know are refused.

mod check;
mod follow_state;
mod landmark;
mod registration_from_wire;
mod registration_to_wire;
mod set;
mod stats;

pub use check::InvalidField;
pub use follow_state::{FollowSnapshot, follow_state_from_wire, follow_state_to_wire};
pub use landmark::{landmark_draft_from_wire, landmark_from_wire, landmark_to_wire};
pub use registration_from_wire::registration_from_wire;
pub use registration_to_wire::registration_to_wire;
pub use set::{Manifest, manifest_from_wire, manifest_of, set_from_wire, set_to_wire};
