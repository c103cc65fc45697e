//! Changes of a running leader's set from within its process.

use std::sync::Arc;

use tokio::sync::{mpsc, oneshot, watch};
use vision::{LandmarkSet, SetVersion};

use crate::book::{Edit, RefusedEdit};
use crate::publication::Publication;

/// Changes a running leader's set from within its process.
#[derive(Clone, Debug)]
pub struct LeaderHandle {
    requests: mpsc::Sender<Request>,
    publications: watch::Receiver<Publication>,
}

/// Why an edit was not made.
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// The leader refused it.
    #[error(transparent)]
    Refused(#[from] RefusedEdit),
    /// The leader has ended.
    #[error("the leader has ended")]
    Ended,
}

/// An edit, and where its outcome is awaited.
#[derive(Debug)]
pub(crate) struct Request {
    pub(crate) edit: Edit,
    pub(crate) answer: oneshot::Sender<Result<SetVersion, RefusedEdit>>,
}

impl LeaderHandle {
    /// A handle whose requests, at most `waiting` at once, come out at the other end.
    pub(crate) fn new(
        publications: watch::Receiver<Publication>,
        waiting: usize,
    ) -> (Self, mpsc::Receiver<Request>) {
        let (requests, received) = mpsc::channel(waiting);
        (Self { requests, publications }, received)
    }

    /// Makes an edit and returns the version of the set that is in force then.
    ///
    /// # Errors
    /// When it is refused, or the leader has ended.
    pub async fn edit(&self, edit: Edit) -> Result<SetVersion, EditError> {
        let (answer, answered) = oneshot::channel();
        self.requests.send(Request { edit, answer }).await.map_err(|_| EditError::Ended)?;
        Ok(answered.await.map_err(|_| EditError::Ended)??)
    }

    /// The set in force.
    #[must_use]
    pub fn landmarks(&self) -> Arc<LandmarkSet> {
        Arc::clone(&self.publications.borrow().set)
    }
}
