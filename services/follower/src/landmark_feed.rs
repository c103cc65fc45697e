//! Keeps the accepted set what the leader says it is: hears single landmarks and manifests, fetches the whole set
//! when they disagree, and writes what it accepted to disk, for the start without a leader.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use runtime::shutdown::Shutdown;
use tokio::sync::{mpsc, watch};
use tokio::time::{Instant, MissedTickBehavior, interval};
use vision::{Landmark, LandmarkSet};
use waymark_proto::attachment::Attachment;
use waymark_proto::convert::Manifest;
use waymark_proto::gaps::GapCounter;
use waymark_proto::keys::VehicleKeys;
use zenoh::Session;
use zenoh::qos::CongestionControl;
use zenoh::sample::{Sample, SampleKind};
use zenoh_ext::{AdvancedSubscriberBuilderExt, HistoryConfig, RecoveryConfig};

use crate::accepted::{AcceptedSet, Comparison, Offer};
use crate::counters::LandmarkCounters;
use crate::error::FollowerError;
use crate::set_file::SetFile;
use crate::wire;

/// Samples that may wait for this task; what does not fit is made good by the next manifest.
const WAITING_SAMPLES: usize = 1024;
/// How often an unanswered fetch is tried again, and an unknown manifest is asked for.
const RETRY_EVERY: Duration = Duration::from_secs(1);
/// How long a fetch waits for replies.
const REPLY_WITHIN: Duration = Duration::from_secs(2);

/// What the leader was heard to say.
enum Heard {
    Landmark(Sample),
    Manifest(Sample),
}

/// How the leader is heard.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeaderHeard {
    /// When last.
    pub(crate) at: Instant,
    /// Manifests that it sent and that did not arrive, by the gaps in their sequence; `None` while nothing can be said.
    pub(crate) missed: Option<u64>,
}

/// How the leader was last heard; `None` before the first time.
pub(crate) type LastHeard = watch::Receiver<Option<LeaderHeard>>;

/// A follower's side of the landmark set.
pub(crate) struct LandmarkFeed {
    session: Session,
    leader: VehicleKeys,
    accepted: AcceptedSet,
    wanted: Option<Manifest>,
    file: SetFile,
    published: watch::Sender<Arc<LandmarkSet>>,
    last_heard: watch::Sender<Option<LeaderHeard>>,
    gaps: GapCounter,
    counters: Arc<LandmarkCounters>,
}

impl LandmarkFeed {
    /// A feed of `leader`'s landmarks that begins with the set in `file`.
    ///
    /// # Errors
    /// When the file is there and cannot be read.
    pub(crate) fn new(session: Session, leader: VehicleKeys, file: SetFile) -> Result<Self, FollowerError> {
        let accepted = file.load()?;
        let published = watch::Sender::new(Arc::new(accepted.set()));
        let last_heard = watch::Sender::new(None);
        let counters = Arc::default();
        let gaps = GapCounter::default();
        Ok(Self { session, leader, accepted, wanted: None, file, published, last_heard, gaps, counters })
    }

    /// The set in force, now and as it changes.
    #[must_use]
    pub(crate) fn landmarks(&self) -> watch::Receiver<Arc<LandmarkSet>> {
        self.published.subscribe()
    }

    /// What of the leader's words changed nothing.
    #[must_use]
    pub(crate) fn counters(&self) -> Arc<LandmarkCounters> {
        Arc::clone(&self.counters)
    }

    /// When the leader was last heard.
    #[must_use]
    pub(crate) fn last_heard(&self) -> LastHeard {
        self.last_heard.subscribe()
    }

