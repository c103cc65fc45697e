//! Every command line in the documents exists: its subcommands, and each of its flags.

use std::process::Command;

use tests::{waymark, workspace};

const DOCUMENTS: [&str; 2] = ["README.md", "ARCHITECTURE.md"];
/// How the documents start the program.
const STARTS: [&str; 2] = ["waymark ", "cargo run --release -- "];

#[test]
fn every_documented_command_and_flag_exists() {
    let mut checked = 0;
    for document in DOCUMENTS {
        let text = std::fs::read_to_string(workspace().join(document)).unwrap();
        for line in shell_lines(&text) {
            check(document, &line);
            checked += 1;
        }
    }
    assert!(
        checked > 5,
        "only {checked} command lines found in {DOCUMENTS:?}: is the reading of them right?"
    );
}

fn check(document: &str, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let subcommands = subcommands_of(&words);
    let help = help(&subcommands)
        .unwrap_or_else(|error| panic!("{document}: `{line}`: waymark {subcommands:?} --help: {error}"));
    for flag in words.iter().filter(|word| word.starts_with('-') && word.len() > 1) {
        let flag = flag.split('=').next().unwrap_or(flag);
        let listed = help.split(|c: char| c.is_whitespace() || ",[]<>=".contains(c)).any(|word| word == flag);
        assert!(listed, "{document}: `{line}`: waymark {subcommands:?} has no {flag}");
    }
}

/// The leading words that the program knows as commands.
fn subcommands_of<'a>(words: &[&'a str]) -> Vec<&'a str> {
    let mut known = Vec::new();
    for word in words {
        let listed = help(&known).unwrap_or_default();
        let mut commands = listed
            .lines()
            .skip_while(|line| *line != "Commands:")
            .skip(1)
            .take_while(|line| !line.is_empty());
        if !commands.any(|line| line.split_whitespace().next() == Some(word)) {
            break;
        }
        known.push(*word);
    }
    assert!(!known.is_empty(), "`waymark {}` names no command", words.join(" "));
    known
}

fn help(subcommands: &[&str]) -> Result<String, String> {
    let output =
        Command::new(waymark()).args(subcommands).arg("--help").output().map_err(|e| e.to_string())?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
}

/// Command lines of all `sh` blocks, continued lines joined, without redirections and comments.
fn shell_lines(document: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut in_block = false;
    let mut continued = String::new();
    for line in document.lines() {
        if line.starts_with("```") {
            in_block = line == "```sh";
        } else if in_block && line.trim_end().ends_with('\\') {
            continued.push_str(line.trim_end().trim_end_matches('\\'));
        } else if in_block {
            lines.push(std::mem::take(&mut continued) + line);
        }
    }
    let commands = lines.iter().filter_map(|line| {
        let line = line.split(['>', '|', ';']).next()?.split(" #").next()?.trim();
        STARTS.iter().find_map(|start| line.strip_prefix(start))
    });
    commands.map(str::to_owned).collect()
}

#[test]
fn shell_lines_are_found_and_cleaned() {
    let document = "```sh\nwaymark register a \\\n  --landmark b.json > out.csv\ncargo build\n```\n```toml\nwaymark x\n```\n";
    assert_eq!(shell_lines(document), ["register a   --landmark b.json"]);
}
