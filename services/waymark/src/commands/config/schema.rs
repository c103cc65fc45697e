//! `waymark config schema`.

use ::camera::CameraConfig;
use ::follower::FollowerConfig;
use ::leader::LeaderConfig;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::Serialize;
use serde_json::Value;

use super::Service;
use crate::console::Console;
use crate::exit::{Ending, Failure};

/// Print the JSON Schema of a service's configuration, for editors and validators
///
/// Example: waymark config schema follower > follower.schema.json, and `#:schema follower.schema.json` as the first
/// line of follower.toml.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Whose configuration
    service: Service,
}

pub(crate) fn run(args: &Args) -> Result<Ending, Failure> {
    let schema = match args.service {
        Service::Leader => schema::<LeaderConfig>(),
        Service::Follower => schema::<FollowerConfig>(),
        Service::Camera => schema::<CameraConfig>(),
    };
    Console::write_results(format!("{schema:#}\n").as_bytes())?;
    Ok(Ending::Fine)
}

fn schema<C: JsonSchema + Serialize + Default>() -> Value {
    let mut settings = SchemaSettings::draft2020_12();
    settings.inline_subschemas = true;
    let mut schema = settings.into_generator().into_root_schema_for::<C>().to_value();
    note_defaults(&mut schema, &serde_json::json!(C::default()));
    schema
}

/// Every key may be left out, and what holds then depends on the service, not on the type of its part: a leader's page
/// has another port than a follower's.
fn note_defaults(schema: &mut Value, default: &Value) {
    let Some(object) = schema.as_object_mut() else { return };
    object.remove("required");
    if let Some(properties) = object.get_mut("properties").and_then(Value::as_object_mut) {
        object_defaults(properties, default);
    } else {
        object.insert("default".to_owned(), default.clone());
    }
}

fn object_defaults(properties: &mut serde_json::Map<String, Value>, default: &Value) {
    for (name, property) in properties {
        if let Some(object) = property.as_object_mut() {
            object.remove("default");
        }
        if let Some(default) = default.get(name) {
            note_defaults(property, default);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_those_of_the_service() {
        for (schema, page) in
            [(schema::<LeaderConfig>(), "127.0.0.1:8081"), (schema::<FollowerConfig>(), "127.0.0.1:8080")]
        {
            let listen = &schema["properties"]["http"]["properties"]["listen"];
            assert_eq!(listen["default"], page);
            assert!(listen["description"].as_str().unwrap().contains("loopback"), "{listen}");
            assert_eq!(schema["additionalProperties"], false);
        }
    }

    #[test]
    fn nothing_is_required_and_every_key_is_described() {
        fn check(path: &str, schema: &Value) {
            assert!(schema.get("required").is_none(), "{path}");
            for (name, property) in schema["properties"].as_object().into_iter().flatten() {
                assert!(property["description"].is_string(), "{path}.{name} has no description");
                check(&format!("{path}.{name}"), property);
            }
        }
        check("camera", &schema::<CameraConfig>());
        check("follower", &schema::<FollowerConfig>());
        check("leader", &schema::<LeaderConfig>());
    }
}
