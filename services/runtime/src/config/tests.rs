use std::fs;

use serde::{Deserialize, Serialize};

use super::*;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Service {
    vehicle: String,
    landmarks: Vec<String>,
    http: Http,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Http {
    listen: String,
    max_connections: u16,
    token_file: Option<String>,
}

impl Default for Service {
    fn default() -> Self {
        let http = Http { listen: "127.0.0.1:8080".into(), max_connections: 64, token_file: None };
        Self { vehicle: "v1".into(), landmarks: Vec::new(), http }
    }
}

fn defaults() -> Layers {
    Layers::of_defaults(&Service::default()).unwrap()
}

fn with_file(text: &str) -> (tempfile::TempDir, Layers) {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("service.toml");
    fs::write(&path, text).unwrap();
    let layers = defaults().file(&path).unwrap();
    (place, layers)
}

fn variable(name: &str, value: &str) -> (String, String) {
    (name.to_owned(), value.to_owned())
}

#[test]
fn defaults_stand_where_nothing_is_said() {
    assert_eq!(defaults().extract::<Service>().unwrap(), Service::default());
}

#[test]
fn later_layers_win_key_by_key() {
    let (_place, layers) = with_file("vehicle = \"file\"\n[http]\nlisten = \"file\"\nmax_connections = 1\n");
    let service: Service = layers
        .environment([variable("WAYMARK__HTTP__LISTEN", "env"), variable("PATH", "/bin")])
        .unwrap()
        .set("http.max_connections=7")
        .unwrap()
        .flag("--token-file", "http.token_file", &"flag")
        .unwrap()
        .extract()
        .unwrap();
    assert_eq!(service.vehicle, "file");
    let http = Http { listen: "env".into(), max_connections: 7, token_file: Some("flag".into()) };
    assert_eq!(service.http, http);
}

#[test]
fn values_given_as_text_are_toml_or_else_strings() {
    let service: Service = defaults()
        .set("landmarks=[\"a\", \"b\"]")
        .unwrap()
        .set("vehicle = truck-7")
        .unwrap()
        .extract()
        .unwrap();
    assert_eq!(service.landmarks, ["a", "b"]);
    assert_eq!(service.vehicle, "truck-7");
}

#[test]
fn every_setting_says_where_it_comes_from() {
    let (place, layers) = with_file("vehicle = \"file\"\n");
    let settings = layers
        .environment([variable("WAYMARK__HTTP__LISTEN", "env")])
        .unwrap()
        .set("http.max_connections=7")
        .unwrap()
        .settings()
        .unwrap();
    let source = |key: &str| settings.iter().find(|setting| setting.key == key).unwrap().source.clone();
    assert_eq!(source("vehicle"), format!("file {}", place.path().join("service.toml").display()));
    assert_eq!(source("http.listen"), "environment variable WAYMARK__HTTP__LISTEN");
    assert_eq!(source("http.max_connections"), "--set http.max_connections=7");
    assert_eq!(source("landmarks"), "default");
    let listen = settings.iter().find(|setting| setting.key == "http.listen").unwrap();
    assert_eq!(listen.value, "\"env\"");
}

#[test]
fn an_unknown_key_in_a_file_is_quoted_with_the_nearest_known_one() {
    let (_place, layers) = with_file("vehicle = \"v1\"\n\n[http]\nlitsen = \"0.0.0.0:80\"\n");
    let error = layers.extract::<Service>().unwrap_err().to_string();
    assert!(error.contains("service.toml, line 4: nothing reads \"http.litsen\""), "{error}");
    assert!(error.contains("did you mean \"listen\"?"), "{error}");
    assert!(error.ends_with("\n  | litsen = \"0.0.0.0:80\""), "{error}");
}

#[test]
fn an_unknown_key_elsewhere_names_its_source() {
    let layers = defaults().environment([variable("WAYMARK__VEHICEL", "v2")]).unwrap();
    let error = layers.extract::<Service>().unwrap_err().to_string();
    assert!(error.contains("WAYMARK__VEHICEL") && error.contains("did you mean \"vehicle\"?"), "{error}");
    let layers = defaults().set("http.q=1").unwrap();
    let error = layers.extract::<Service>().unwrap_err().to_string();
    assert!(error.contains("allowed: listen, max_connections, token_file"), "{error}");
}

#[test]
fn a_value_of_the_wrong_kind_is_quoted() {
    let (_place, layers) = with_file("[http]\nmax_connections = \"many\"\n");
    let error = layers.extract::<Service>().unwrap_err().to_string();
    assert!(error.contains("line 2: http.max_connections is string \"many\"; allowed: u16"), "{error}");
    let layers = defaults().set("http.max_connections=-1").unwrap();
    let error = layers.extract::<Service>().unwrap_err().to_string();
    assert!(error.contains("--set http.max_connections=-1"), "{error}");
}

#[test]
fn syntax_errors_point_at_the_line() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("service.toml");
    fs::write(&path, "vehicle = \n").unwrap();
    let error = defaults().file(&path).unwrap_err().to_string();
    assert!(error.contains("service.toml is no TOML") && error.contains("line 1"), "{error}");
    let error = defaults().file(&place.path().join("none.toml")).unwrap_err().to_string();
    assert!(error.contains("none.toml"), "{error}");
}

#[test]
fn keys_and_assignments_without_content_are_refused() {
    assert!(matches!(defaults().set("vehicle"), Err(ConfigError::Assignment { .. })));
    assert!(matches!(defaults().set("http..listen=1"), Err(ConfigError::Key { .. })));
    let layers = defaults().environment([variable("WAYMARK__", "1")]);
    assert!(matches!(layers, Err(ConfigError::Key { .. })));
}
