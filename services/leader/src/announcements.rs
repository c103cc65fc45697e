//! What a leader says unasked: landmarks as they change, the manifest, its status.

use std::sync::Arc;
use std::time::{Duration, Instant};

use runtime::identity::unix_time_ns;
use waymark_proto::attachment::Stamper;
use waymark_proto::keys::VehicleKeys;
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;
use zenoh::Session;
use zenoh::bytes::{Encoding, ZBytes};
use zenoh::key_expr::KeyExpr;
use zenoh::qos::{CongestionControl, Priority, Reliability};
use zenoh_ext::{
    AdvancedPublisher, AdvancedPublisherBuilderExt, CacheConfig, MissDetectionConfig, RepliesConfig,
};

use crate::book::Change;
use crate::error::LeaderError;
use crate::publication::{Publication, landmark_key};
use crate::put_times::PutTimes;

const HEARTBEAT: Duration = Duration::from_secs(1);

/// A leader's voice. Nothing here waits for a listener: what has no room is dropped, and the next manifest shows it.
pub(crate) struct Announcements {
    session: Session,
    keys: VehicleKeys,
    manifest: AdvancedPublisher<'static>,
    landmark_stamper: Stamper,
    manifest_stamper: Stamper,
    status_stamper: Stamper,
    times: Arc<PutTimes>,
}

impl Announcements {
    pub(crate) async fn declare(
        session: &Session,
        keys: &VehicleKeys,
        times: Arc<PutTimes>,
    ) -> Result<Self, LeaderError> {
        let replies = RepliesConfig::default()
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::InteractiveHigh);
        let manifest = session
            .declare_publisher(keys.manifest())
            .encoding(Encoding::from(v1::LandmarkManifest::encoding()))
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::InteractiveHigh)
            .reliability(Reliability::Reliable)
            .cache(CacheConfig::default().max_samples(1).replies_config(replies))
            .sample_miss_detection(MissDetectionConfig::default().heartbeat(HEARTBEAT))
            .publisher_detection()
            .await
            .map_err(LeaderError::zenoh("the manifest's publisher cannot be declared"))?;
        let stamper = || Stamper::new(uuid::Uuid::new_v4().into_bytes());
        Ok(Self {
            session: session.clone(),
            keys: keys.clone(),
            manifest,
            landmark_stamper: stamper(),
            manifest_stamper: stamper(),
            status_stamper: stamper(),
            times,
        })
    }

    /// Tells of everything in the set.
    pub(crate) async fn say_all(&self, publication: &Publication) {
        for sendable in publication.landmarks() {
            self.put_landmark(&sendable.key, sendable.payload.clone()).await;
        }
        self.say_manifest(publication).await;
    }

    /// Tells of a change: the landmarks first, so that whoever heard them finds the manifest fulfilled.
    pub(crate) async fn say_change(&self, change: &Change, publication: &Publication) {
        for landmark in &change.published {
            if let Some(sendable) = publication.landmark(&landmark.id) {
                self.put_landmark(&sendable.key, sendable.payload.clone()).await;
            }
        }
        for id in &change.retired {
            match landmark_key(&self.keys, id) {
                Ok(key) => self.delete_landmark(&key).await,
                Err(error) => tracing::error!(%error, "a retired landmark has no key"),
            }
        }
        self.say_manifest(publication).await;
    }

    /// Tells what the set is; said every second, so that a lost landmark is noticed within one.
    pub(crate) async fn say_manifest(&self, publication: &Publication) {
        let attachment = self.manifest_stamper.stamp(unix_time_ns()).to_bytes();
        let put = self.manifest.put(publication.manifest.clone()).attachment(attachment.as_slice());
        self.said("manifest", put).await;
    }

    /// Tells how this vehicle is.
    pub(crate) async fn say_status(&self, status: &v1::VehicleStatus) {
        use prost::Message as _;
        let put = self
            .session
            .put(self.keys.status(), status.encode_to_vec())
            .encoding(Encoding::from(v1::VehicleStatus::encoding()))
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::Background)
            .reliability(Reliability::BestEffort)
            .attachment(self.status_stamper.stamp(status.sent_at_ns).to_bytes().as_slice());
        self.said("status", put).await;
    }

    async fn put_landmark(&self, key: &KeyExpr<'static>, payload: ZBytes) {
        let put = self
            .session
            .put(key, payload)
            .encoding(Encoding::from(v1::Landmark::encoding()))
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::InteractiveHigh)
            .reliability(Reliability::Reliable)
            .attachment(self.landmark_stamper.stamp(unix_time_ns()).to_bytes().as_slice());
        self.said("landmark", put).await;
    }

    async fn delete_landmark(&self, key: &KeyExpr<'static>) {
        let delete = self
            .session
            .delete(key)
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::InteractiveHigh)
            .reliability(Reliability::Reliable)
            .attachment(self.landmark_stamper.stamp(unix_time_ns()).to_bytes().as_slice());
        self.said("retirement", delete).await;
    }

    /// Says it, and takes note of how long that took.
    async fn said(&self, what: &'static str, put: impl IntoFuture<Output = zenoh::Result<()>>) {
        let began = Instant::now();
        let said = put.await;
        self.times.took(began.elapsed());
        if let Err(error) = said {
            // A closed session says nothing more; whoever closed it knows.
            tracing::debug!(%error, what, "not said");
        }
    }
}
