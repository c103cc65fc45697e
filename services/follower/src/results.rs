//! What becomes of a camera's results: journal, Zenoh, and whoever looks.

use std::sync::Arc;

use bytes::Bytes;
use ingest::camera_thread::Registered;
use prost::Message;
use recording::{Journal, Latch, LatchKey};
use tokio::sync::{mpsc, watch};
use vision::follow::FollowOptions;
use vision::{Pinhole, Place, places};
use waymark_proto::keys::{CameraStream, Id, VehicleKeys};
use waymark_proto::{annotations, convert, foxglove, v1};
use zenoh::Session;
use zenoh::qos::{Priority, Reliability};

use crate::burned_in;
use crate::error::FollowerError;
use crate::outbound::Outbound;
use crate::station::Station;
use crate::tap::Entry;
use crate::topics::CameraTopics;
use crate::web::Face;

/// The camera, once its calibration is known.
#[derive(Clone, Debug)]
pub(crate) struct Calibrated(pub(crate) watch::Receiver<Option<Pinhole>>);

impl Calibrated {
    /// Where the landmarks of a frame are.
    pub(crate) fn places(&self, registered: &Registered) -> Vec<Place> {
        places(&registered.outcome, &registered.landmarks, self.0.borrow().as_ref())
    }
}

/// The way out of one camera's results.
pub(crate) struct Results {
    topics: CameraTopics,
    options: FollowOptions,
    journal: Arc<Journal>,
    calibrated: Calibrated,
    burned_in: Option<burned_in::Slot>,
    registrations: Outbound,
    annotations: Outbound,
}

impl Results {
    pub(crate) async fn declare(
        session: &Session,
        keys: &VehicleKeys,
        camera: &Id,
        topics: CameraTopics,
        options: FollowOptions,
        journal: Arc<Journal>,
        calibrated: Calibrated,
    ) -> Result<Self, FollowerError> {
        let registrations = Outbound::declare::<v1::Registration>(
            session,
            keys.camera(camera, CameraStream::Registration),
            Reliability::Reliable,
            Priority::Data,
        );
        let annotations = Outbound::declare::<foxglove::ImageAnnotations>(
            session,
            keys.camera(camera, CameraStream::Annotations),
            Reliability::BestEffort,
            Priority::Data,
        );
        Ok(Self {
            topics,
            options,
            journal,
            calibrated,
            burned_in: None,
            registrations: registrations.await?,
            annotations: annotations.await?,
        })
    }

    /// The same, and every result is put into `slot` to be drawn.
    pub(crate) fn drawn_into(self, slot: Option<burned_in::Slot>) -> Self {
        Self { burned_in: slot, ..self }
    }

    /// Hands on every result until the camera's thread has ended and all of them are out.
    pub(crate) async fn run(
        self,
        mut results: mpsc::Receiver<Arc<Registered>>,
        station: Arc<Station>,
        face: Arc<Face>,
    ) {
        while let Some(registered) = results.recv().await {
            self.publish(station.id(), &registered).await;
            if let Some(slot) = &self.burned_in {
                slot.put(Arc::clone(&registered));
            }
            face.show(&station, registered);
        }
    }

    async fn publish(&self, camera: &str, registered: &Registered) {
        let outcome = &registered.outcome;
        let captured_at_ns = outcome.captured_at.nanos;
        let registration =
            convert::registration_to_wire(camera, outcome, &self.calibrated.places(registered));
        let registration = registration.encode_to_vec();
        let annotations = annotations::annotations(outcome).encode_to_vec();
        let state = convert::follow_state_to_wire(camera, &self.options, &registered.state).encode_to_vec();
        let snapshot = Latch::Snapshot {
            key: LatchKey(self.topics.follow_state.topic.clone()),
            of: self.topics.compressed_image.topic.as_str().into(),
        };
        let entry = |channel, data: &[u8], latch| Entry {
            channel,
            captured_at_ns,
            sequence: outcome.sequence,
            data: Bytes::copy_from_slice(data),
            latch,
        };
        // Together, so that no file ends between a result, its drawing and what it leaves behind.
        let _counted_by_the_journal = self.journal.offer_all(vec![
            entry(&self.topics.registration, &registration, Latch::None).stamped(),
            entry(&self.topics.annotations, &annotations, Latch::None).stamped(),
            entry(&self.topics.follow_state, &state, snapshot).stamped(),
        ]);
        self.registrations.put(registration, captured_at_ns).await;
        self.annotations.put(annotations, captured_at_ns).await;
    }
}
