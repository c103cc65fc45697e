//! A fleet behind mutual TLS: who belongs to it is let in, and whoever is not learns why.

use std::fs;
use std::path::{Path, PathBuf};

use rcgen::{BasicConstraints, CertificateParams, CertifiedIssuer, DnType, IsCa, KeyPair, date_time_ymd};
use serde_json::{Value, json};
use tests::free_address;
use tests::program::Program;

use crate::convoy::Place;

/// Files of one certificate and its key.
#[derive(Clone)]
struct Identity {
    certificate: PathBuf,
    key: PathBuf,
}

type Authority = CertifiedIssuer<'static, KeyPair>;

fn authority(directory: &Path, name: &str) -> (Authority, PathBuf) {
    let mut params = CertificateParams::new(Vec::new()).unwrap();
    params.distinguished_name.push(DnType::CommonName, name);
    params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
    let authority = CertifiedIssuer::self_signed(params, KeyPair::generate().unwrap()).unwrap();
    let path = directory.join(format!("{name}.pem"));
    fs::write(&path, authority.pem()).unwrap();
    (authority, path)
}

fn identity(directory: &Path, name: &str, signed_by: &Authority, ends_in_year: i32) -> Identity {
    let mut params = CertificateParams::new(["127.0.0.1".to_owned(), "localhost".to_owned()]).unwrap();
    (params.not_before, params.not_after) = (date_time_ymd(2020, 1, 1), date_time_ymd(ends_in_year, 1, 1));
    let pair = KeyPair::generate().unwrap();
    let certificate = params.signed_by(&pair, signed_by).unwrap();
    let files = Identity {
        certificate: directory.join(format!("{name}.pem")),
        key: directory.join(format!("{name}.key")),
    };
    fs::write(&files.certificate, certificate.pem()).unwrap();
    fs::write(&files.key, pair.serialize_pem()).unwrap();
    files
}

/// A follower's Zenoh configuration.
fn follower_file(directory: &Path, endpoint: &str, root: &Path, own: Option<&Identity>) -> String {
    let mut tls = json!({ "root_ca_certificate": root, "enable_mtls": own.is_some() });
    if let Some(own) = own {
        tls["connect_certificate"] = json!(own.certificate);
        tls["connect_private_key"] = json!(own.key);
    }
    let config = json!({
        "mode": "router",
        "connect": {
            "endpoints": [endpoint], "timeout_ms": -1, "exit_on_failure": false,
            "retry": { "period_init_ms": 200, "period_max_ms": 1000 },
        },
        "listen": { "endpoints": [] },
        "scouting": { "multicast": { "enabled": false }, "gossip": { "enabled": false } },
        "transport": { "link": { "tls": tls } },
    });
    written(&directory.join("follower.json5"), &config)
}

fn router_file(directory: &Path, endpoint: &str, root: &Path, own: &Identity) -> String {
    let tls = json!({
        "root_ca_certificate": root, "enable_mtls": true,
        "listen_certificate": own.certificate, "listen_private_key": own.key,
    });
    let config = json!({
        "mode": "router",
        "listen": { "endpoints": [endpoint] },
        "scouting": { "multicast": { "enabled": false }, "gossip": { "enabled": false } },
        "transport": { "link": { "tls": tls } },
    });
    written(&directory.join("router.json5"), &config)
}

fn written(path: &Path, config: &Value) -> String {
    fs::write(path, config.to_string()).unwrap();
    path.display().to_string()
}

fn router_check(readiness: &Value) -> &Value {
    readiness["checks"].as_array().unwrap().iter().find(|check| check["name"] == "router").unwrap()
}

/// Starts a follower with this identity, waits until its readiness says `wanted` of the router, and returns whether it is
/// connected.
fn follower_says(place: &Place, file: &str, wanted: &str) -> bool {
    let settings = [format!("zenoh.file={file}"), "recorder.enabled=false".to_owned()];
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    let (_follower, face) = place.start_service("follower", "follower", &settings);
    let says = |readiness: &Value| router_check(readiness)["reason"].as_str().unwrap().contains(wanted);
    router_check(&face.readiness_once(says))["ok"] == true
}

#[test]
fn only_members_get_in_and_others_learn_why_not() {
    let place = Place::new();
    let directory = place.directory.path();
    let (fleet, fleet_root) = authority(directory, "fleet");
    let (stranger, stranger_root) = authority(directory, "stranger");
    let endpoint = format!("tls/{}", free_address());
    let own = identity(directory, "router", &fleet, 2100);
    let _router =
        Program::start(["router", "--zenoh", &router_file(directory, &endpoint, &fleet_root, &own)]);

    let member = identity(directory, "member", &fleet, 2100);
    let foreign = identity(directory, "foreign", &stranger, 2100);
    let expired = identity(directory, "expired", &fleet, 2021);
    for (root, own, wanted) in [
        (&fleet_root, Some(&foreign), "another authority signed it"),
        (&fleet_root, Some(&expired), "our certificate has expired"),
        (&fleet_root, None, "a certificate is wanted there"),
        (&stranger_root, Some(&member), "not signed by our root_ca_certificate"),
    ] {
        let file = follower_file(directory, &endpoint, root, own);
        assert!(!follower_says(&place, &file, wanted), "{wanted}");
    }
    let file = follower_file(directory, &endpoint, &fleet_root, Some(&member));
    assert!(follower_says(&place, &file, "connected"));
}
