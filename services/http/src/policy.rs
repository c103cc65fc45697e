//! Who may connect, what they may send, and who may change something.

use std::net::IpAddr;
use std::path::Path;
use std::time::Duration;

/// Limits and permissions of one listener.
#[derive(Clone, Debug)]
pub struct Policy {
    /// A connection that has not sent a whole request header by then is closed; idle ones too.
    pub header_timeout: Duration,
    /// A request body that is not complete by then is answered with 408.
    pub body_timeout: Duration,
    /// A client that takes nothing for this long while there is something to send is cut off.
    pub stall_timeout: Duration,
    /// Connections served at once; more get 503 with `Retry-After`.
    pub max_connections: usize,
    /// The longest query; more gets 414.
    pub max_query_bytes: usize,
    /// The largest request header; more gets 431.
    pub max_header_bytes: usize,
    /// The largest request body; more gets 413.
    pub max_body_bytes: usize,
    /// From the shutdown signal to the moment when connections still open are dropped.
    pub shutdown_deadline: Duration,
    /// Names accepted in `Host` beside IP literals, `localhost` and the machine's own name.
    pub hosts: Vec<String>,
    /// Origins of pages elsewhere that may read what is marked [`crate::ForViewers`].
    pub viewers: Vec<String>,
    /// When present, changes need it.
    pub token: Option<Token>,
}

impl Default for Policy {
    fn default() -> Self {
        Self {
            header_timeout: Duration::from_secs(8),
            body_timeout: Duration::from_secs(8),
            stall_timeout: Duration::from_secs(8),
            // Above 500 slow-header clients; below the usual limit of 1,024 open files a process.
            max_connections: 768,
            max_query_bytes: 4 << 10,
            max_header_bytes: 32 << 10,
            max_body_bytes: 1 << 20,
            shutdown_deadline: Duration::from_secs(2),
            hosts: Vec::new(),
            viewers: Vec::new(),
            token: None,
        }
    }
}

impl Policy {
    /// What a client of a listener at this address may do.
    #[must_use]
    pub fn access(&self, listening_on: IpAddr) -> Access {
        match (&self.token, listening_on.is_loopback()) {
            (Some(_), _) => Access::Token,
            (None, true) => Access::Open,
            (None, false) => Access::ReadOnly,
        }
    }
}

/// What clients of a listener may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read and change: only this machine can connect.
    Open,
    /// Read; changes need `Authorization: Bearer` (RFC 6750).
    Token,
    /// Read only: other machines can connect and there is no token.
    ReadOnly,
}

impl Access {
    /// The name used in JSON and on pages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Token => "token",
            Self::ReadOnly => "read_only",
        }
    }
}

/// A bearer token (RFC 6750).
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

/// Why a token file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TokenError {
    /// The file cannot be read.
    #[error("cannot read the token file {path}: {source}")]
    Unreadable {
        /// The file.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The token is too short or has characters that a header cannot carry.
    #[error(
        "the token file {path} must hold one line of at least {} printable ASCII characters without spaces, \
         for instance from `openssl rand -hex 32`",
        Token::MIN_CHARACTERS
    )]
    Unusable {
        /// The file.
        path: String,
    },
}

impl Token {
    /// The shortest token accepted.
    pub const MIN_CHARACTERS: usize = 16;

    /// Reads the token from a file; white space around it is ignored.
    ///
    /// # Errors
    /// When the file cannot be read or its content is no usable token.
    pub fn from_file(path: &Path) -> Result<Self, TokenError> {
        let name = || path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|source| TokenError::Unreadable { path: name(), source })?;
        Self::new(text.trim()).ok_or_else(|| TokenError::Unusable { path: name() })
    }

    /// A token, unless it is too short or not printable ASCII.
    #[must_use]
    pub fn new(text: &str) -> Option<Self> {
        let usable = text.len() >= Self::MIN_CHARACTERS && text.bytes().all(|byte| byte.is_ascii_graphic());
        usable.then(|| Self(text.to_owned()))
    }

    /// Compares in a time that does not depend on where the two differ.
    #[must_use]
    pub fn matches(&self, presented: &str) -> bool {
        let (ours, theirs) = (self.0.as_bytes(), presented.as_bytes());
        ours.len() == theirs.len() && ours.iter().zip(theirs).fold(0, |diff, (a, b)| diff | (a ^ b)) == 0
    }
}

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Token(…)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elsewhere_than_loopback_needs_a_token_for_changes() {
        let open = Policy::default();
        assert_eq!(open.access([127, 0, 0, 1].into()), Access::Open);
        assert_eq!(open.access([0, 0, 0, 0].into()), Access::ReadOnly);
        assert_eq!(open.access([192, 168, 1, 4].into()), Access::ReadOnly);
        let guarded = Policy { token: Token::new("0123456789abcdef"), ..Policy::default() };
        assert_eq!(guarded.access([127, 0, 0, 1].into()), Access::Token);
        assert_eq!(guarded.access([0, 0, 0, 0].into()), Access::Token);
    }

    #[test]
    fn a_token_is_long_printable_and_compared_whole() {
        assert_eq!(Token::new("short"), None);
        assert_eq!(Token::new("0123456789 abcdef"), None);
        let token = Token::new("0123456789abcdef").unwrap();
        assert!(token.matches("0123456789abcdef"));
        assert!(!token.matches("0123456789abcdeF"));
        assert!(!token.matches("0123456789abcde"));
        assert!(!format!("{token:?}").contains("0123"));
    }

    #[test]
    fn a_token_file_is_trimmed_and_its_errors_say_what_to_do() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("token");
        assert!(Token::from_file(&path).unwrap_err().to_string().contains("cannot read"));
        std::fs::write(&path, "0123456789abcdef\n").unwrap();
        assert!(Token::from_file(&path).unwrap().matches("0123456789abcdef"));
        std::fs::write(&path, "abc").unwrap();
        assert!(Token::from_file(&path).unwrap_err().to_string().contains("openssl rand"));
    }
}
