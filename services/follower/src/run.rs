//! Puts a follower together, runs it until shutdown, and takes it apart in the order that loses nothing: first the
//! pictures stop, then the camera threads look at what they have, then the results go out, then the file is finished.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;

use http_face::Policy;
use recording::{Journal, JournalOptions, PreTrigger, Report, Retention, Rotation};
use runtime::presence::{Presence, PresencePlace};
use runtime::{Identity, Shutdown, StateDir};
use tokio::net::TcpListener;
use tokio::sync::watch;
use tokio::task::JoinSet;
use vision::LandmarkSet;
use waymark_proto::keys::{Id, PresenceKey, Role, VehicleKeys};
use zenoh::Session;

use crate::config::FollowerConfig;
use crate::error::FollowerError;
use crate::fleet_watch::FleetWatch;
use crate::landmark_feed::LandmarkFeed;
use crate::landmark_log::LandmarkLog;
use crate::leader_watch::LeaderWatch;
use crate::leftovers;
use crate::post::{MannedPost, Post};
use crate::set_file::SetFile;
use crate::status::VehicleStatus;
use crate::status_beacon::StatusBeacon;
use crate::topics::VehicleTopics;
use crate::web::{self, Face};

/// How long the recording may take to be finished.
const FINISH_WITHIN: Duration = Duration::from_secs(2);

/// What a follower leaves behind.
#[derive(Clone, Debug)]
pub struct FollowerReport {
    /// Its last word on everything.
    pub status: VehicleStatus,
    /// The recorder's accounts.
    pub recorder: Report,
    /// Cameras whose thread panicked.
    pub failed_cameras: Vec<String>,
}

/// Runs a follower until `shutdown`.
///
/// # Errors
/// When something that it needs from the start is not to be had, or it had to give way to another follower of the same
/// vehicle; what fails later is counted and shown instead.
pub async fn run(
    config: FollowerConfig,
    session: Session,
    shutdown: Shutdown,
) -> Result<FollowerReport, FollowerError> {
    let address = config.http.listen;
    let listener =
        TcpListener::bind(address).await.map_err(|source| FollowerError::Listen { address, source })?;
    run_on(listener, config, session, shutdown).await
}

/// As [`run`], with a web face that listens already, so that its address can be told before the follower is up.
///
/// # Errors
/// As [`run`].
pub async fn run_on(
    listener: TcpListener,
    config: FollowerConfig,
    session: Session,
    shutdown: Shutdown,
) -> Result<FollowerReport, FollowerError> {
    let own = VehicleKeys::new(&config.fleet, &config.vehicle)?;
    let leader = VehicleKeys::new(&config.fleet, &config.leader)?;
    let state = StateDir::open(&config.state_dir)?;
    let identity = Identity::on(&state);
    let presence = announce(&session, &own, &identity).await?;
    leftovers::recover(&config.recorder.directory);
    let journal = Arc::new(Journal::start(journal_options(&config))?);
    let file = SetFile::new(state, &config.leader);
    let feed = LandmarkFeed::new(session.clone(), leader.clone(), file)?;
    let topics = VehicleTopics::new(&own, &leader);
    let first_set = Arc::clone(&feed.landmarks().borrow());
    let log = LandmarkLog::begin(Arc::clone(&journal), topics.clone(), &first_set);
    let posts = man_posts(&config, &own, &session, &journal, &log.in_force()).await?;
    let (fleet, watching) = FleetWatch::new(session.clone(), own.fleet(), shutdown.clone());
    let watch = LeaderWatch::begin(&session, &leader, feed.last_heard(), fleet).await?;
    let face = Arc::new(Face::new(&config, identity.instance, &session, &feed, watch, &posts, &journal));
    let beacon = StatusBeacon::declare(&session, &own, Arc::clone(&face)).await?;
    let policy = config.http.policy()?;

    let mut tasks = JoinSet::new();
    tasks.spawn(log.run(feed.landmarks()));
    tasks.spawn(watching);
    tasks.spawn(beacon.run(topics, shutdown.clone()));
    tasks.spawn(follow_landmarks(feed, shutdown.clone()));
    tasks.spawn(serve(listener, web::routes(&face), policy, shutdown.clone()));
    let mut running = Vec::new();
    for post in posts {
        running.push(post.begin(&session, &own, Arc::clone(&face)).await?);
    }
    tracing::info!(vehicle = config.vehicle, leader = config.leader, page = %config.http.listen, "follower");
    let ((), superseded) = presence.hold(shutdown.requested(), &shutdown).await;
    let report = wind_up(running, tasks, &face, journal).await?;
    superseded.map_or(Ok(report), |first| Err(first.into()))
}

