//! Messages against their schemas, their times, and what the file says about losses.

use std::{collections::BTreeMap, io::Read, sync::Arc};

use mcap::records::Record;
use prost_reflect::{DescriptorPool, DynamicMessage, MessageDescriptor};

use super::{Aspect, Check, Severity};
use crate::{
    Ledger, RecordingError,
    recover::RECOVERY_RECORD,
    walk::{FaultKind, RecordedChannel, RecordedMessage, Step, Walk},
    writer::ACCOUNTS_RECORD,
};

/// How far a capture may lie ahead of its receipt before the clocks are called apart, nanoseconds.
const CLOCK_SLACK_NS: u64 = 1_000_000_000;

pub(super) fn check(walk: &mut Walk<impl Read>, check: &mut Check) -> Result<(), RecordingError> {
    let mut pass = Pass { check, channels: BTreeMap::new(), accounts: None };
    while let Some((offset, step)) = walk.next_step()? {
        match step {
            Step::Message(message) => pass.message(offset, &message),
            Step::Record(Record::Metadata(metadata)) if metadata.name == ACCOUNTS_RECORD => {
                pass.accounts = Some(Ledger::from_metadata(&metadata.metadata));
            }
            Step::Record(Record::Metadata(metadata)) if metadata.name == RECOVERY_RECORD => {
                pass.recovered(&metadata.metadata);
            }
            // The structure pass reports the other faults.
            Step::Fault(kind @ (FaultKind::UnknownChannel { .. } | FaultKind::UnknownSchema { .. })) => {
                pass.check.add(Severity::Error, Aspect::Structure, offset, kind.to_string());
            }
            Step::Chunk(_) | Step::Record(_) | Step::Fault(_) => {}
        }
    }
    pass.end();
    Ok(())
}

struct Pass<'a> {
    check: &'a mut Check,
    channels: BTreeMap<u16, ChannelSeen>,
    accounts: Option<Ledger>,
}

struct ChannelSeen {
    topic: String,
    /// Missing when the schema is none that is checked, or is faulty.
    descriptor: Option<MessageDescriptor>,
    undecodable: u64,
    messages: u64,
    last_log_time_ns: u64,
    backwards: u64,
    ahead_of_receipt: u64,
}

impl Pass<'_> {
    fn message(&mut self, offset: u64, message: &RecordedMessage) {
        if !self.channels.contains_key(&message.channel.id) {
            let seen = self.meet(offset, &message.channel);
            self.channels.insert(message.channel.id, seen);
        }
        let Some(seen) = self.channels.get_mut(&message.channel.id) else { return };
        seen.messages += 1;
        seen.backwards += u64::from(message.log_time_ns < seen.last_log_time_ns);
        seen.last_log_time_ns = message.log_time_ns;
        let ahead = message.publish_time_ns > message.log_time_ns.saturating_add(CLOCK_SLACK_NS);
        seen.ahead_of_receipt += u64::from(ahead);
        if let Some(descriptor) = &seen.descriptor
            && let Err(error) = DynamicMessage::decode(descriptor.clone(), message.data.clone())
        {
            seen.undecodable += 1;
            let text = format!(
                "message {} on {} is no {}: {error}",
                message.sequence,
                seen.topic,
                descriptor.full_name()
            );
            self.check.add(Severity::Error, Aspect::Schema, offset, text);
        }
    }

    fn meet(&mut self, offset: u64, channel: &Arc<RecordedChannel>) -> ChannelSeen {
        let descriptor = descriptor(channel).unwrap_or_else(|problem| {
            self.check.add(Severity::Error, Aspect::Schema, offset, format!("{}: {problem}", channel.topic));
            None
        });
        ChannelSeen {
            topic: channel.topic.clone(),
            descriptor,
            undecodable: 0,
            messages: 0,
            last_log_time_ns: 0,
            backwards: 0,
            ahead_of_receipt: 0,
        }
    }

    fn recovered(&mut self, record: &BTreeMap<String, String>) {
        let said = |key: &str| record.get(key).map_or("", String::as_str);
        let lost_data = said("lost_data") == "true";
        let severity = if lost_data { Severity::Loss } else { Severity::Note };
        let (input, cut_bytes) = (said("input"), said("cut_bytes"));
        let text =
            format!("recovered from {input}, {cut_bytes} bytes were cut; faults then: {}", said("faults"));
        self.check.add(severity, Aspect::Loss, None, text);
    }

    fn end(&mut self) {
        for seen in self.channels.values() {
            let (topic, messages) = (&seen.topic, seen.messages);
            if seen.backwards > 0 {
                let text = format!(
                    "{topic}: log time goes backwards {} times in {messages} messages",
                    seen.backwards
                );
                self.check.add(Severity::Warning, Aspect::Time, None, text);
            }
            if seen.ahead_of_receipt > 0 {
                let ahead = seen.ahead_of_receipt;
                let text = format!(
                    "{topic}: {ahead} of {messages} messages were captured over 1 s after receipt: clocks differ"
                );
                self.check.add(Severity::Warning, Aspect::Time, None, text);
            }
        }
        let Some(accounts) = &self.accounts else {
            let text =
                "no accounts: the file is not ours, was recovered, or is unfinished; losses are unknown";
            return self.check.add(Severity::Note, Aspect::Loss, None, text.to_owned());
        };
        for (topic, account) in accounts.iter() {
            let stored = account.stored + account.repeated;
            let of_topic = self.channels.values().filter(|seen| seen.topic == topic);
            let found: u64 = of_topic.map(|seen| seen.messages).sum();
            if stored != found {
                let text =
                    format!("{topic}: the accounts say {stored} messages were stored, the file has {found}");
                self.check.add(Severity::Error, Aspect::Loss, None, text);
            }
            if account.lost() > 0 {
                let (lost, offered) = (account.lost(), account.offered);
                let text = format!(
                    "{topic}: {lost} of {offered} messages lost ({} in the queue, {} on disk)",
                    account.lost_in_queue, account.lost_on_disk
                );
                self.check.add(Severity::Loss, Aspect::Loss, None, text);
            }
        }
    }
}

/// The channel's message type; `None` when its encoding is none that is checked.
fn descriptor(channel: &RecordedChannel) -> Result<Option<MessageDescriptor>, String> {
    let Some(schema) = channel.schema.as_ref().filter(|schema| schema.encoding == "protobuf") else {
        return Ok(None);
    };
    let pool = DescriptorPool::decode(schema.data.clone()).map_err(|error| {
        format!("schema {:?} is no FileDescriptorSet with all imports: {error}", schema.name)
    })?;
    let descriptor = pool.get_message_by_name(&schema.name);
    descriptor.map(Some).ok_or_else(|| format!("schema {:?} is not in its FileDescriptorSet", schema.name))
}
