//! Puts a leader together, runs it until shutdown, and takes it apart.

use std::net::SocketAddr;
use std::sync::Arc;

use http_face::{HttpSettings, Policy};
use runtime::presence::{Presence, PresencePlace};
use runtime::{Identity, Shutdown, StateDir};
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, mpsc, watch};
use tokio::task::JoinHandle;
use vision::{Landmark, LandmarkSet};
use waymark_proto::keys::{Id, InvalidId, PresenceKey, Role, VehicleKeys};
use zenoh::Session;

use crate::announcements::Announcements;
use crate::answers::Answers;
use crate::book::{Book, Edit};
use crate::camera_watch::{self, CameraWatch};
use crate::config::LeaderConfig;
use crate::desk::Desk;
use crate::error::LeaderError;
use crate::handle::LeaderHandle;
use crate::landmark_files::read_landmarks;
use crate::lessons::Lessons;
use crate::memory::Memory;
use crate::publication::Publication;
use crate::put_times::PutTimes;
use crate::status::EditCounts;
use crate::web::{self, Face};

/// Edits that may wait; more are not answered.
const WAITING_EDITS: usize = 16;

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
        let (book, memory) = reopen(state, from_files)?;

        let (publications, published) = watch::channel(Publication::of(book.set(), &keys)?);
        let (queries_in, queries) = mpsc::channel(WAITING_EDITS);
        let (handle, requests) = LeaderHandle::new(published.clone(), WAITING_EDITS);
        let (edits, edits_seen) = watch::channel(EditCounts::default());
        let (cameras, watches) = camera_watch::begin_all(&session, &keys, &config.cameras).await?;
        let put_times = Arc::new(PutTimes::default());
        let announcements = Announcements::declare(&session, &keys, Arc::clone(&put_times)).await?;
        let answers = Answers::declare(&session, &keys, published.clone(), queries_in).await?;
        announcements.say_all(&published.borrow().clone()).await;
        let face = Arc::new(Face {
            vehicle: config.vehicle.clone(),
            identity,
            session,
            publications: published,
            edits: edits_seen,
            put_times,
            desk: handle.clone(),
            cameras,
            camera_ids: config.cameras.clone(),
            lessons: Lessons::default(),
            learners: Arc::new(Semaphore::new(1)),
        });
        let serving = serve(listener, &face, policy, shutdown.clone());
        let desk = Desk { keys, book, memory, announcements, publications, edits, face };
        let staff = Staff { presence, serving, watches, answers };
        let task =
            tokio::spawn(
                async move { staff.attend(desk.work(queries, requests, &shutdown), &shutdown).await },
            );
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

/// What serves beside the desk, and is taken apart after it.
struct Staff {
    presence: Presence,
    serving: JoinHandle<()>,
    watches: Vec<CameraWatch>,
    answers: Answers,
}

impl Staff {
    /// Until `work` is done, which `shutdown` or an older leader of the same vehicle brings about.
    async fn attend(
        self,
        work: impl Future<Output = LeaderReport>,
        shutdown: &Shutdown,
    ) -> Result<LeaderReport, LeaderError> {
        let (report, superseded) = self.presence.hold(work, shutdown).await;
        if let Err(error) = self.serving.await {
            tracing::error!(%error, "the web face ended early");
        }
        for watch in self.watches {
            watch.end().await;
        }
        drop((self.answers, self.presence));
        superseded.map_or(Ok(report), |first| Err(first.into()))
    }
}

/// The set as it was last, with what stands in files.
fn reopen(state: StateDir, from_files: Vec<Landmark>) -> Result<(Book, Memory), LeaderError> {
    let memory = Memory::in_directory(state);
    let mut book = memory.reopen()?;
    book.apply(Edit { publish: from_files, ..Edit::default() })?;
    memory.keep(&book.set())?;
    Ok((book, memory))
}

fn serve(listener: TcpListener, face: &Arc<Face>, policy: Policy, shutdown: Shutdown) -> JoinHandle<()> {
    let routes = web::routes(face);
    tokio::spawn(async move {
        let _counted_by_the_face =
            http_face::serve(listener, routes, policy, async move { shutdown.requested().await }).await;
    })
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
