//! Where a player is, on one line of the terminal.

use indicatif::ProgressStyle;
use player::{Control, Status};

use crate::console::Console;

/// Shows what the player says of itself until it ends; nothing where standard error is no terminal.
pub(super) async fn show(mut control: Control, console: Console) {
    let bar = console.progress(0, "");
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar}") {
        bar.set_style(style);
    }
    while let Some(status) = control.next_status().await {
        bar.set_length(milliseconds(status.duration_s.unwrap_or(status.position_s)));
        bar.set_position(milliseconds(status.position_s));
        bar.set_message(words(&status));
    }
    bar.finish_and_clear();
}

fn milliseconds(seconds: f64) -> u64 {
    (seconds * 1e3) as u64
}

fn words(status: &Status) -> String {
    let state = if status.paused { "paused " } else { "playing" };
    let rate = if status.rate == 0.0 { "fastest".to_owned() } else { format!("×{}", status.rate) };
    let duration = status.duration_s.map_or_else(|| "—".to_owned(), |duration_s| format!("{duration_s:.1}"));
    format!("{state} {:.1} of {duration} s, {rate}, {} published", status.position_s, status.published)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_says_where_how_fast_and_how_much() {
        let status =
            Status { position_s: 1.25, duration_s: Some(6.6), rate: 0.5, published: 7, ..Status::default() };
        assert_eq!(words(&status), "playing 1.2 of 6.6 s, ×0.5, 7 published");
        let paused = Status { paused: true, rate: 0.0, duration_s: None, ..status };
        assert_eq!(words(&paused), "paused  1.2 of — s, fastest, 7 published");
    }
}
