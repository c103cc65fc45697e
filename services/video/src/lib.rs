//! H.264 (ITU-T H.264) and MP4 (ISO/IEC 14496-14): live streams and films to [`vision::Frame`]s, and back.
//!
//! The codec is OpenH264, which is C++: what it is given is looked at first, so that a stream that claims too large a
//! picture is refused before anything is allocated for it ([`sequence`]).

pub mod access_unit;
mod bits;
mod colour;
pub mod encoder;
mod error;
pub mod film;
pub mod film_writer;
mod picture;
mod sample_table;
pub mod sequence;
pub mod stream;

pub use encoder::{EncodedPicture, EncoderOptions, Quantizer, StreamEncoder};
pub use error::VideoError;
pub use film::FilmReader;
pub use film_writer::FilmWriter;
pub use stream::{Decoded, StreamDecoder};
