//! A recorder's own file is fine; each kind of damage is named.

use std::{fs, path::PathBuf};

use super::*;
use crate::testing::{at_ms, channel, latched, message, names, options, recorder};

fn finished(directory: &Path) -> PathBuf {
    let mut recorder = recorder(options(directory));
    let (landmark, log) = (channel("/landmark"), channel("/log"));
    recorder.store(vec![latched(&landmark, 0, "red")], at_ms(0));
    recorder.command(crate::Command::Split, at_ms(1));
    for n in 0..20 {
        recorder.store(vec![message(&log, n, 300)], at_ms(u64::from(n)));
    }
    recorder.finish(at_ms(100));
    directory.join(names(directory).pop().unwrap())
}

fn findings(path: &Path) -> Vec<Finding> {
    check(path).unwrap().findings
}

#[test]
fn our_own_file_is_fine() {
    let directory = tempfile::tempdir().unwrap();
    assert_eq!(findings(&finished(directory.path())), []);
}

#[test]
fn a_cut_file_is_damaged() {
    let directory = tempfile::tempdir().unwrap();
    let path = finished(directory.path());
    let content = fs::read(&path).unwrap();
    for cut in (0..content.len()).step_by(101) {
        fs::write(&path, &content[..cut]).unwrap();
        let findings = findings(&path);
        assert!(
            findings.iter().any(|f| f.severity == Severity::Error && f.aspect == Aspect::Structure),
            "{cut}"
        );
    }
}

#[test]
fn every_flipped_byte_before_the_closing_magic_is_found() {
    let directory = tempfile::tempdir().unwrap();
    let path = finished(directory.path());
    let content = fs::read(&path).unwrap();
    for at in (8..content.len()).step_by(7) {
        let mut flipped = content.clone();
        flipped[at] ^= 0x04;
        fs::write(&path, &flipped).unwrap();
        assert_eq!(check(&path).unwrap().verdict(), Verdict::Damaged, "byte {at} of {}", content.len());
    }
}

#[test]
fn losses_make_the_verdict() {
    let directory = tempfile::tempdir().unwrap();
    let mut recorder = recorder(options(directory.path()));
    let mut refused = crate::Ledger::default();
    refused.topic("/image").lost_in_queue = 2;
    recorder.note_refused(&refused);
    recorder.finish(at_ms(1));
    let check = check(&directory.path().join(names(directory.path()).pop().unwrap())).unwrap();
    assert_eq!(check.verdict(), Verdict::DataLost);
    assert_eq!(check.findings[0].message, "/image: 2 of 2 messages lost (2 in the queue, 0 on disk)");
}

#[test]
fn a_recovered_file_is_valid_and_says_so() {
    let directory = tempfile::tempdir().unwrap();
    let path = finished(directory.path());
    let content = fs::read(&path).unwrap();
    for (kept_bytes, verdict) in
        [(content.len() - 1, Verdict::Fine), (content.len() / 2, Verdict::DataLost), (300, Verdict::DataLost)]
    {
        let (cut, output) = (directory.path().join("cut"), directory.path().join("out.mcap"));
        fs::write(&cut, &content[..kept_bytes]).unwrap();
        crate::recover::recover(&cut, &output, &crate::WriterOptions::default()).unwrap();
        let check = check(&output).unwrap();
        assert!(check.findings.iter().any(|f| f.message.starts_with("recovered from cut")), "{check:?}");
        assert_eq!(check.verdict(), verdict, "{kept_bytes} bytes kept");
        fs::remove_file(output).unwrap();
    }
}

#[test]
fn messages_are_held_against_their_schema() {
    let directory = tempfile::tempdir().unwrap();
    let mut recorder = recorder(options(directory.path()));
    let mut spec = crate::ChannelSpec::clone(&channel("/log"));
    recorder.store(vec![message(&spec.clone().into(), 0, 10)], at_ms(0));
    let garbage = crate::Message { data: b"\xff\xff".as_slice().into(), ..message(&channel("/log"), 1, 10) };
    recorder.store(vec![garbage], at_ms(0));
    (spec.topic, spec.schema.name) = ("/other".to_owned(), "test.Absent".to_owned());
    recorder.store(vec![message(&spec.into(), 2, 10)], at_ms(0));
    recorder.finish(at_ms(1));
    let findings = findings(&directory.path().join(names(directory.path()).pop().unwrap()));
    assert!(
        findings.iter().all(|f| f.aspect == Aspect::Schema && f.severity == Severity::Error),
        "{findings:?}"
    );
    assert!(findings[0].message.starts_with("message 1 on /log is no test.Message"), "{findings:?}");
    assert!(findings[1].message.contains("\"test.Absent\" is not in its FileDescriptorSet"), "{findings:?}");
    assert_eq!(findings.len(), 2);
}
