//! The `http` part of a service's configuration.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::policy::{Policy, Token, TokenError};

/// The web face.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HttpSettings {
    /// Address and port; beyond loopback it is read-only without a token.
    pub listen: SocketAddr,
    /// File that holds the bearer token for changes.
    pub token_file: Option<PathBuf>,
    /// Host names that are accepted besides IP addresses, localhost and the machine's name.
    pub hosts: Vec<String>,
    /// Origins of pages elsewhere that may read recordings, such as `https://app.foxglove.dev`.
    pub viewers: Vec<String>,
}

impl HttpSettings {
    /// Reachable from this machine only; port 0 takes a free one.
    #[must_use]
    pub fn on_loopback(port: u16) -> Self {
        Self {
            listen: (Ipv4Addr::LOCALHOST, port).into(),
            token_file: None,
            hosts: Vec::new(),
            viewers: Vec::new(),
        }
    }

    /// What these settings permit.
    ///
    /// # Errors
    /// When the token file cannot be used.
    pub fn policy(&self) -> Result<Policy, TokenError> {
        let token = self.token_file.as_deref().map(Token::from_file).transpose()?;
        Ok(Policy { hosts: self.hosts.clone(), viewers: self.viewers.clone(), token, ..Policy::default() })
    }
}
