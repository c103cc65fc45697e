//! `waymark config acl`.
//!
//! Zenoh's access control stands in the router. A rule names messages, the direction as the router sees it, and key
//! expressions that must include those of the message; `*` and `**` never match chunks that begin with `@`, so the
//! advanced publisher's `@adv` and our tokens are named of their own. Refusals are silent at the sender, which is why
//! `waymark doctor` looks whether publications come back.

use serde_json::{Value, json};
use waymark_proto::keys::{CameraStream, Id, InvalidId, PresenceKey, ROOT, Role, VehicleKeys};

use crate::console::Console;
use crate::exit::{Ending, Failure, OrUsage};

/// Print Zenoh's access control (JSON5) for the router of a fleet
///
/// Everyone who is named may read the whole fleet; a vehicle may only write below its own keys, and only a leader
/// landmarks; only operators may change a leader's set with `waymark landmark publish`, `retire` and `push`; everyone
/// else is refused. Put the printed part into the file of `waymark router --zenoh FILE`. Names are those of the
/// certificates (mutual TLS) or of the users.
#[derive(Debug, clap::Args)]
#[command(arg_required_else_help = true)]
pub(crate) struct Args {
    /// Fleet
    #[arg(long, value_name = "ID", default_value = "convoy")]
    fleet: String,

    /// Vehicle that publishes landmarks; may be given several times
    #[arg(long = "leader", value_name = "ID", required = true)]
    leaders: Vec<String>,

    /// Vehicle that looks for landmarks; may be given several times
    #[arg(long = "follower", value_name = "ID")]
    followers: Vec<String>,

    /// Certificate or user that may change a leader's landmarks; may be given several times
    #[arg(long = "operator", value_name = "NAME")]
    operators: Vec<String>,

    /// What tells the router who somebody is; a vehicle's name is its id
    #[arg(long, value_enum, default_value_t = Identify::Certificate)]
    identify: Identify,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Identify {
    /// The common name of its TLS certificate
    Certificate,
    /// The user of its password
    User,
}

/// What only the sender of something does.
const WRITES: [&str; 5] = ["put", "delete", "declare_queryable", "reply", "liveliness_token"];
/// What anybody does who waits to be told.
const LISTENS: [&str; 3] = ["declare_subscriber", "declare_liveliness_subscriber", "liveliness_query"];

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let control = access_control(args)?;
    let text = format!("// Access control of fleet {}, for its router.\n{control:#}\n", args.fleet);
    Console::write_results(text.as_bytes())?;
    Ok(Ending::Fine)
}

fn access_control(args: &Args) -> Result<Value, Failure> {
    let fleet = Id::new("fleet", &args.fleet).or_usage()?;
    let (mut rules, mut policies) = (shared_rules(&fleet), Vec::new());
    let mut everyone: Vec<&String> = Vec::new();
    for (ids, role) in [(&args.leaders, Role::Leader), (&args.followers, Role::Follower)] {
        for id in ids {
            let vehicle = VehicleKeys::new(&args.fleet, id).or_usage()?;
            let rule = format!("write {id} as {}", role.name());
            rules.push(rule_of(&rule, &WRITES, &["ingress"], &written_keys(&vehicle, role)));
            policies.push(json!({ "rules": [rule], "subjects": [id] }));
            everyone.push(id);
        }
    }
    if !args.operators.is_empty() {
        rules.push(rule_of("change landmarks", &["query"], &["ingress"], &edited_keys(args)?));
        policies.push(json!({ "rules": ["change landmarks"], "subjects": args.operators }));
        everyone.extend(&args.operators);
    }
    everyone.sort();
    everyone.dedup();
    policies.push(json!({ "rules": ["listen", "ask", "be told"], "subjects": everyone }));
    let subjects: Vec<Value> = everyone.iter().map(|name| subject(name, args.identify)).collect();
    Ok(json!({ "access_control": {
        "enabled": true,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    } }))
}

/// Where the leaders are asked to change their sets.
fn edited_keys(args: &Args) -> Result<Vec<String>, Failure> {
    let edited = args.leaders.iter().map(|id| Ok(VehicleKeys::new(&args.fleet, id)?.landmark_edit()));
    edited.collect::<Result<_, InvalidId>>().or_usage()
}

fn rule_of(id: &str, messages: &[&str], flows: &[&str], key_exprs: &[String]) -> Value {
    json!({ "id": id, "permission": "allow", "messages": messages, "flows": flows, "key_exprs": key_exprs })
}

fn subject(name: &str, identify: Identify) -> Value {
    match identify {
        Identify::Certificate => json!({ "id": name, "cert_common_names": [name] }),
        Identify::User => json!({ "id": name, "usernames": [name] }),
    }
}

/// What everybody may ask for, and be sent or asked by the router.
fn shared_rules(fleet: &Id) -> Vec<Value> {
    let everyone = PresenceKey::everyone(fleet);
    let everything = with_advanced(&format!("{ROOT}/{fleet}/**"));
    let everything: Vec<String> = everything.into_iter().chain([everyone.clone()]).collect();
    let asked: Vec<String> = readable_keys(fleet).into_iter().chain([everyone]).collect();
    let told: Vec<&str> = WRITES.iter().chain(&LISTENS).copied().chain(["query"]).collect();
    vec![
        rule_of("listen", &LISTENS, &["ingress"], &everything),
        rule_of("ask", &["query"], &["ingress"], &asked),
        rule_of("be told", &told, &["egress"], &everything),
    ]
}

/// Everything but `landmark-edit`, a query to which is a change.
fn readable_keys(fleet: &Id) -> Vec<String> {
    let root = format!("{ROOT}/{fleet}/*");
    let tails =
        ["landmark/**", "manifest", "camera/**", "route/**", "odometry", "guidance", "status", "echo/*"];
    tails.iter().flat_map(|tail| with_advanced(&format!("{root}/{tail}"))).collect()
}

/// What a vehicle in that role says of itself.
fn written_keys(vehicle: &VehicleKeys, role: Role) -> Vec<String> {
    let camera = |stream: CameraStream| vehicle.cameras(stream);
    let mut keys: Vec<String> = CameraStream::ALL.into_iter().map(camera).collect();
    keys.extend([vehicle.status(), vehicle.echoes()]);
    if role == Role::Leader {
        keys.extend([vehicle.landmarks(), vehicle.manifest(), vehicle.landmark_edit()]);
    }
    let mut keys: Vec<String> = keys.iter().flat_map(|key| with_advanced(key)).collect();
    let (fleet, vehicle) = (vehicle.fleet(), vehicle.vehicle());
    let roles = [role, Role::Camera];
    keys.extend(roles.map(|role| PresenceKey::of_role(fleet, vehicle, role)));
    keys
}

/// The key expression, and where an advanced publisher keeps its cache and its token.
fn with_advanced(key_expression: &str) -> [String; 2] {
    [key_expression.to_owned(), format!("{key_expression}/@adv/**")]
}
