//! A film's pictures as frames of one camera, captured when they are shown.

use ingest::films::Film;

use super::InputFrame;

/// A film's pictures, numbered from 1.
#[derive(Debug)]
pub struct FilmFrames {
    film: Film,
    frame: u64,
}

impl FilmFrames {
    pub(super) fn new(film: Film) -> Self {
        Self { film, frame: 0 }
    }
}

impl Iterator for FilmFrames {
    type Item = InputFrame;

    fn next(&mut self) -> Option<InputFrame> {
        let picture = self.film.next()?.map_err(Into::into);
        self.frame += 1;
        let name = format!("{}, frame {}", self.film.path().display(), self.frame);
        Some(InputFrame::plain(self.frame, name, picture))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.film.size_hint()
    }
}
