//! Where frames come from: source URIs, pictures as they arrive, the newest-wins mailbox, and the thread that drives
//! [`vision::follow::Follow`].

pub mod camera_decoder;
pub mod camera_thread;
pub mod encoded;
pub mod films;
pub mod mailbox;
pub mod picture_message;
pub mod pictures;
pub mod recorded;
pub mod source;
pub mod video_thread;
pub mod view;
