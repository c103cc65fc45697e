//! The convoy itself: who is started, who connects to whom, and in which order they end.

use analysis::lesson::{FOLLOWER, LEADER};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use ::camera::{CameraConfig, CameraReport};
use ::follower::{FollowerConfig, FollowerReport};
use ::leader::{Leader, LeaderConfig};
use anyhow::Context;
use leader::Edit;
use runtime::identity::unix_time_ns;
use runtime::{SessionSettings, Shutdown};
use tokio::net::TcpListener;
use tokio::task::JoinHandle;
use vision::Landmark;
use waymark_proto::keys::{CameraStream, Id, VehicleKeys};
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;
use zenoh::Session;
use zenoh::pubsub::Subscriber;

use super::Args;
use super::score::Scorer;

const FLEET: &str = "demo";
const CAMERA: &str = "front";

/// A convoy that drives.
pub(super) struct Convoy {
    started_at: Instant,
    parts: Shutdown,
    cameras_stop: Shutdown,
    cameras: Vec<JoinHandle<Result<CameraReport, ::camera::CameraError>>>,
    follower: JoinHandle<Result<FollowerReport, ::follower::FollowerError>>,
    leader: Leader,
    judge: Judge,
    sessions: Vec<Session>,
    pages: (String, String),
    /// Deleted with everything in it at the end.
    _state: tempfile::TempDir,
}

/// What a drive has shown.
pub(super) struct Driven {
    pub(super) duration: Duration,
    pub(super) follower: FollowerReport,
    pub(super) scorer: Scorer,
    pub(super) page: String,
}

impl Convoy {
    /// Starts router, leader, follower and both cameras. `interrupted` ends it early.
    pub(super) async fn start(
        args: &Args,
        lesson: Vec<Landmark>,
        interrupted: &Shutdown,
    ) -> anyhow::Result<Self> {
        let endpoint = free_endpoint().context("no free TCP port on 127.0.0.1")?;
        let listener = TcpListener::bind(args.listen)
            .await
            .with_context(|| format!("--listen {} cannot be bound; choose another address", args.listen))?;
        let follower_page = listener.local_addr()?;
        let mut sessions = vec![SessionSettings::router(&endpoint).open().await?];
        for _ in 0..5 {
            sessions.push(SessionSettings::client(&endpoint).open().await?);
        }
        let [_, for_leader, for_follower, for_judge, first_camera, second_camera] = sessions.as_slice()
        else {
            anyhow::bail!("six sessions were opened");
        };
        anyhow::ensure!(!interrupted.is_requested(), "interrupted before the convoy was under way");
        let (parts, cameras_stop) = (Shutdown::new(), Shutdown::new());
        let state = tempfile::tempdir().context("no directory for the demo's state")?;
        let leader =
            Leader::start(&leader_config(args, state.path()), for_leader.clone(), parts.clone()).await?;
        leader.handle().edit(Edit { publish: lesson, ..Edit::default() }).await?;
        let judge = Judge::begin(for_judge).await?;
        let pages = (page(follower_page), page(leader.page()));
        let config = follower_config(args, follower_page, state.path());
        let follower =
            tokio::spawn(::follower::run_on(listener, config, for_follower.clone(), parts.clone()));
        let camera = |vehicle: &str, number, session: &Session| {
            tokio::spawn(::camera::run(
                camera_config(args, vehicle, number),
                session.clone(),
                cameras_stop.clone(),
            ))
        };
        let cameras =
            vec![camera("leader", LEADER, first_camera), camera("follower", FOLLOWER, second_camera)];
        let started_at = Instant::now();
        Ok(Self {
            started_at,
            parts,
            cameras_stop,
            cameras,
            follower,
            leader,
            judge,
            sessions,
            pages,
            _state: state,
        })
    }

    /// Where to look.
    pub(super) fn greeting(&self, headless: bool) -> String {
        let (follower, leader) = &self.pages;
        match headless {
            true => format!("follower {follower}\nleader   {leader}"),
            false => format!(
                "A convoy is driving. Look through the follower's eyes:\n\n    {follower}\n\n\
                 The leader's page is {leader}. End with Ctrl-C."
            ),
        }
    }

