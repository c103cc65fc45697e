//! Puts a leader together, runs it until shutdown, and takes it apart.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use http_face::HttpSettings;
use runtime::identity::unix_time_ns;
use runtime::presence::{Presence, PresencePlace};
use runtime::{Identity, Shutdown, StateDir};
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, mpsc, oneshot, watch};
use tokio::task::JoinHandle;
use tokio::time::{MissedTickBehavior, interval};
use vision::{LandmarkSet, SetVersion};
use waymark_proto::convert::manifest_of;
use waymark_proto::keys::{Id, InvalidId, PresenceKey, Role, VehicleKeys};
use zenoh::Session;
use zenoh::query::Query;

use crate::announcements::Announcements;
use crate::answers::{Answers, answer_edit, edit_of};
use crate::book::{Book, Edit, RefusedEdit};
use crate::camera_watch::{self, CameraWatch};
use crate::config::LeaderConfig;
use crate::error::LeaderError;
use crate::landmark_files::read_landmarks;
use crate::lessons::Lessons;
use crate::memory::Memory;
use crate::publication::Publication;
use crate::put_times::PutTimes;
use crate::status::EditCounts;
use crate::web::{self, Face};

/// Edits that may wait; more are not answered.
const WAITING_EDITS: usize = 16;
const EVERY_SECOND: Duration = Duration::from_secs(1);

/// What a leader leaves behind.
#[derive(Clone, Debug)]
pub struct LeaderReport {
    /// The set as it was last.
    pub set: Arc<LandmarkSet>,
    /// Changes asked for, by what came of them.
    pub edits: EditCounts,
}

/// Runs a leader until `shutdown`.
///
/// # Errors
/// When something that it needs from the start is not to be had, or it had to give way to another leader of the same
/// vehicle.
pub async fn run(
    config: LeaderConfig,
    session: Session,
    shutdown: Shutdown,
) -> Result<LeaderReport, LeaderError> {
    Leader::start(&config, session, shutdown).await?.finished().await
}

/// A running leader.
pub struct Leader {
    handle: LeaderHandle,
    page: SocketAddr,
    task: JoinHandle<Result<LeaderReport, LeaderError>>,
}

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

#[derive(Debug)]
struct Request {
    edit: Edit,
    answer: oneshot::Sender<Result<SetVersion, RefusedEdit>>,
}

impl Leader {
    /// Starts a leader; it is published and answers when this returns.
    ///
    /// # Errors
    /// When something that it needs from the start is not to be had.
    pub async fn start(
        config: &LeaderConfig,
        session: Session,
        shutdown: Shutdown,
    ) -> Result<Self, LeaderError> {
        let keys = VehicleKeys::new(&config.fleet, &config.vehicle)?;
        let from_files = read_landmarks(&config.landmarks)?;
        let listener = listen(&config.http).await?;
        let page = listener.local_addr().unwrap_or(config.http.listen);
        let policy = config.http.policy()?;
        let state = StateDir::open(&config.state_dir)?;
        let identity = Identity::on(&state);
        let presence = announce(&session, &keys, &identity).await?;
        let memory = Memory::in_directory(state);
        let mut book = memory.reopen()?;
        book.apply(Edit { publish: from_files, ..Edit::default() })?;
        memory.keep(&book.set())?;

        let (publications, published) = watch::channel(Publication::of(book.set(), &keys)?);
        let (queries_in, queries) = mpsc::channel(WAITING_EDITS);
        let (requests_in, requests) = mpsc::channel(WAITING_EDITS);
        let (edits, edits_seen) = watch::channel(EditCounts::default());
        let put_times = Arc::new(PutTimes::default());
        let cameras = camera_watch::cameras(&config.cameras);
        let mut watches = Vec::new();
        for camera in &config.cameras {
            watches.push(CameraWatch::begin(&session, &keys, camera, &cameras).await?);
        }
        let handle = LeaderHandle { requests: requests_in, publications: published.clone() };
        let face = Arc::new(Face {
            vehicle: config.vehicle.clone(),
            identity,
            session: session.clone(),
            publications: published.clone(),
            edits: edits_seen,
            put_times: Arc::clone(&put_times),
            desk: handle.clone(),
            cameras,
            camera_ids: config.cameras.clone(),
            lessons: Lessons::default(),
            learners: Arc::new(Semaphore::new(1)),
        });
        let answers = Answers::declare(&session, &keys, published.clone(), queries_in).await?;
        let announcements = Announcements::declare(&session, &keys, put_times).await?;
        announcements.say_all(&published.borrow().clone()).await;
        let serving = tokio::spawn({
            let (routes, shutdown) = (web::routes(&face), shutdown.clone());
            async move {
                http_face::serve(listener, routes, policy, async move { shutdown.requested().await }).await
            }
        });
        let desk = Desk { keys, book, memory, announcements, publications, edits, face };
        let task = tokio::spawn(async move {
            let work = desk.work(queries, requests, &shutdown);
            let (report, superseded) = presence.hold(work, &shutdown).await;
            if let Err(error) = serving.await {
                tracing::error!(%error, "the web face ended early");
            }
            for watch in watches {
                watch.end().await;
            }
            drop((answers, presence));
            superseded.map_or(Ok(report), |first| Err(first.into()))
        });
        tracing::info!(vehicle = config.vehicle, page = %format!("http://{page}/"), "leader");
        Ok(Self { handle, page, task })
    }

