//! What the command line says to a running leader: list, publish, retire, pull, push.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use prost::Message;
use vision::{Landmark, LandmarkSet};
use waymark_proto::convert::{
    InvalidField, Manifest, landmark_from_wire, landmark_to_wire, manifest_from_wire,
};
use waymark_proto::keys::VehicleKeys;
use waymark_proto::payload::{RefusedPayload, WireMessage};
use waymark_proto::v1;
use zenoh::Session;
use zenoh::bytes::Encoding;
use zenoh::qos::CongestionControl;
use zenoh::query::{ConsolidationMode, QueryTarget, Reply};

use crate::book::{Edit, Others};

const ANSWER_TIMEOUT: Duration = Duration::from_secs(3);
/// How long nobody may be there before that is the answer: who has just connected is known to all a moment later.
const PATIENCE: Duration = Duration::from_secs(3);
/// Pause before asking again when nobody was there.
const ASK_AGAIN_AFTER: Duration = Duration::from_millis(100);
/// Times a set is fetched before what is there is called incomplete: queries and replies may be lost.
const FETCH_ROUNDS: usize = 5;

/// Speaks to the leader of one vehicle, or to a router's store in its place where only reading is asked for.
#[derive(Clone, Debug)]
pub struct LandmarkClient {
    session: Session,
    keys: VehicleKeys,
    patience: Duration,
}

