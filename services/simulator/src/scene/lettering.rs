//! Letters made of straight strokes, for signs.

use crate::solids::Board;
use crate::world::{Colour, Face, Layer, Light};

/// Strokes in a box one unit wide and high, origin at its lower left: from (x, y) to (x, y).
type Strokes = &'static [[[f64; 2]; 2]];

const TOP: [[f64; 2]; 2] = [[0.0, 1.0], [1.0, 1.0]];
const MIDDLE: [[f64; 2]; 2] = [[0.0, 0.5], [1.0, 0.5]];
const BOTTOM: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 0.0]];
const UPPER_LEFT: [[f64; 2]; 2] = [[0.0, 0.5], [0.0, 1.0]];
const LOWER_LEFT: [[f64; 2]; 2] = [[0.0, 0.0], [0.0, 0.5]];
const UPPER_RIGHT: [[f64; 2]; 2] = [[1.0, 0.5], [1.0, 1.0]];
const LOWER_RIGHT: [[f64; 2]; 2] = [[1.0, 0.0], [1.0, 0.5]];
const STEM: [[f64; 2]; 2] = [[0.5, 0.0], [0.5, 1.0]];

/// The letters that straight strokes can write.
pub(super) const LETTERS: &[u8] = b"ACEFHILOPSTU";

fn strokes(letter: u8) -> Strokes {
    match letter {
        b'A' => &[TOP, MIDDLE, UPPER_LEFT, LOWER_LEFT, UPPER_RIGHT, LOWER_RIGHT],
        b'C' => &[TOP, BOTTOM, UPPER_LEFT, LOWER_LEFT],
        b'E' => &[TOP, MIDDLE, BOTTOM, UPPER_LEFT, LOWER_LEFT],
        b'F' => &[TOP, MIDDLE, UPPER_LEFT, LOWER_LEFT],
        b'H' => &[MIDDLE, UPPER_LEFT, LOWER_LEFT, UPPER_RIGHT, LOWER_RIGHT],
        b'I' => &[STEM],
        b'L' => &[BOTTOM, UPPER_LEFT, LOWER_LEFT],
        b'O' => &[TOP, BOTTOM, UPPER_LEFT, LOWER_LEFT, UPPER_RIGHT, LOWER_RIGHT],
        b'P' => &[TOP, MIDDLE, UPPER_LEFT, LOWER_LEFT, UPPER_RIGHT],
        b'S' => &[TOP, MIDDLE, BOTTOM, UPPER_LEFT, LOWER_RIGHT],
        b'T' => &[TOP, STEM],
        b'U' => &[BOTTOM, UPPER_LEFT, LOWER_LEFT, UPPER_RIGHT, LOWER_RIGHT],
        _ => &[],
    }
}

/// One line of text on a board, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Its middle, to the right and up from the board's centre.
    pub(super) middle: [f64; 2],
    pub(super) letter_width: f64,
    pub(super) letter_height: f64,
    pub(super) stroke: f64,
    pub(super) colour: Colour,
}

impl Line {
    /// Paints `text` on `board`.
    pub(super) fn write(&self, text: &[u8], board: Board, light: &Light) -> Vec<Face> {
        let pitch = self.letter_width + 2.2 * self.stroke;
        let left = self.middle[0] - (pitch * (text.len() as f64 - 1.0) + self.letter_width) / 2.0;
        let bottom = self.middle[1] - self.letter_height / 2.0;
        let mut faces = Vec::new();
        for (index, &letter) in text.iter().enumerate() {
            let from = [left + pitch * index as f64, bottom];
            for stroke in strokes(letter) {
                let place =
                    |[x, y]: [f64; 2]| [from[0] + x * self.letter_width, from[1] + y * self.letter_height];
                let outline = bar(place(stroke[0]), place(stroke[1]), self.stroke);
                faces.push(board.face(&outline, self.colour, Layer::Paint, light));
            }
        }
        faces
    }
}

/// A bar of that thickness along an axis-parallel stroke, as much longer at both ends.
fn bar(from: [f64; 2], to: [f64; 2], thickness: f64) -> [[f64; 2]; 4] {
    let half = thickness / 2.0;
    let (left, right) = (from[0].min(to[0]) - half, from[0].max(to[0]) + half);
    let (low, high) = (from[1].min(to[1]) - half, from[1].max(to[1]) + half);
    [[left, low], [right, low], [right, high], [left, high]]
}
