//! A recording written again, every message untouched, with further messages on channels of their own.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::BufReader,
    path::{Path, PathBuf},
    sync::Arc,
};

use mcap::records::Metadata;

use crate::{
    Attachment, ChannelSpec, Message, RecordingError, WriterOptions,
    copy::{Copied, Copying, Outline},
    recover::RecoverReport,
    storage::rename_new,
    walk::{CutChunk, RecordedMessage, Walk},
};

/// Stands behind the output's name until it is finished.
const UNFINISHED: &str = ".part";

/// A recording being written again. Until [`Rewrite::finish`] the output's name ends in `.part`; a later run begins
/// it anew.
pub struct Rewrite {
    walk: Walk<BufReader<File>>,
    copying: Copying,
    file: File,
    unfinished: PathBuf,
    report: RecoverReport,
    channels: Vec<(Arc<ChannelSpec>, u16)>,
}

impl Rewrite {
    /// Begins to write `input` again as the new file `output`.
    ///
    /// # Errors
    /// When `input` is no recording, or `output` exists or cannot be made.
    pub fn begin(input: &Path, output: &Path, options: &WriterOptions) -> Result<Self, RecordingError> {
        let outline = Outline::read(input)?;
        let mut walk = Walk::open(input, CutChunk::Skip)?;
        walk.predeclare(&outline.summary);
        if output.exists() {
            let taken = std::io::Error::from(std::io::ErrorKind::AlreadyExists);
            return Err(RecordingError::io("cannot create", output)(taken));
        }
        let mut unfinished = output.as_os_str().to_owned();
        unfinished.push(UNFINISHED);
        let unfinished = PathBuf::from(unfinished);
        let file = File::create(&unfinished).map_err(RecordingError::io("cannot create", &unfinished))?;
        let copy = file.try_clone().map_err(RecordingError::io("cannot open twice", &unfinished))?;
        Ok(Self {
            walk,
            copying: Copying::begin(copy, options, &outline)?,
            file,
            unfinished,
            report: RecoverReport::begin(input, output, outline.cut_bytes),
            channels: Vec::new(),
        })
    }

    /// Copies the next message and what stands before it; `None` at the end.
    ///
    /// # Errors
    /// When the disk fails. Damage in the input is stepped over and told at the end.
    pub fn copy_message(&mut self) -> Result<Option<RecordedMessage>, RecordingError> {
        while let Some(copied) = self.copying.step(&mut self.walk, &mut self.report)? {
            if let Copied::Message(message) = copied {
                return Ok(Some(message));
            }
        }
        Ok(None)
    }

    /// Adds a message behind what was copied so far. Its channel must not be one of the original's.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn add(&mut self, message: &Message) -> Result<(), RecordingError> {
        let known = self.channels.iter().find(|(spec, _)| Arc::ptr_eq(spec, &message.channel));
        let id = match known {
            Some(&(_, id)) => id,
            None => {
                let id = self.copying.declare(&message.channel)?;
                self.channels.push((Arc::clone(&message.channel), id));
                id
            }
        };
        self.copying.add(id, message)
    }

    /// Adds a metadata record behind what was copied so far.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn add_metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), RecordingError> {
        self.copying.metadata(&Metadata { name: name.to_owned(), metadata })
    }

    /// Adds an attachment behind what was copied so far.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn attach(&mut self, attachment: &Attachment) -> Result<(), RecordingError> {
        self.copying.attach(&mcap::Attachment {
            log_time: attachment.log_time_ns,
            create_time: attachment.log_time_ns,
            name: attachment.name.clone(),
            media_type: attachment.media_type.clone(),
            data: attachment.data.as_ref().into(),
        })
    }

    /// Copies the rest, makes everything durable and gives the file its name.
    ///
    /// # Errors
    /// When the disk fails, or somebody took the name meanwhile.
    pub fn finish(mut self) -> Result<RecoverReport, RecordingError> {
        while self.copy_message()?.is_some() {}
        self.copying.finish(&self.report)?;
        self.file.sync_all().map_err(RecordingError::io("cannot sync", &self.unfinished))?;
        let named = rename_new(&self.unfinished, &self.report.output);
        if named.is_err() {
            // The name is taken; nothing points to this file any more.
            let _ = fs::remove_file(&self.unfinished);
        }
        named.map_err(RecordingError::io("cannot give its name to", &self.report.output))?;
        Ok(self.report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        check::{Verdict, check},
        testing::{at_ms, channel, message, names, options, read_strictly, recorder},
    };

    #[test]
    fn every_message_stays_and_the_added_ones_stand_beside_them() {
        let directory = tempfile::tempdir().unwrap();
        let mut recorder = recorder(options(directory.path()));
        let (image, log, again) = (channel("/image"), channel("/log"), channel("/again"));
        for n in 0..40 {
            recorder.store(vec![message(&image, n, 900), message(&log, n, 20)], at_ms(u64::from(n)));
        }
        recorder.finish(at_ms(50));
        let input = directory.path().join(names(directory.path()).pop().unwrap());
        let output = directory.path().join("again.mcap");
        let mut rewrite = Rewrite::begin(&input, &output, &WriterOptions::default()).unwrap();
        while let Some(copied) = rewrite.copy_message().unwrap() {
            if copied.channel.topic == "/image" && copied.sequence % 2 == 0 {
                rewrite.add(&message(&again, copied.sequence, 30)).unwrap();
            }
        }
        rewrite.finish().unwrap();
        let (old, new) = (read_strictly(&input), read_strictly(&output));
        let kept: Vec<_> = new.iter().filter(|message| message.channel.topic != "/again").collect();
        assert_eq!(kept, old.iter().collect::<Vec<_>>());
        assert_eq!(new.len(), old.len() + 20);
        assert_eq!(
            check(&output).unwrap().verdict(),
            Verdict::Fine,
            "{:?}",
            check(&output).unwrap().findings
        );
        assert!(Rewrite::begin(&input, &output, &WriterOptions::default()).is_err(), "it exists");
        assert!(!names(directory.path()).iter().any(|name| name.ends_with(".part")));
    }
}
