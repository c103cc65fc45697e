//! The way onto Zenoh: a publisher for each key, and the numbers of what it sends.

use std::collections::BTreeMap;
use std::str::FromStr;

use waymark_proto::attachment::{Attachment, Gid};
use zenoh::bytes::Encoding;
use zenoh::pubsub::Publisher;
use zenoh::qos::CongestionControl;
use zenoh::{Session, Wait};

use crate::error::PlayError;
use crate::reel::PlayedMessage;

/// Keys that begin with `from` begin with `to` instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remap {
    from: String,
    to: String,
}

impl FromStr for Remap {
    type Err = PlayError;

    fn from_str(text: &str) -> Result<Self, PlayError> {
        match text.split_once('=') {
            Some((from, to)) if !from.is_empty() && !to.is_empty() => {
                Ok(Self { from: from.to_owned(), to: to.to_owned() })
            }
            _ => Err(PlayError::Remap(text.to_owned())),
        }
    }
}

impl Remap {
    fn apply(&self, key: &str) -> Option<String> {
        let rest = key.strip_prefix(&self.from)?;
        let whole_chunks = rest.is_empty() || rest.starts_with('/') || self.from.ends_with('/');
        whole_chunks.then(|| format!("{}{rest}", self.to))
    }
}

/// Everything that is being published.
pub(crate) struct Stage {
    session: Session,
    remaps: Vec<Remap>,
    gid: Gid,
    parts: BTreeMap<String, Part>,
}

struct Part {
    publisher: Publisher<'static>,
    /// The number of the last sample sent, and the recorded number it had.
    last: Option<(i64, u32)>,
}

impl Stage {
    pub(crate) fn new(session: Session, remaps: Vec<Remap>) -> Self {
        let gid = uuid::Uuid::new_v4().into_bytes();
        Self { session, remaps, gid, parts: BTreeMap::new() }
    }

    /// What comes next does not follow what went before: receivers of video must see a gap.
    pub(crate) fn cut(&mut self) {
        for part in self.parts.values_mut() {
            part.last = part.last.map(|(sent, recorded)| (sent + 1, recorded));
        }
    }

    /// Publishes a message as it was recorded. Nothing waits on a peer.
    pub(crate) fn publish(&mut self, played: &PlayedMessage) -> Result<(), PlayError> {
        let (gid, message) = (self.gid, &played.message);
        let part = self.part(&played.key)?;
        let sequence = part.next_sequence(message.sequence);
        part.last = Some((sequence, message.sequence));
        let source_time_ns = i64::try_from(message.publish_time_ns).unwrap_or(i64::MAX);
        let attachment = Attachment { sequence, source_time_ns, gid }.to_bytes();
        let encoding = match &message.channel.schema {
            Some(schema) => format!("application/{};{}", message.channel.message_encoding, schema.name),
            None => format!("application/{}", message.channel.message_encoding),
        };
        let put = part.publisher.put(message.data.clone()).encoding(Encoding::from(encoding));
        if let Err(error) = put.attachment(attachment.as_slice()).wait() {
            tracing::debug!(%error, key = played.key, "not sent");
        }
        Ok(())
    }

    fn part(&mut self, recorded_key: &str) -> Result<&mut Part, PlayError> {
        if !self.parts.contains_key(recorded_key) {
            let key = self.remaps.iter().find_map(|remap| remap.apply(recorded_key));
            let key = key.unwrap_or_else(|| recorded_key.to_owned());
            let declared = self
                .session
                .declare_publisher(key.clone())
                .congestion_control(CongestionControl::Drop)
                .wait();
            let publisher = declared.map_err(|source| PlayError::Key { key, source })?;
            self.parts.insert(recorded_key.to_owned(), Part { publisher, last: None });
        }
        Ok(self.parts.get_mut(recorded_key).expect("inserted where it was missing"))
    }
}

impl Part {
    /// Counts on, with the gaps that the recording has: a decoder of video must know of them.
    fn next_sequence(&self, recorded: u32) -> i64 {
        const LARGEST_GAP: u32 = 1 << 16;
        let Some((sent, before)) = self.last else { return 1 };
        let step = recorded.wrapping_sub(before);
        sent + if (1..=LARGEST_GAP).contains(&step) { i64::from(step) } else { 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_remapped_by_whole_chunks() {
        let remap: Remap = "a/b=c".parse().unwrap();
        assert_eq!(remap.apply("a/b/camera"), Some("c/camera".to_owned()));
        assert_eq!(remap.apply("a/b"), Some("c".to_owned()));
        assert_eq!(remap.apply("a/bc/camera"), None);
        assert!("a".parse::<Remap>().is_err() && "=b".parse::<Remap>().is_err());
    }
}
