//! Where one file ends and the next begins.

use std::{collections::BTreeSet, time::Duration};

use crate::{Latch, Message};

/// How long a file goes on for want of a message that a decoder can begin with.
const LONGEST_WAIT: Duration = Duration::from_secs(10);

/// Whether a file should end, and what its end waits for.
#[derive(Debug, Default)]
pub(super) struct Seam {
    /// Topics of this file with messages that rest on earlier ones.
    continued: BTreeSet<String>,
    /// Since when the file should have ended, monotonic.
    due_since: Option<Duration>,
}

impl Seam {
    /// The file is to end as soon as it may; `elapsed` is now, monotonic.
    pub(super) fn ask(&mut self, elapsed: Duration) {
        self.due_since.get_or_insert(elapsed);
    }

    /// Takes note of what the file holds.
    pub(super) fn note(&mut self, message: &Message) {
        if message.latch == Latch::Continues && !self.continued.contains(&message.channel.topic) {
            self.continued.insert(message.channel.topic.clone());
        }
    }

    /// Whether the file may end at once, whatever comes next.
    pub(super) fn is_anywhere(&self) -> bool {
        self.continued.is_empty()
    }

    /// Whether the file ends before `batch`. Of several streams whose keyframes do not fall together, the next file
    /// begins with one of the first that sends one.
    pub(super) fn is_before(&self, batch: &[Message], elapsed: Duration) -> bool {
        let begins_stream = |message: &Message| {
            message.latch != Latch::Continues && self.continued.contains(&message.channel.topic)
        };
        self.due_since.is_some_and(|due| {
            self.is_anywhere()
                || batch.iter().any(begins_stream)
                || elapsed.saturating_sub(due) >= LONGEST_WAIT
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{
        ChannelSpec, Command, JournalOptions, Rotation,
        testing::{at_ms, channel, message, names, options, read_strictly, recorder, sequences_on},
    };

    /// Message `sequence` on `channel` of a stream with a keyframe every tenth message.
    fn of_stream(channel: &Arc<ChannelSpec>, sequence: u32) -> Message {
        let latch = if sequence.is_multiple_of(10) { Latch::None } else { Latch::Continues };
        Message { latch, ..message(channel, sequence, 2_000) }
    }

    #[test]
    fn a_file_begins_with_a_keyframe_where_a_stream_is_recorded() {
        let directory = tempfile::tempdir().unwrap();
        let rotation = Rotation { max_bytes: 30_000, max_duration: Duration::from_secs(3600) };
        let mut recorder = recorder(JournalOptions { rotation, ..options(directory.path()) });
        let (video, log) = (channel("/car/camera/front/image"), channel("/log"));
        for n in 0..100 {
            recorder.store(vec![of_stream(&video, n)], at_ms(u64::from(n) * 33));
            recorder.store(vec![message(&log, n, 80)], at_ms(u64::from(n) * 33));
            if n == 64 {
                recorder.command(Command::Split, at_ms(u64::from(n) * 33));
            }
        }
        recorder.finish(at_ms(4_000));

        let files: Vec<_> =
            names(directory.path()).iter().map(|name| read_strictly(&directory.path().join(name))).collect();
        let pictures: Vec<Vec<u32>> = files.iter().map(|file| sequences_on(file, &video.topic)).collect();
        let firsts: Vec<u32> = pictures.iter().map(|file| file[0]).collect();
        assert_eq!(firsts, [0, 20, 40, 60, 70, 90]);
        assert_eq!(pictures.concat(), (0..100).collect::<Vec<_>>());
    }

    #[test]
    fn a_stream_without_keyframes_does_not_keep_a_file_open() {
        let directory = tempfile::tempdir().unwrap();
        let rotation = Rotation { max_bytes: u64::MAX, max_duration: Duration::from_secs(60) };
        let mut recorder = recorder(JournalOptions { rotation, ..options(directory.path()) });
        let (video, log) = (channel("/car/camera/front/image"), channel("/log"));
        recorder.store(vec![of_stream(&video, 1)], at_ms(0));
        for second in 1..=80 {
            recorder.store(vec![message(&log, second, 80)], at_ms(u64::from(second) * 1_000));
        }
        recorder.finish(at_ms(81_000));

        let ends = names(directory.path())
            .iter()
            .map(|name| read_strictly(&directory.path().join(name)).len())
            .collect::<Vec<_>>();
        assert_eq!(ends, [1 + 69, 11]);
    }
}
