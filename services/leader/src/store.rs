//! A router's memory: the landmark sets of every leader, answered for when the leader is gone.
//!
//! A store hears manifests, fetches each set that it does not have, and keeps it on disk. It answers
//! `*/landmark/**` and `*/manifest`; whoever asks gets its answer beside the leader's own and takes the newer one.

mod shelf;

use std::collections::HashMap;
use std::path::Path;

use runtime::reply::{Answer, reply};
use runtime::{Shutdown, StateDir};
use tokio::sync::{mpsc, watch};
use tokio::task::{self, JoinSet};
use vision::LandmarkSet;
use waymark_proto::convert::{Manifest, manifest_from_wire};
use waymark_proto::keys::{Key, Resource, VehicleKeys};
use waymark_proto::payload::WireMessage;
use waymark_proto::v1;
use zenoh::Session;
use zenoh::bytes::Encoding;
use zenoh::pubsub::Subscriber;
use zenoh::query::{Query, Queryable};
use zenoh::sample::{Locality, Sample};

use crate::client::{ClientError, LandmarkClient};
use crate::error::LeaderError;
use crate::publication::key_expr;
use shelf::Filed;
pub use shelf::Shelf;

/// Sets that are fetched at a time: one leader that does not answer holds up none of the others.
const FETCHES_AT_A_TIME: usize = 8;
/// Manifests that may wait; one that finds no room comes again within the second.
const WAITING_MANIFESTS: usize = 256;

/// A store that answers.
pub struct Store {
    session: Session,
    state: StateDir,
    shelf: watch::Sender<Shelf>,
    heard: mpsc::Receiver<Sample>,
    _manifests: Subscriber<()>,
    _answers: [Queryable<()>; 2],
}

impl Store {
    /// A store that answers with what `directory` holds; it learns once [`Self::run`] runs.
    ///
    /// # Errors
    /// When the directory cannot be used, or Zenoh refuses a declaration.
    pub async fn open(session: &Session, directory: &Path) -> Result<Self, LeaderError> {
        let state = StateDir::open(directory)?;
        let shelf = watch::Sender::new(Shelf::read(&state)?);
        let answers = [
            declare(session, VehicleKeys::every_landmark(), &shelf, answer_landmarks).await?,
            declare(session, VehicleKeys::every_manifest(), &shelf, answer_manifests).await?,
        ];
        let (hears, heard) = mpsc::channel(WAITING_MANIFESTS);
        let manifests = session
            .declare_subscriber(VehicleKeys::every_manifest())
            .callback(move |sample| drop(hears.try_send(sample)))
            .await
            .map_err(LeaderError::zenoh("manifests cannot be heard"))?;
        Ok(Self { session: session.clone(), state, shelf, heard, _manifests: manifests, _answers: answers })
    }

    /// Vehicles whose sets are kept, as they change.
    #[must_use]
    pub fn vehicles(&self) -> watch::Receiver<Shelf> {
        self.shelf.subscribe()
    }

    /// Learns and answers until shutdown.
    pub async fn run(mut self, shutdown: Shutdown) {
        let mut fetches = Fetches::default();
        loop {
            tokio::select! {
                () = shutdown.requested() => return,
                Some(sample) = self.heard.recv() => self.hear(&sample, &mut fetches),
                ended = fetches.ended() => if let Some((vehicle, set)) = ended {
                    self.file(&vehicle, set);
                },
            }
        }
    }

    fn hear(&self, sample: &Sample, fetches: &mut Fetches) {
        let Some((vehicle, manifest)) = manifest_of_sample(sample) else { return };
        if self.shelf.borrow().is_current(&vehicle, &manifest) || !fetches.have_room_for(&vehicle) {
            return;
        }
        let client = LandmarkClient::new(self.session.clone(), vehicle.clone()).without_patience();
        fetches.begin(vehicle, async move { client.fetch(&manifest).await });
    }

