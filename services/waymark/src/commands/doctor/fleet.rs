//! Everyone who is announced in the fleet: their clocks and their versions.

use runtime::clock::ClockOffset;
use runtime::presence::{Member, members};
use waymark_proto::keys::PresenceKey;
use zenoh::Session;

use super::finding::Finding;
use super::subject::Subject;

pub(super) async fn examine(session: &Session, subject: &Subject) -> Vec<Finding> {
    let announced = members(session, &PresenceKey::everyone(subject.keys.fleet())).await;
    match announced.map(|members| members.into_iter().filter(introduces_itself).collect::<Vec<_>>()) {
        Ok(members) if members.is_empty() => {
            let found = format!("no leader or follower of fleet {} is there", subject.keys.fleet());
            ["clocks", "versions"].map(|check| Finding::not_applicable(check, found.clone())).to_vec()
        }
        Ok(members) => {
            let clocks = members.iter().map(clock);
            clocks.chain([versions(&members, env!("CARGO_PKG_VERSION"))]).collect()
        }
        Err(reason) => vec![Finding::no("clocks", reason.to_string(), "see the router's log")],
    }
}

fn introduces_itself(member: &Member) -> bool {
    member.key.parse::<PresenceKey>().is_ok_and(|key| key.role.introduces_itself())
}

fn clock(member: &Member) -> Finding {
    let name = name(member);
    let check = format!("clock of {name}");
    let Some(clock) = member.clock else {
        let remedy = "it is stopped, cut off or has just ended: look at that machine, or ask again in 10 s";
        return Finding::no(check, "is announced and does not answer", remedy);
    };
    let found = worded(clock);
    match clock.is_in_step() {
        true => Finding::yes(check, found),
        false => {
            let remedy = "synchronise both machines with the same time server (chrony, or systemd-timesyncd)";
            Finding::no(check, found, remedy)
        }
    }
}

fn worded(clock: ClockOffset) -> String {
    let ms = |ns: i64| ns as f64 * 1e-6;
    let direction = if clock.offset_ns >= 0 { "ahead of" } else { "behind" };
    let (offset_ms, uncertainty_ms) = (ms(clock.offset_ns).abs(), ms(clock.uncertainty_ns()));
    format!("{offset_ms:.1} ms {direction} this machine's, give or take {uncertainty_ms:.1} ms")
}

/// One program speaks to itself; two versions may or may not understand each other.
fn versions(members: &[Member], own: &str) -> Finding {
    let others: Vec<String> = members
        .iter()
        .filter_map(|member| Some((name(member), &member.introduction.as_ref()?.version)))
        .filter(|(_, version)| *version != own)
        .map(|(name, version)| format!("{name} runs {version}"))
        .collect();
    if others.is_empty() {
        return Finding::yes("versions", format!("all run {own}"));
    }
    let found = format!("this is {own}, but {}", others.join(", "));
    Finding::no("versions", found, "install the same version everywhere")
}

/// Vehicle and role, as in `truck-7/follower`.
fn name(member: &Member) -> String {
    let key = member.key.parse::<PresenceKey>();
    key.map_or_else(|_| member.key.clone(), |key| format!("{}/{}", key.vehicle, key.role.name()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::doctor::finding::Verdict;

    fn member(clock: Option<ClockOffset>) -> Member {
        Member { key: "@waymark/v1/rink/v2/follower/1".into(), introduction: None, clock }
    }

    #[test]
    fn a_clock_is_judged_by_what_is_known_of_it() {
        let offset =
            |offset_ns, round_trip_ns| clock(&member(Some(ClockOffset { offset_ns, round_trip_ns })));
        assert_eq!(offset(-30_000_000, 2_000_000).verdict, Verdict::Yes);
        let off = offset(-3_600_000_000_000, 2_000_000);
        assert_eq!(off.verdict, Verdict::No);
        assert_eq!(off.found, "3600000.0 ms behind this machine's, give or take 1.0 ms");
        assert_eq!(clock(&member(None)).verdict, Verdict::No);
    }
}