    /// Drives until `duration` is over or `interrupted`, then ends every part: cameras first, so that everything they
    /// sent is looked at and recorded.
    pub(super) async fn drive(
        mut self,
        duration: Option<Duration>,
        interrupted: &Shutdown,
    ) -> anyhow::Result<Driven> {
        let over = async {
            match duration {
                Some(duration) => tokio::time::sleep(duration).await,
                None => std::future::pending().await,
            }
        };
        let early = tokio::select! {
            () = over => None,
            () = interrupted.requested() => None,
            ended = &mut self.follower => Some(ended),
        };
        let driven_for = self.started_at.elapsed();
        if let Some(ended) = early {
            ended??;
            anyhow::bail!("the follower ended by itself");
        }
        self.cameras_stop.request();
        for camera in self.cameras {
            camera.await??;
        }
        self.parts.request();
        let follower = self.follower.await??;
        self.leader.finished().await?;
        let scorer = self.judge.finish().await;
        for session in self.sessions.into_iter().rev() {
            // At the end of the process; whoever is still connected sees the end by itself.
            let _ = session.close().await;
        }
        Ok(Driven { duration: driven_for, follower, scorer, page: self.pages.0 })
    }
}

/// Listens to what the follower says and what is true.
struct Judge {
    scorer: Arc<Mutex<Scorer>>,
    registrations: Subscriber<()>,
    truths: Subscriber<()>,
}

impl Judge {
    async fn begin(session: &Session) -> anyhow::Result<Self> {
        let keys = VehicleKeys::new(FLEET, "follower")?;
        let camera = Id::new("camera", CAMERA)?;
        let scorer = Arc::new(Mutex::new(Scorer::default()));
        let truths =
            subscribe(session, keys.camera(&camera, CameraStream::Truth), &scorer, |scorer, truth| {
                scorer.truth(truth);
            });
        let registrations = subscribe(
            session,
            keys.camera(&camera, CameraStream::Registration),
            &scorer,
            |scorer, registration: v1::Registration| {
                let latency_ns = unix_time_ns() - registration.captured_at_ns;
                scorer.registration(&registration, latency_ns as f64 * 1e-6);
            },
        );
        Ok(Self { truths: truths.await?, registrations: registrations.await?, scorer })
    }

    async fn finish(self) -> Scorer {
        for subscriber in [self.registrations, self.truths] {
            if let Err(error) = subscriber.undeclare().await {
                tracing::debug!(%error, "a subscription ended with its session");
            }
        }
        std::mem::take(&mut *self.scorer.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

async fn subscribe<M: WireMessage + 'static>(
    session: &Session,
    key: String,
    scorer: &Arc<Mutex<Scorer>>,
    take: fn(&mut Scorer, M),
) -> anyhow::Result<Subscriber<()>> {
    let scorer = Arc::clone(scorer);
    let subscriber = session.declare_subscriber(key).callback(move |sample| {
        match M::from_payload(&sample.payload().to_bytes()) {
            Ok(message) => take(&mut scorer.lock().unwrap_or_else(PoisonError::into_inner), message),
            Err(refused) => tracing::error!(%refused, "not scored"),
        }
    });
    subscriber.await.map_err(|error| anyhow::anyhow!(error).context("subscribing to what is to be scored"))
}

fn leader_config(args: &Args, state: &Path) -> LeaderConfig {
    let mut config = LeaderConfig {
        fleet: FLEET.to_owned(),
        vehicle: "leader".to_owned(),
        cameras: vec![CAMERA.to_owned()],
        state_dir: state.join("leader"),
        ..LeaderConfig::default()
    };
    config.http.listen = args.leader_listen;
    config
}

fn follower_config(args: &Args, page: SocketAddr, state: &Path) -> FollowerConfig {
    let mut config = FollowerConfig {
        fleet: FLEET.to_owned(),
        vehicle: "follower".to_owned(),
        leader: "leader".to_owned(),
        cameras: vec![CAMERA.to_owned()],
        state_dir: state.join("follower"),
        ..FollowerConfig::default()
    };
    config.http.listen = page;
    config.recorder.directory.clone_from(&args.recordings);
    config
}

fn camera_config(args: &Args, vehicle: &str, number: u32) -> CameraConfig {
    CameraConfig {
        fleet: FLEET.to_owned(),
        vehicle: vehicle.to_owned(),
        camera: CAMERA.to_owned(),
        source: format!("sim:{}?seed={}&vehicle={number}", args.scene, args.seed),
        ..CameraConfig::default()
    }
}

/// A router's endpoint on a port that nobody listened on a moment ago.
fn free_endpoint() -> std::io::Result<String> {
    let listener = std::net::TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    Ok(format!("tcp/{}", listener.local_addr()?))
}

fn page(address: SocketAddr) -> String {
    format!("http://{address}/")
}