/// Why a leader was not heard or not obeyed.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// Nobody answered.
    #[error(
        "no answer from the leader of vehicle {vehicle:?}; is it running, and connected to the same router?"
    )]
    NoAnswer {
        /// The vehicle.
        vehicle: String,
    },
    /// The leader's manifest and the landmarks that arrived do not agree.
    #[error("only {received} of {announced} landmarks of vehicle {vehicle:?} arrived; try again")]
    Incomplete {
        /// The vehicle.
        vehicle: String,
        /// Landmarks that arrived.
        received: usize,
        /// Landmarks in the set.
        announced: u32,
    },
    /// The leader refused the edit.
    #[error("the leader refused: {reason}")]
    Refused {
        /// The leader's words.
        reason: String,
    },
    /// An answer cannot be decoded.
    #[error("the answer cannot be read: {0}")]
    Payload(#[from] RefusedPayload),
    /// An answer says something impossible.
    #[error("the answer cannot be believed: {0}")]
    Field(#[from] InvalidField),
    /// Zenoh refused the query.
    #[error("the leader cannot be asked: {0}")]
    Zenoh(zenoh::Error),
}

impl LandmarkClient {
    /// A client of the leader of the vehicle that `keys` belong to.
    #[must_use]
    pub fn new(session: Session, keys: VehicleKeys) -> Self {
        Self { session, keys, patience: PATIENCE }
    }

    /// The same client, that takes nobody being there for an answer at once.
    #[must_use]
    pub fn without_patience(self) -> Self {
        Self { patience: Duration::ZERO, ..self }
    }

    /// The whole set, from whoever has the newest one.
    ///
    /// # Errors
    /// When nobody answers, or the answers do not make a set.
    pub async fn list(&self) -> Result<LandmarkSet, ClientError> {
        let mut incomplete = self.no_answer();
        for _ in 0..FETCH_ROUNDS {
            let Some(manifest) = self.manifest().await? else { return Err(self.no_answer()) };
            match self.fetch(&manifest).await {
                Err(error @ ClientError::Incomplete { .. }) => incomplete = error,
                fetched => return fetched,
            }
        }
        Err(incomplete)
    }

    /// The set that `manifest` describes, asked for once.
    ///
    /// # Errors
    /// When nobody's answer is that set.
    pub async fn fetch(&self, manifest: &Manifest) -> Result<LandmarkSet, ClientError> {
        let answers = if manifest.count == 0 { BTreeMap::new() } else { self.landmarks().await? };
        let received = answers.values().map(Vec::len).max().unwrap_or(0);
        let candidates = answers.into_values().chain([Vec::new()]);
        candidates.map(|landmarks| set_of(manifest, landmarks)).find_map(|set| set).ok_or_else(|| {
            ClientError::Incomplete { vehicle: self.vehicle(), received, announced: manifest.count }
        })
    }

    /// Asks the leader for an edit and returns what the set is then.
    ///
    /// # Errors
    /// When the leader does not answer, or refuses. Without an answer the edit may have been made.
    pub async fn edit(&self, edit: &Edit) -> Result<Manifest, ClientError> {
        let message = v1::LandmarkEdit {
            publish: edit.publish.iter().map(draft_to_wire).collect(),
            retire: edit.retire.clone(),
            retire_others: edit.others == Others::Retire,
        };
        let replies = self.ask(self.keys.landmark_edit(), Some(message.encode_to_vec())).await?;
        let reply = replies.into_iter().find_map(|reply| reply.into_result().ok());
        let payload = reply.ok_or_else(|| self.no_answer())?.payload().to_bytes().into_owned();
        let answer = v1::LandmarkEditReply::from_payload(&payload)?;
        if !answer.refusal.is_empty() {
            return Err(ClientError::Refused { reason: answer.refusal });
        }
        Ok(manifest_from_wire(&answer.manifest.unwrap_or_default())?)
    }

    /// The newest manifest among the answers.
    async fn manifest(&self) -> Result<Option<Manifest>, ClientError> {
        let mut newest: Option<Manifest> = None;
        for reply in self.ask(self.keys.manifest(), None).await? {
            let Ok(sample) = reply.into_result() else { continue };
            let wire = v1::LandmarkManifest::from_payload(&sample.payload().to_bytes())?;
            let manifest = manifest_from_wire(&wire)?;
            if newest.is_none_or(|newest| newest.version < manifest.version) {
                newest = Some(manifest);
            }
        }
        Ok(newest)
    }

    /// Landmarks by who answered: leader and store may both, and answers of two are never mixed.
    async fn landmarks(&self) -> Result<BTreeMap<String, Vec<Landmark>>, ClientError> {
        let mut answers: BTreeMap<String, Vec<Landmark>> = BTreeMap::new();
        for reply in self.ask(self.keys.landmarks(), None).await? {
            let replier = reply.replier_id().map_or_else(String::new, |id| format!("{id:?}"));
            let Ok(sample) = reply.into_result() else { continue };
            let wire = v1::Landmark::from_payload(&sample.payload().to_bytes())?;
            answers.entry(replier).or_default().push(landmark_from_wire(&wire)?.0);
        }
        Ok(answers)
    }

    /// Every reply to a query. A query that nobody was there to hear is put again: nothing was done for it.
    async fn ask(&self, key_expression: String, payload: Option<Vec<u8>>) -> Result<Vec<Reply>, ClientError> {
        let began = Instant::now();
        loop {
            let replies = self.ask_once(&key_expression, payload.clone()).await?;
            if !replies.is_empty() || began.elapsed() >= self.patience {
                return Ok(replies);
            }
            tokio::time::sleep(ASK_AGAIN_AFTER).await;
        }
    }

    async fn ask_once(
        &self,
        key_expression: &str,
        payload: Option<Vec<u8>>,
    ) -> Result<Vec<Reply>, ClientError> {
        let mut query = self
            .session
            .get(key_expression)
            .target(QueryTarget::All)
            .consolidation(ConsolidationMode::None)
            .congestion_control(CongestionControl::Drop)
            .timeout(ANSWER_TIMEOUT);
        if let Some(payload) = payload {
            query = query.payload(payload).encoding(Encoding::from(v1::LandmarkEdit::encoding()));
        }
        let replies = query.await.map_err(ClientError::Zenoh)?;
        let mut answers = Vec::new();
        while let Ok(reply) = replies.recv_async().await {
            answers.push(reply);
        }
        Ok(answers)
    }

    fn vehicle(&self) -> String {
        self.keys.vehicle().to_string()
    }

    fn no_answer(&self) -> ClientError {
        ClientError::NoAnswer { vehicle: self.vehicle() }
    }
}

/// The set that `manifest` describes, when `landmarks` are it.
fn set_of(manifest: &Manifest, mut landmarks: Vec<Landmark>) -> Option<LandmarkSet> {
    landmarks.sort_by(|one, other| one.id.cmp(&other.id));
    let landmarks = landmarks.into_iter().map(Arc::new).collect();
    let set = LandmarkSet { version: manifest.version, landmarks };
    manifest.describes(&set).then_some(set)
}

/// Revision and epoch are the leader's to give.
fn draft_to_wire(landmark: &Landmark) -> v1::Landmark {
    v1::Landmark { revision: 0, ..landmark_to_wire(landmark, 0) }
}
