//! One layer: a table, and where it comes from.

use figment::value::{Dict, Map, Value};
use figment::{Error, Metadata, Profile, Provider};

use super::refusal::ConfigError;

pub(super) struct Layer {
    pub(super) source: String,
    pub(super) table: toml::Table,
}

impl Layer {
    /// A single key whose value is given as text: TOML where it is TOML, else a string, so that paths and ids need no
    /// quotes.
    pub(super) fn of_text(source: String, key: &str, text: &str) -> Result<Self, ConfigError> {
        let value = format!("value = {text}")
            .parse::<toml::Table>()
            .ok()
            .filter(|table| table.len() == 1)
            .and_then(|mut table| table.remove("value"))
            .unwrap_or_else(|| toml::Value::String(text.to_owned()));
        Self::of_value(source, key, value)
    }

    /// A single key.
    pub(super) fn of_value(source: String, key: &str, value: toml::Value) -> Result<Self, ConfigError> {
        let mut parts: Vec<&str> = key.split('.').collect();
        if parts.iter().any(|part| part.is_empty()) {
            return Err(ConfigError::Key { key: key.to_owned(), source_name: source });
        }
        let innermost = parts.pop().unwrap_or_default();
        let mut table = toml::Table::from_iter([(innermost.to_owned(), value)]);
        for part in parts.into_iter().rev() {
            table = toml::Table::from_iter([(part.to_owned(), toml::Value::Table(table))]);
        }
        Ok(Self { source, table })
    }
}

impl Provider for Layer {
    fn metadata(&self) -> Metadata {
        Metadata::named(self.source.clone())
    }

    fn data(&self) -> Result<Map<Profile, Dict>, Error> {
        let dict = Value::serialize(&self.table)?.into_dict().unwrap_or_default();
        Ok(Profile::Default.collect(dict))
    }
}