    fn file(&self, vehicle: &VehicleKeys, set: LandmarkSet) {
        let name = format!("{}/{}", vehicle.fleet(), vehicle.vehicle());
        let (epoch, version, landmarks) = (set.version.epoch, set.version.version, set.landmarks.len());
        if let Err(error) = shelf::write(&self.state, vehicle, &set) {
            tracing::error!(%error, vehicle = name, "a landmark set is not on disk");
        }
        let mut filed = Ok(Filed::Kept);
        self.shelf.send_modify(|shelf| filed = shelf.put(vehicle, set));
        match filed {
            Ok(Filed::Kept) => tracing::info!(vehicle = name, epoch, version, landmarks, "landmark set kept"),
            Ok(Filed::NoRoom) => {
                tracing::warn!(vehicle = name, "no room for the landmarks of another vehicle")
            }
            Err(error) => tracing::warn!(%error, vehicle = name, "landmark set not kept"),
        }
    }
}

/// Sets on their way, at most one of each vehicle.
#[derive(Default)]
struct Fetches {
    running: JoinSet<Result<LandmarkSet, ClientError>>,
    vehicles: HashMap<task::Id, VehicleKeys>,
}

impl Fetches {
    /// A vehicle for which there is no room says its manifest again within the second.
    fn have_room_for(&self, vehicle: &VehicleKeys) -> bool {
        self.running.len() < FETCHES_AT_A_TIME && self.vehicles.values().all(|fetched| fetched != vehicle)
    }

    fn begin<F>(&mut self, vehicle: VehicleKeys, fetch: F)
    where
        F: Future<Output = Result<LandmarkSet, ClientError>> + Send + 'static,
    {
        self.vehicles.insert(self.running.spawn(fetch).id(), vehicle);
    }

    /// Waits until one has ended, and returns what it brought; pending while none is on its way.
    async fn ended(&mut self) -> Option<(VehicleKeys, LandmarkSet)> {
        let Some(ended) = self.running.join_next_with_id().await else { return std::future::pending().await };
        let (id, fetched) = match ended {
            Ok((id, fetched)) => (id, fetched.map_err(|error| error.to_string())),
            Err(error) => (error.id(), Err(error.to_string())),
        };
        let vehicle = self.vehicles.remove(&id)?;
        let not_fetched =
            |error| tracing::debug!(error, "a set was not fetched; its next manifest comes soon");
        Some((vehicle, fetched.map_err(not_fetched).ok()?))
    }
}

/// Answers queries of others from the newest state of the shelf. Those of this session are its own fetches.
async fn declare(
    session: &Session,
    key_expression: String,
    shelf: &watch::Sender<Shelf>,
    answer: fn(&Query, &Shelf),
) -> Result<Queryable<()>, LeaderError> {
    let shelf = shelf.subscribe();
    session
        .declare_queryable(key_expression)
        .allowed_origin(Locality::Remote)
        .callback(move |query| answer(&query, &shelf.borrow()))
        .await
        .map_err(LeaderError::zenoh("landmark sets cannot be offered"))
}

fn answer_landmarks(query: &Query, shelf: &Shelf) {
    let encoding = Encoding::from(v1::Landmark::encoding());
    let landmarks = shelf.sets().flat_map(|(_, publication)| publication.landmarks());
    for sendable in landmarks.filter(|sendable| query.key_expr().intersects(&sendable.key)) {
        let (key, payload) = (sendable.key.clone(), sendable.payload.clone());
        reply(query, Answer { key, payload, encoding: encoding.clone(), attachment: None });
    }
}

fn answer_manifests(query: &Query, shelf: &Shelf) {
    let encoding = Encoding::from(v1::LandmarkManifest::encoding());
    for (vehicle, publication) in shelf.sets() {
        let key = key_expr(&vehicle.key(Resource::Manifest));
        if query.key_expr().intersects(&key) {
            let payload = publication.manifest.clone();
            reply(query, Answer { key, payload, encoding: encoding.clone(), attachment: None });
        }
    }
}

fn manifest_of_sample(sample: &Sample) -> Option<(VehicleKeys, Manifest)> {
    let key: Key = sample.key_expr().as_str().parse().ok()?;
    let wire = v1::LandmarkManifest::from_payload(&sample.payload().to_bytes());
    let manifest = wire
        .map_err(|error| error.to_string())
        .and_then(|wire| manifest_from_wire(&wire).map_err(|error| error.to_string()));
    match manifest {
        Ok(manifest) => Some((VehicleKeys::of_key(&key), manifest)),
        Err(refused) => {
            tracing::warn!(refused, key = %sample.key_expr(), "manifest refused");
            None
        }
    }
}