    /// A way to change the set.
    #[must_use]
    pub fn handle(&self) -> LeaderHandle {
        self.handle.clone()
    }

    /// Where the page is.
    #[must_use]
    pub fn page(&self) -> SocketAddr {
        self.page
    }

    /// Waits until the leader has ended.
    ///
    /// # Errors
    /// When it had to give way to another leader of the same vehicle.
    pub async fn finished(self) -> Result<LeaderReport, LeaderError> {
        let Self { handle, task, .. } = self;
        task.await.unwrap_or_else(|error| {
            tracing::error!(%error, "the leader ended early");
            Ok(LeaderReport { set: handle.landmarks(), edits: EditCounts::default() })
        })
    }
}

impl LeaderHandle {
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

/// Where all changes are made, one after the other.
struct Desk {
    keys: VehicleKeys,
    book: Book,
    memory: Memory,
    announcements: Announcements,
    publications: watch::Sender<Publication>,
    edits: watch::Sender<EditCounts>,
    face: Arc<Face>,
}

impl Desk {
    async fn work(
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
        let set = self.book.set();
        let version = set.version;
        if !change.is_empty() {
            if let Err(error) = self.memory.keep(&set) {
                tracing::error!(%error, "the set is not on disk: the next start would lack this change");
            }
            match Publication::of(set, &self.keys) {
                Ok(publication) => {
                    self.publications.send_replace(publication.clone());
                    self.announcements.say_change(&change, &publication).await;
                }
                Err(error) => tracing::error!(%error, "a landmark has no key"),
            }
            let (published, retired) = (change.published.len(), change.retired.len());
            tracing::info!(
                epoch = version.epoch,
                version = version.version,
                published,
                retired,
                "landmark set"
            );
        }
        Ok(version)
    }
}

async fn announce(
    session: &Session,
    keys: &VehicleKeys,
    identity: &Identity,
) -> Result<Presence, LeaderError> {
    let key = PresenceKey {
        fleet: keys.fleet().clone(),
        vehicle: keys.vehicle().clone(),
        role: Role::Leader,
        instance: instance_id(identity)?,
    };
    let place = PresencePlace { own_key: key.to_string(), siblings: key.siblings() };
    Ok(Presence::claim(session, &place, identity, env!("CARGO_PKG_VERSION")).await?)
}

fn instance_id(identity: &Identity) -> Result<Id, InvalidId> {
    Id::new("instance", &identity.instance)
}

async fn listen(http: &HttpSettings) -> Result<TcpListener, LeaderError> {
    let address = http.listen;
    TcpListener::bind(address).await.map_err(|source| LeaderError::Listen { address, source })
}
