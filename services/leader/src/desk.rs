//! Where all changes of the set are made, one after the other.

use std::sync::Arc;
use std::time::Duration;

use runtime::Shutdown;
use runtime::identity::unix_time_ns;
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval};
use vision::SetVersion;
use waymark_proto::convert::manifest_of;
use waymark_proto::keys::VehicleKeys;
use zenoh::query::Query;

use crate::announcements::Announcements;
use crate::answers::{answer_edit, edit_of};
use crate::book::{Book, Change, Edit, RefusedEdit};
use crate::handle::Request;
use crate::memory::Memory;
use crate::publication::Publication;
use crate::run::LeaderReport;
use crate::status::EditCounts;
use crate::web::Face;

const EVERY_SECOND: Duration = Duration::from_secs(1);

/// The set and everyone who must hear of its changes.
pub(crate) struct Desk {
    pub(crate) keys: VehicleKeys,
    pub(crate) book: Book,
    pub(crate) memory: Memory,
    pub(crate) announcements: Announcements,
    pub(crate) publications: watch::Sender<Publication>,
    pub(crate) edits: watch::Sender<EditCounts>,
    pub(crate) face: Arc<Face>,
}

impl Desk {
    /// Makes changes, and tells of the set every second, until `shutdown`.
    pub(crate) async fn work(
        mut self,
        mut queries: mpsc::Receiver<Query>,
        mut requests: mpsc::Receiver<Request>,
        shutdown: &Shutdown,
    ) -> LeaderReport {
        let mut second = interval(EVERY_SECOND);
        second.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                () = shutdown.requested() => break,
                Some(query) = queries.recv() => self.answer(&query).await,
                Some(request) = requests.recv() => {
                    let made = self.make(request.edit).await;
                    // Whoever asked may have gone.
                    let _ = request.answer.send(made);
                }
                _ = second.tick() => self.tell().await,
            }
        }
        let edits = *self.edits.borrow();
        LeaderReport { set: Arc::new(self.book.set()), edits }
    }

    async fn tell(&self) {
        let publication = self.publications.borrow().clone();
        self.announcements.say_manifest(&publication).await;
        let status = self.face.status().await.to_wire(unix_time_ns());
        self.announcements.say_status(&status).await;
    }

    async fn answer(&mut self, query: &Query) {
        let refusal = match edit_of(query) {
            Err(no_edit) => {
                self.edits.send_modify(|edits| edits.refused += 1);
                no_edit.to_string()
            }
            Ok(edit) => self.make(edit).await.err().map_or_else(String::new, |refused| refused.to_string()),
        };
        answer_edit(query, &self.keys, manifest_of(&self.book.set()), refusal);
    }

    async fn make(&mut self, edit: Edit) -> Result<SetVersion, RefusedEdit> {
        let applied = self.book.apply(edit);
        self.edits.send_modify(|edits| match &applied {
            Ok(_) => edits.made += 1,
            Err(_) => edits.refused += 1,
        });
        let change = applied?;
        if !change.is_empty() {
            self.spread(&change).await;
        }
        Ok(self.book.set().version)
    }

    /// Keeps a change and tells everyone of it.
    async fn spread(&mut self, change: &Change) {
        let set = self.book.set();
        let version = set.version;
        if let Err(error) = self.memory.keep(&set) {
            tracing::error!(%error, "the set is not on disk: the next start would lack this change");
        }
        match Publication::of(set, &self.keys) {
            Ok(publication) => {
                self.publications.send_replace(publication.clone());
                self.announcements.say_change(change, &publication).await;
            }
            Err(error) => tracing::error!(%error, "a landmark has no key"),
        }
        let (published, retired) = (change.published.len(), change.retired.len());
        tracing::info!(epoch = version.epoch, version = version.version, published, retired, "landmark set");
    }
}