    /// Follows the leader until shutdown.
    ///
    /// # Errors
    /// When Zenoh refuses a subscription.
    pub(crate) async fn run(mut self, shutdown: Shutdown) -> Result<(), FollowerError> {
        let (heard, mut waiting) = mpsc::channel(WAITING_SAMPLES);
        let _landmarks = self.hear_landmarks(heard.clone()).await?;
        let _manifest = self.hear_manifests(heard).await?;
        let mut retry = interval(RETRY_EVERY);
        retry.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                () = shutdown.requested() => return Ok(()),
                Some(heard) = waiting.recv() => self.hear(heard).await,
                _ = retry.tick() => self.catch_up().await,
            }
        }
    }

    async fn hear_landmarks(
        &self,
        heard: mpsc::Sender<Heard>,
    ) -> Result<zenoh::pubsub::Subscriber<()>, FollowerError> {
        let counters = Arc::clone(&self.counters);
        self.session
            .declare_subscriber(self.leader.landmarks())
            .callback(move |sample| {
                if heard.try_send(Heard::Landmark(sample)).is_err() {
                    counters.deferred();
                }
            })
            .await
            .map_err(FollowerError::zenoh("subscribing to the leader's landmarks"))
    }

    async fn hear_manifests(
        &self,
        heard: mpsc::Sender<Heard>,
    ) -> Result<zenoh_ext::AdvancedSubscriber<()>, FollowerError> {
        let counters = Arc::clone(&self.counters);
        self.session
            .declare_subscriber(self.leader.manifest())
            .callback(move |sample| {
                if heard.try_send(Heard::Manifest(sample)).is_err() {
                    counters.deferred();
                }
            })
            .history(HistoryConfig::default().detect_late_publishers())
            .recovery(RecoveryConfig::default().heartbeat())
            .subscriber_detection()
            .await
            .map_err(FollowerError::zenoh("subscribing to the leader's manifest"))
    }

    async fn hear(&mut self, heard: Heard) {
        if let Heard::Manifest(sample) = &heard {
            let attachment = sample.attachment().map(|bytes| Attachment::from_bytes(&bytes.to_bytes()));
            self.gaps.observe(attachment.and_then(Result::ok).as_ref());
        }
        let missed = self.gaps.missed();
        self.last_heard.send_replace(Some(LeaderHeard { at: Instant::now(), missed }));
        match heard {
            // A retired landmark leaves with the manifest that lacks it.
            Heard::Landmark(sample) if sample.kind() == SampleKind::Delete => {}
            Heard::Landmark(sample) => self.offer(&sample.payload().to_bytes()),
            Heard::Manifest(sample) => self.take_manifest(&sample.payload().to_bytes()).await,
        }
    }

    fn offer(&mut self, payload: &[u8]) {
        match wire::landmark(payload) {
            Err(refused) => {
                self.counters.refused();
                tracing::warn!(%refused, "landmark refused; what was in force stays");
            }
            Ok((landmark, epoch)) => {
                let id = landmark.id.clone();
                match self.accepted.offer(epoch, landmark) {
                    Offer::Accepted => self.publish(),
                    Offer::Known => {}
                    Offer::Older => self.counters.older(),
                    Offer::Conflict => {
                        self.counters.conflict();
                        tracing::warn!(landmark = id, "two contents under one revision; the first one stays");
                    }
                }
            }
        }
    }

    async fn take_manifest(&mut self, payload: &[u8]) {
        match wire::manifest(payload) {
            Err(refused) => {
                self.counters.refused();
                tracing::warn!(%refused, "manifest refused");
            }
            Ok(manifest) => self.compare(manifest).await,
        }
    }

    async fn compare(&mut self, manifest: Manifest) {
        let before = self.accepted.set().version;
        match self.accepted.compare(&manifest) {
            Comparison::Older => self.counters.older(),
            Comparison::Complete => {
                self.wanted = None;
                if before != manifest.version {
                    self.publish();
                }
            }
            Comparison::Differs => {
                self.wanted = Some(manifest);
                self.fetch(manifest).await;
            }
        }
    }

    /// What a lost sample or reply left open.
    async fn catch_up(&mut self) {
        match self.wanted {
            Some(manifest) => self.fetch(manifest).await,
            None if self.last_heard.borrow().is_none() => self.ask_for_manifest().await,
            None => {}
        }
    }

    /// A store answers for a leader that is gone.
    async fn ask_for_manifest(&mut self) {
        for (_, payload) in self.ask(self.leader.manifest()).await {
            self.take_manifest(&payload).await;
        }
    }

    /// Fetches the whole set. Leader and store may both answer, and a store may lag: the first answer that is what
    /// the manifest announces is taken whole, answers are never mixed.
    async fn fetch(&mut self, manifest: Manifest) {
        let mut answers: BTreeMap<String, Vec<(Landmark, u64)>> = BTreeMap::new();
        for (replier, payload) in self.ask(self.leader.landmarks()).await {
            match wire::landmark(&payload) {
                Ok(landmark) => answers.entry(replier).or_default().push(landmark),
                Err(refused) => {
                    self.counters.refused();
                    tracing::warn!(%refused, "fetched landmark refused");
                }
            }
        }
        if manifest.count == 0 {
            answers.insert(String::new(), Vec::new());
        }
        if answers.into_values().any(|landmarks| self.accepted.replace(&manifest, landmarks)) {
            self.wanted = None;
            self.publish();
        } else {
            tracing::debug!("the fetched set is not what the manifest announces; asking again");
        }
    }

    /// Every reply to a query, with who sent it. A lost query has no replies and is asked again later.
    async fn ask(&self, key_expression: String) -> Vec<(String, Vec<u8>)> {
        let asked = self
            .session
            .get(key_expression)
            .congestion_control(CongestionControl::Drop)
            .consolidation(zenoh::query::ConsolidationMode::None)
            .target(zenoh::query::QueryTarget::All)
            .timeout(REPLY_WITHIN)
            .await;
        let replies = match asked {
            Ok(replies) => replies,
            Err(error) => {
                tracing::debug!(%error, "query not sent; asking again");
                return Vec::new();
            }
        };
        let mut answers = Vec::new();
        while let Ok(reply) = replies.recv_async().await {
            let replier = reply.replier_id().map_or_else(String::new, |id| format!("{id:?}"));
            if let Ok(sample) = reply.result() {
                answers.push((replier, sample.payload().to_bytes().into_owned()));
            }
        }
        answers
    }

    fn publish(&self) {
        let set = self.accepted.set();
        tracing::info!(
            epoch = set.version.epoch,
            version = set.version.version,
            landmarks = set.landmarks.len(),
            "landmark set"
        );
        self.published.send_replace(Arc::new(set));
        if let Err(error) = self.file.store(&self.accepted) {
            tracing::error!(%error, "the accepted landmarks are not on disk; a restart without leader would lack them");
        }
    }
}
