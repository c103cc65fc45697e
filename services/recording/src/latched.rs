//! State that is repeated at the head of every file.

use std::collections::BTreeMap;

use crate::{Attachment, LatchKey, Message};

/// The newest message of each latch key and the newest attachment of each name.
#[derive(Debug, Default)]
pub(crate) struct Latched {
    messages: BTreeMap<LatchKey, Message>,
    attachments: BTreeMap<String, Attachment>,
}

impl Latched {
    /// Keeps `message` if it is state.
    pub(crate) fn keep(&mut self, message: &Message) {
        if let Some(key) = message.latch.key() {
            self.messages.insert(key.clone(), message.clone());
        }
    }

    /// Stops repeating `key`, e.g. because the landmark was retired.
    pub(crate) fn forget(&mut self, key: &LatchKey) {
        self.messages.remove(key);
    }

    pub(crate) fn keep_attachment(&mut self, attachment: Attachment) {
        self.attachments.insert(attachment.name.clone(), attachment);
    }

    pub(crate) fn messages(&self) -> impl Iterator<Item = &Message> {
        self.messages.values()
    }

    pub(crate) fn attachments(&self) -> impl Iterator<Item = &Attachment> {
        self.attachments.values()
    }
}
