//! Liveliness tokens as they come and go.

use std::collections::BTreeSet;

use tokio::sync::watch;
use zenoh::Session;
use zenoh::pubsub::Subscriber;
use zenoh::sample::SampleKind;

/// Watches the tokens at one key expression.
pub struct TokenWatch {
    tokens: watch::Receiver<BTreeSet<String>>,
    _subscriber: Subscriber<()>,
}

impl TokenWatch {
    /// Begins to watch; tokens that are there already are told of too.
    ///
    /// # Errors
    /// When Zenoh refuses the subscription.
    pub async fn begin(session: &Session, key_expression: &str) -> zenoh::Result<Self> {
        let (sender, tokens) = watch::channel(BTreeSet::new());
        let subscriber = session
            .liveliness()
            .declare_subscriber(key_expression)
            .history(true)
            .callback(move |sample| {
                let token = sample.key_expr().as_str().to_owned();
                sender.send_modify(|tokens| match sample.kind() {
                    SampleKind::Put => drop(tokens.insert(token)),
                    SampleKind::Delete => drop(tokens.remove(&token)),
                });
            })
            .await?;
        Ok(Self { tokens, _subscriber: subscriber })
    }

    /// The tokens that are there, now and as they change.
    #[must_use]
    pub fn tokens(&self) -> watch::Receiver<BTreeSet<String>> {
        self.tokens.clone()
    }
}
