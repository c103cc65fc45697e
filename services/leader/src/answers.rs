//! What a leader says when asked: its landmarks, its manifest, and whether it makes a change.

use prost::Message;
use runtime::reply::{Answer, reply};
use tokio::sync::{mpsc, watch};
use waymark_proto::convert::{InvalidField, landmark_draft_from_wire};
use waymark_proto::keys::{Resource, VehicleKeys};
use waymark_proto::payload::{RefusedPayload, WireMessage};
use waymark_proto::v1;
use zenoh::Session;
use zenoh::bytes::{Encoding, ZBytes};
use zenoh::query::{Query, Queryable};

use crate::book::{Edit, Others};
use crate::error::LeaderError;
use crate::publication::{Publication, key_expr};

/// The declarations behind the answers; dropped, a leader is silent.
pub(crate) struct Answers {
    _landmarks: Queryable<()>,
    _manifest: Queryable<()>,
    _edits: Queryable<()>,
}

impl Answers {
    /// Answers from the newest publication; edits go to `edits`, and are refused when it is full.
    pub(crate) async fn declare(
        session: &Session,
        keys: &VehicleKeys,
        publications: watch::Receiver<Publication>,
        edits: mpsc::Sender<Query>,
    ) -> Result<Self, LeaderError> {
        let landmarks = {
            let publications = publications.clone();
            let answer = move |query: Query| answer_landmarks(&query, &publications.borrow());
            session.declare_queryable(keys.landmarks()).complete(true).callback(answer).await
        };
        let manifest = {
            let key = key_expr(&keys.key(Resource::Manifest));
            let encoding = Encoding::from(v1::LandmarkManifest::encoding());
            let answer = move |query: Query| {
                let payload = publications.borrow().manifest.clone();
                reply(
                    &query,
                    Answer { key: key.clone(), payload, encoding: encoding.clone(), attachment: None },
                );
            };
            session.declare_queryable(keys.manifest()).complete(true).callback(answer).await
        };
        let edits = session
            .declare_queryable(keys.landmark_edit())
            .complete(true)
            .callback(move |query| {
                if edits.try_send(query).is_err() {
                    tracing::warn!("an edit was not taken: too many are waiting");
                }
            })
            .await;
        Ok(Self {
            _landmarks: landmarks.map_err(LeaderError::zenoh("landmarks cannot be offered"))?,
            _manifest: manifest.map_err(LeaderError::zenoh("the manifest cannot be offered"))?,
            _edits: edits.map_err(LeaderError::zenoh("edits cannot be accepted"))?,
        })
    }
}

fn answer_landmarks(query: &Query, publication: &Publication) {
    let encoding = Encoding::from(v1::Landmark::encoding());
    for sendable in publication.landmarks().filter(|sendable| query.key_expr().intersects(&sendable.key)) {
        let (key, payload) = (sendable.key.clone(), sendable.payload.clone());
        reply(query, Answer { key, payload, encoding: encoding.clone(), attachment: None });
    }
}

/// Tells whoever asked for an edit what came of it: the set in force, and why it is unchanged where it is.
pub(crate) fn answer_edit(
    query: &Query,
    keys: &VehicleKeys,
    manifest: v1::LandmarkManifest,
    refusal: String,
) {
    let message = v1::LandmarkEditReply { manifest: Some(manifest), refusal };
    reply(
        query,
        Answer {
            key: key_expr(&keys.key(Resource::LandmarkEdit)),
            payload: ZBytes::from(message.encode_to_vec()),
            encoding: Encoding::from(v1::LandmarkEditReply::encoding()),
            attachment: None,
        },
    );
}

/// Why a request is no edit.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NoEdit {
    #[error("a query for an edit carries a waymark.v1.LandmarkEdit; this one is empty")]
    Empty,
    #[error(transparent)]
    Payload(#[from] RefusedPayload),
    #[error("publish[{at}].{invalid}")]
    Landmark { at: usize, invalid: InvalidField },
}

/// The edit that a query asks for.
pub(crate) fn edit_of(query: &Query) -> Result<Edit, NoEdit> {
    let payload = query.payload().ok_or(NoEdit::Empty)?;
    let wire = v1::LandmarkEdit::from_payload(&payload.to_bytes())?;
    let mut publish = Vec::new();
    for (at, landmark) in wire.publish.iter().enumerate() {
        publish.push(landmark_draft_from_wire(landmark).map_err(|invalid| NoEdit::Landmark { at, invalid })?);
    }
    let others = if wire.retire_others { Others::Retire } else { Others::Keep };
    Ok(Edit { publish, retire: wire.retire, others })
}
