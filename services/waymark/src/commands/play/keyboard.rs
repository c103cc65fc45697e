//! Single keys, where standard input is a terminal.

use std::io::{IsTerminal, Read, Stdin, stdin};

use player::{Command, Control};
use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcsetattr};

/// Seconds that one key press goes forward or back.
const SKIP_S: f64 = 10.0;

/// While it lives, keys are read one by one; afterwards the terminal is as it was.
pub(super) struct Keyboard {
    before: Termios,
}

impl Keyboard {
    /// Reads keys for `control`; `None` where there is no terminal.
    pub(super) fn begin(control: Control) -> Option<Self> {
        let input = stdin();
        if !input.is_terminal() {
            return None;
        }
        let before = tcgetattr(&input).ok()?;
        let mut single = before.clone();
        single.local_modes.remove(LocalModes::ICANON | LocalModes::ECHO);
        tcsetattr(&input, OptionalActions::Now, &single).ok()?;
        // It waits for a key for as long as the process lives, so nobody waits for it.
        let reader = std::thread::Builder::new().name("keyboard".to_owned());
        reader.spawn(move || read_keys(&input, &control)).ok()?;
        Some(Self { before })
    }
}

impl Drop for Keyboard {
    fn drop(&mut self) {
        // A terminal that is gone needs no restoring.
        let _gone = tcsetattr(stdin(), OptionalActions::Now, &self.before);
    }
}

fn read_keys(input: &Stdin, control: &Control) {
    for key in input.lock().bytes() {
        let Ok(key) = key else { return };
        if let Some(command) = meaning(key) {
            // A key that is held down asks more than can be done at once.
            let _asked_too_much = control.ask(command);
        }
    }
}

fn meaning(key: u8) -> Option<Command> {
    match key {
        b' ' => Some(Command::Toggle),
        b'f' => Some(Command::Skip(SKIP_S)),
        b'b' => Some(Command::Skip(-SKIP_S)),
        b'+' => Some(Command::Scale(2.0)),
        b'-' => Some(Command::Scale(0.5)),
        b'q' => Some(Command::Stop),
        _ => None,
    }
}
