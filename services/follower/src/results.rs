//! What becomes of a camera's results: journal, Zenoh, and whoever looks.

use std::sync::Arc;

use bytes::Bytes;
use ingest::camera_thread::Registered;
use prost::Message;
use recording::{Journal, Latch};
use tokio::sync::mpsc;
use waymark_proto::keys::{CameraStream, Id, VehicleKeys};
use waymark_proto::{annotations, convert, foxglove, v1};
use zenoh::Session;
use zenoh::qos::{Priority, Reliability};

use crate::error::FollowerError;
use crate::outbound::Outbound;
use crate::station::Station;
use crate::tap::Entry;
use crate::topics::CameraTopics;
use crate::web::Face;

/// The way out of one camera's results.
pub(crate) struct Results {
    topics: CameraTopics,
    journal: Arc<Journal>,
    registrations: Outbound,
    annotations: Outbound,
}

impl Results {
    pub(crate) async fn declare(
        session: &Session,
        keys: &VehicleKeys,
        camera: &Id,
        topics: CameraTopics,
        journal: Arc<Journal>,
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
        Ok(Self { topics, journal, registrations: registrations.await?, annotations: annotations.await? })
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
            face.show(&station, registered);
        }
    }

    async fn publish(&self, camera: &str, registered: &Registered) {
        let outcome = &registered.outcome;
        let captured_at_ns = outcome.captured_at.nanos;
        let registration = convert::registration_to_wire(camera, outcome).encode_to_vec();
        let annotations = annotations::annotations(outcome).encode_to_vec();
        let entry = |channel, data: &[u8]| Entry {
            channel,
            captured_at_ns,
            sequence: outcome.sequence,
            data: Bytes::copy_from_slice(data),
            latch: Latch::None,
        };
        // Together, so that no file ends between a result and its drawing.
        let _counted_by_the_journal = self.journal.offer_all(vec![
            entry(&self.topics.registration, &registration).stamped(),
            entry(&self.topics.annotations, &annotations).stamped(),
        ]);
        self.registrations.put(registration, captured_at_ns).await;
        self.annotations.put(annotations, captured_at_ns).await;
    }
}
