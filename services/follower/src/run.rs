//! Puts a follower together, runs it until shutdown, and takes it apart in the order that loses nothing: first the
//! pictures stop, then the camera threads look at what they have, then the results go out, then the file is finished.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use http_face::{Cameras, Events, Policy, Token};
use recording::{Journal, JournalOptions, Report, Rotation};
use runtime::presence::{Presence, PresencePlace};
use runtime::{Identity, Shutdown, StateDir};
use tokio::net::TcpListener;
use tokio::sync::watch;
use tokio::task::JoinSet;
use vision::LandmarkSet;
use waymark_proto::keys::{Id, PresenceKey, Role, VehicleKeys};
use zenoh::Session;

use crate::config::FollowerConfig;
use crate::counters::LandmarkCounters;
use crate::error::FollowerError;
use crate::landmark_feed::LandmarkFeed;
use crate::landmark_log::LandmarkLog;
use crate::leader_watch::LeaderWatch;
use crate::leftovers;
use crate::pictures_out;
use crate::post::Post;
use crate::set_file::SetFile;
use crate::status::VehicleStatus;
use crate::status_beacon::StatusBeacon;
use crate::topics::VehicleTopics;
use crate::web::{self, Face};

/// How long the recording may take to be finished.
const FINISH_WITHIN: Duration = Duration::from_secs(2);
/// Events kept for a page that was away for a moment.
const EVENTS_KEPT: usize = 1024;

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
/// When something that it needs from the start is not to be had; what fails later is counted and shown instead.
pub async fn run(
    config: FollowerConfig,
    session: Session,
    shutdown: Shutdown,
) -> Result<FollowerReport, FollowerError> {
    let own = VehicleKeys::new(&config.fleet, &config.vehicle)?;
    let leader = VehicleKeys::new(&config.fleet, &config.leader)?;
    let address = config.http.listen;
    let listener =
        TcpListener::bind(address).await.map_err(|source| FollowerError::Listen { address, source })?;
    let state = StateDir::open(&config.state_dir)?;
    let identity = Identity::on(&state);
    let _presence = announce(&session, &own, &identity).await?;
    leftovers::recover(&config.recorder.directory);
    let journal = Arc::new(Journal::start(journal_options(&config))?);
    let landmark_counters = Arc::new(LandmarkCounters::default());
    let file = SetFile::new(state, &config.leader);
    let feed = LandmarkFeed::new(session.clone(), leader.clone(), file, Arc::clone(&landmark_counters))?;
    let landmarks = feed.landmarks();
    let posts = man_posts(&config, &own, &session, &journal, &landmarks).await?;
    let face = Arc::new(Face {
        vehicle: config.vehicle.clone(),
        instance: identity.instance,
        started_at: Instant::now(),
        session: session.clone(),
        landmarks: landmarks.clone(),
        leader: LeaderWatch::begin(&session, &leader, feed.last_heard()).await?,
        stations: posts.iter().map(Post::station).collect(),
        journal: Arc::clone(&journal),
        cameras: Arc::new(Cameras::new(
            config.cameras.clone(),
            pictures_out::LAYERS,
            &pictures_out::renderer(),
        )),
        events: Arc::new(Events::new(EVENTS_KEPT)),
        landmark_counters,
    });
    let beacon = StatusBeacon::declare(&session, &own, Arc::clone(&face)).await?;
    let topics = VehicleTopics::new(&own, &leader);

    let mut tasks = JoinSet::new();
    tasks.spawn(LandmarkLog::new(Arc::clone(&journal), topics.clone()).run(landmarks));
    tasks.spawn(beacon.run(topics, shutdown.clone()));
    tasks.spawn({
        let shutdown = shutdown.clone();
        async move {
            if let Err(error) = feed.run(shutdown).await {
                tracing::error!(%error, "landmarks are not followed any more");
            }
        }
    });
    let policy = policy(&config)?;
    let serving = tokio::spawn({
        let (routes, shutdown) = (web::routes(Arc::clone(&face)), shutdown.clone());
        async move { http_face::serve(listener, routes, policy, async move { shutdown.requested().await }).await }
    });
    let mut running = Vec::new();
    for post in posts {
        running.push(post.begin(&session, &own, Arc::clone(&face)).await?);
    }
    tracing::info!(vehicle = config.vehicle, leader = config.leader, page = %format!("http://{address}/"), "follower");

    shutdown.requested().await;
    let mut failed_cameras = Vec::new();
    for post in running {
        failed_cameras.extend(post.finish().await);
    }
    while tasks.join_next().await.is_some() {}
    if let Err(error) = serving.await {
        tracing::error!(%error, "the web face ended early");
    }
    let status = face.status().await;
    let recorder = finish(journal).await;
    Ok(FollowerReport { status, recorder, failed_cameras })
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
        posts
            .push(Post::set_up(id, config.follow_options(), own, session, journal, landmarks.clone()).await?);
    }
    Ok(posts)
}

/// The journal waits for the disk, so it is finished on a thread that may block.
async fn finish(journal: Arc<Journal>) -> Report {
    let closing = Arc::clone(&journal);
    let finished = tokio::task::spawn_blocking(move || closing.finish(FINISH_WITHIN)).await;
    finished.unwrap_or_else(|_| journal.finish(Duration::ZERO))
}

fn policy(config: &FollowerConfig) -> Result<Policy, FollowerError> {
    let token = config.http.token_file.as_deref().map(Token::from_file).transpose()?;
    Ok(Policy { hosts: config.http.hosts.clone(), token, ..Policy::default() })
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
        free_floor_bytes: recorder.min_free_bytes,
        metadata: BTreeMap::from([
            ("versions".to_owned(), versions),
            ("config".to_owned(), config.as_metadata()),
        ]),
        ..JournalOptions::new(&recorder.directory, &config.vehicle)
    }
}