/// Ends every part once its input has ended.
async fn wind_up(
    posts: Vec<MannedPost>,
    mut tasks: JoinSet<()>,
    face: &Face,
    journal: Arc<Journal>,
) -> Result<FollowerReport, FollowerError> {
    let mut failed_cameras = Vec::new();
    for post in posts {
        failed_cameras.extend(post.finish().await);
    }
    while let Some(ended) = tasks.join_next().await {
        if let Err(error) = ended {
            tracing::error!(%error, "a part of the follower ended early");
        }
    }
    let status = face.status().await;
    let recorder = finish(journal).await;
    Ok(FollowerReport { status, recorder, failed_cameras })
}

async fn follow_landmarks(feed: LandmarkFeed, shutdown: Shutdown) {
    if let Err(error) = feed.run(shutdown).await {
        tracing::error!(%error, "landmarks are not followed any more");
    }
}

async fn serve(listener: TcpListener, routes: Router, policy: Policy, shutdown: Shutdown) {
    http_face::serve(listener, routes, policy, async move { shutdown.requested().await }).await;
}

async fn announce(
    session: &Session,
    own: &VehicleKeys,
    identity: &Identity,
) -> Result<Presence, FollowerError> {
    let key = PresenceKey {
        fleet: own.fleet().clone(),
        vehicle: own.vehicle().clone(),
        role: Role::Follower,
        instance: Id::new("instance", &identity.instance)?,
    };
    let place = PresencePlace { own_key: key.to_string(), siblings: key.siblings() };
    Ok(Presence::claim(session, &place, identity, env!("CARGO_PKG_VERSION")).await?)
}

async fn man_posts(
    config: &FollowerConfig,
    own: &VehicleKeys,
    session: &Session,
    journal: &Arc<Journal>,
    landmarks: &watch::Receiver<Arc<LandmarkSet>>,
) -> Result<Vec<Post>, FollowerError> {
    let mut posts = Vec::new();
    for camera in &config.cameras {
        let id = Id::new("camera", camera)?;
        posts.push(Post::set_up(id, config, own, session, journal, landmarks.clone()).await?);
    }
    Ok(posts)
}

/// The journal waits for the disk, so it is finished on a thread that may block.
async fn finish(journal: Arc<Journal>) -> Report {
    let closing = Arc::clone(&journal);
    let finished = tokio::task::spawn_blocking(move || closing.finish(FINISH_WITHIN)).await;
    finished.unwrap_or_else(|_| journal.finish(Duration::ZERO))
}

fn journal_options(config: &FollowerConfig) -> JournalOptions {
    let recorder = &config.recorder;
    let versions = BTreeMap::from([("waymark".to_owned(), env!("CARGO_PKG_VERSION").to_owned())]);
    JournalOptions {
        begin: if recorder.enabled { recording::Command::Start } else { recording::Command::Stop },
        rotation: Rotation {
            max_bytes: recorder.max_file_bytes,
            max_duration: Duration::from_secs(recorder.max_file_s),
        },
        retention: (recorder.max_total_bytes > 0)
            .then_some(Retention { max_total_bytes: recorder.max_total_bytes }),
        free_floor_bytes: recorder.min_free_bytes,
        pre_trigger: (recorder.pre_trigger_s > 0).then_some(PreTrigger {
            duration: Duration::from_secs(recorder.pre_trigger_s),
            max_bytes: recorder.pre_trigger_max_bytes,
        }),
        metadata: BTreeMap::from([
            ("versions".to_owned(), versions),
            ("config".to_owned(), config.as_metadata()),
        ]),
        ..JournalOptions::new(&recorder.directory, &config.vehicle)
    }
}
