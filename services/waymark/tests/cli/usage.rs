//! Help, versions and usage errors.

use crate::program::waymark;

#[test]
fn help_lists_every_command_and_the_exit_codes() {
    let help = waymark(["--help"]).ended(0).stdout;
    for command in [
        "landmark",
        "register",
        "explain",
        "compare",
        "experiments",
        "recording",
        "doctor",
        "config",
        "completion",
    ] {
        assert!(help.lines().any(|line| line.trim_start().starts_with(command)), "{command}: {help}");
    }
    assert!(help.contains("0 fine, 1 failed, 2 usage or configuration, 3 finished with data lost"), "{help}");
}

#[test]
fn every_command_explains_itself() {
    for command in [
        &["register"][..],
        &["landmark", "learn"],
        &["landmark", "show"],
        &["compare"],
        &["experiments"],
        &["recording", "info"],
        &["recording", "check"],
        &["recording", "recover"],
        &["doctor"],
        &["config", "show"],
        &["config", "check"],
        &["config", "schema"],
        &["config", "acl"],
        &["completion"],
    ] {
        let help = waymark([command, &["--help"]].concat()).ended(0).stdout;
        assert!(help.contains("Usage: waymark") && help.contains("Options:"), "{help}");
    }
}

#[test]
fn mistakes_are_usage_errors() {
    waymark(["regsiter"]).ended(2).telling("register");
    waymark::<&str>([]).ended(2);
    waymark(["register", "x", "--mode", "magic"]).ended(2).telling("faithful");
}

#[test]
fn completion_knows_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        let script = waymark(["completion", shell]).ended(0).stdout;
        for command in ["recover", "doctor", "schema", "acl"] {
            assert!(script.contains(command), "{shell}: {command}");
        }
    }
}
