//! Liveliness tokens: who is there.

use std::fmt;
use std::str::FromStr;

use super::{Id, InvalidId, ROOT, UnknownKey};

/// What a process does for its vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// Publishes the landmark set.
    Leader,
    /// Registers landmarks.
    Follower,
    /// Publishes pictures.
    Camera,
    /// Routes, and remembers landmark sets.
    Router,
    /// Publishes pictures and their truth.
    Simulator,
}

impl Role {
    /// All roles.
    pub const ALL: [Self; 5] = [Self::Leader, Self::Follower, Self::Camera, Self::Router, Self::Simulator];

    /// The role's name in keys, status messages and on pages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Leader => "leader",
            Self::Follower => "follower",
            Self::Camera => "camera",
            Self::Router => "router",
            Self::Simulator => "simulator",
        }
    }

    /// Whether such a process answers, on its token's key, who it is. A camera is announced only, and judged by its
    /// pictures.
    #[must_use]
    pub const fn introduces_itself(self) -> bool {
        !matches!(self, Self::Camera)
    }
}

/// The liveliness token of one process, and the key on which it answers who it is:
/// `@waymark/v1/{fleet}/{vehicle}/{role}/{instance}`.
///
/// The `@` keeps tokens out of every data subscription: wildcards never match such a chunk.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PresenceKey {
    /// The fleet.
    pub fleet: Id,
    /// The vehicle.
    pub vehicle: Id,
    /// What it does.
    pub role: Role,
    /// This process, drawn at start.
    pub instance: Id,
}

impl PresenceKey {
    /// All instances of the same vehicle and role, this one included.
    #[must_use]
    pub fn siblings(&self) -> String {
        format!("@{ROOT}/{}/{}/{}/*", self.fleet, self.vehicle, self.role.name())
    }

    /// All instances of one role of one vehicle.
    #[must_use]
    pub fn of_role(fleet: &Id, vehicle: &Id, role: Role) -> String {
        format!("@{ROOT}/{fleet}/{vehicle}/{}/*", role.name())
    }

    /// Everyone in a fleet.
    #[must_use]
    pub fn everyone(fleet: &Id) -> String {
        format!("@{ROOT}/{fleet}/*/*/*")
    }
}

impl fmt::Display for PresenceKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "@{ROOT}/{}/{}/{}/{}", self.fleet, self.vehicle, self.role.name(), self.instance)
    }
}

impl FromStr for PresenceKey {
    type Err = UnknownKey;

    fn from_str(key: &str) -> Result<Self, UnknownKey> {
        let layout = || UnknownKey::Layout(key.to_owned());
        let below_root = key
            .strip_prefix('@')
            .and_then(|rest| rest.strip_prefix(ROOT))
            .and_then(|rest| rest.strip_prefix('/'))
            .ok_or_else(layout)?;
        let chunks: Vec<&str> = below_root.split('/').collect();
        let &[fleet, vehicle, role, instance] = chunks.as_slice() else { return Err(layout()) };
        let role = Role::ALL.into_iter().find(|known| known.name() == role).ok_or_else(layout)?;
        let parsed = || -> Result<Self, InvalidId> {
            Ok(Self {
                fleet: Id::new("fleet", fleet)?,
                vehicle: Id::new("vehicle", vehicle)?,
                role,
                instance: Id::new("instance", instance)?,
            })
        };
        parsed().map_err(|invalid| UnknownKey::Id { key: key.to_owned(), invalid })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_read_back() {
        for role in Role::ALL {
            let id = |value| Id::new("id", value).unwrap();
            let token = PresenceKey { fleet: id("rink"), vehicle: id("v2"), role, instance: id("7f3a") };
            assert_eq!(token.to_string(), format!("@waymark/v1/rink/v2/{}/7f3a", role.name()));
            assert_eq!(token.to_string().parse::<PresenceKey>(), Ok(token));
        }
    }

    #[test]
    fn other_layouts_and_roles_are_refused() {
        for key in ["waymark/v1/f/v/leader/1", "@waymark/v1/f/v/captain/1", "@waymark/v1/f/v/leader"] {
            assert!(matches!(key.parse::<PresenceKey>(), Err(UnknownKey::Layout(_))), "{key}");
        }
        assert!(matches!("@waymark/v1/f/v/leader/..".parse::<PresenceKey>(), Err(UnknownKey::Id { .. })));
    }
}
