//! Configuration in layers: defaults < files < `WAYMARK__A__B` < `--set a.b=v` < flags.
//!
//! Every layer may set any key; the last one that does wins, and [`Layers::settings`] says which one that was. Keys
//! that nothing reads are refused with the nearest one that something does.

mod layer;
mod locate;
mod refusal;

use std::path::{Path, PathBuf};

use figment::Figment;
use figment::value::{Tag, Value};
use serde::Serialize;
use serde::de::DeserializeOwned;

use layer::Layer;
pub use refusal::ConfigError;

/// What the names of environment variables begin with; `__` separates the parts of a key.
pub const ENVIRONMENT_PREFIX: &str = "WAYMARK__";

/// The layers of one configuration, from the weakest to the strongest.
#[derive(Clone, Debug)]
pub struct Layers {
    merged: Figment,
    files: Vec<ConfigFile>,
}

/// A file that was read, kept to quote from.
#[derive(Clone, Debug)]
pub(crate) struct ConfigFile {
    path: PathBuf,
    text: String,
}

/// One key of the merged configuration.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Setting {
    /// The key, as in `http.listen`.
    pub key: String,
    /// Its value as TOML.
    pub value: String,
    /// Where it comes from: `default`, `file X`, `environment variable X`, `--set` or `flag --x`.
    pub source: String,
}

impl Layers {
    /// The weakest layer: what holds when nothing is said.
    ///
    /// # Errors
    /// When the defaults cannot be written as TOML.
    pub fn of_defaults<T: Serialize>(defaults: &T) -> Result<Self, ConfigError> {
        let table = toml::Table::try_from(defaults)
            .map_err(|source| ConfigError::Defaults { reason: source.to_string() })?;
        let merged = Figment::from(Layer { source: "default".to_owned(), table });
        Ok(Self { merged, files: Vec::new() })
    }

    /// Adds a TOML file.
    ///
    /// # Errors
    /// When it cannot be read, or is no TOML.
    pub fn file(mut self, path: &Path) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ConfigError::Unreadable { path: path.to_owned(), source })?;
        let table = text
            .parse::<toml::Table>()
            .map_err(|source| ConfigError::Syntax { path: path.to_owned(), source: Box::new(source) })?;
        self.files.push(ConfigFile { path: path.to_owned(), text });
        Ok(self.with(Layer { source: format!("file {}", path.display()), table }))
    }

    /// Adds the variables among `variables` that begin with [`ENVIRONMENT_PREFIX`].
    ///
    /// # Errors
    /// When the rest of such a name is no key.
    pub fn environment(
        mut self,
        variables: impl IntoIterator<Item = (String, String)>,
    ) -> Result<Self, ConfigError> {
        for (name, value) in variables {
            let Some(rest) = name.strip_prefix(ENVIRONMENT_PREFIX) else { continue };
            let key = rest.to_lowercase().replace("__", ".");
            let source = format!("environment variable {name}");
            self = self.with(Layer::of_text(source, &key, &value)?);
        }
        Ok(self)
    }

    /// Adds an assignment as `--set` takes it: `a.b=v`, where v is TOML, or else a string.
    ///
    /// # Errors
    /// When there is no `=`, or what stands before it is no key.
    pub fn set(self, assignment: &str) -> Result<Self, ConfigError> {
        let (key, value) = assignment
            .split_once('=')
            .ok_or_else(|| ConfigError::Assignment { text: assignment.to_owned() })?;
        let layer = Layer::of_text(format!("--set {assignment}"), key.trim(), value.trim())?;
        Ok(self.with(layer))
    }

    /// Adds the value that a flag of the command line gave to `key`.
    ///
    /// # Errors
    /// When the value cannot be written as TOML.
    pub fn flag<T: Serialize>(self, flag: &str, key: &str, value: &T) -> Result<Self, ConfigError> {
        let value = toml::Value::try_from(value)
            .map_err(|source| ConfigError::Defaults { reason: source.to_string() })?;
        Ok(self.with(Layer::of_value(format!("flag {flag}"), key, value)?))
    }

    /// The configuration that all layers together give.
    ///
    /// # Errors
    /// The first key that is unknown or has a value of the wrong kind, with the place where it was set.
    pub fn extract<T: DeserializeOwned>(&self) -> Result<T, ConfigError> {
        self.merged.extract().map_err(|error| refusal::explain(&error, &self.files))
    }

    /// Every key with its value and where that comes from.
    ///
    /// # Errors
    /// When the layers cannot be merged.
    pub fn settings(&self) -> Result<Vec<Setting>, ConfigError> {
        let merged: Value = self.merged.extract().map_err(|error| refusal::explain(&error, &self.files))?;
        let mut settings = Vec::new();
        self.collect("", &merged, &mut settings);
        Ok(settings)
    }

    fn with(mut self, layer: Layer) -> Self {
        self.merged = self.merged.merge(layer);
        self
    }

    fn collect(&self, prefix: &str, value: &Value, settings: &mut Vec<Setting>) {
        if let Value::Dict(_, entries) = value {
            for (name, entry) in entries {
                let key = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
                self.collect(&key, entry, settings);
            }
            return;
        }
        let text =
            toml::Value::try_from(value).map_or_else(|_| format!("{value:?}"), |value| value.to_string());
        let source = self.source_of(prefix, value.tag());
        settings.push(Setting { key: prefix.to_owned(), value: text, source });
    }

    fn source_of(&self, key: &str, tag: Tag) -> String {
        let metadata = self.merged.get_metadata(tag).or_else(|| self.merged.find_metadata(key));
        metadata.map_or_else(|| "default".to_owned(), |metadata| metadata.name.to_string())
    }
}

#[cfg(test)]
mod tests;
