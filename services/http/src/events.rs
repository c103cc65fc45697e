//! Server-sent events (WHATWG HTML section 9.2) with one id counter for the process and a bounded memory.

use crate::counters::Refusal;
use crate::problem::Problem;
use axum::body::{Body, Bytes};
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, HeaderName, HeaderValue};
use axum::response::Response;
use serde::Serialize;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, broadcast};
use tokio::time::{Interval, MissedTickBehavior};

/// Readers served at once.
const MAX_READERS: usize = 64;

/// A comment is sent this often, so that both ends notice a dead connection.
const HEARTBEAT: Duration = Duration::from_secs(5);

const LAST_EVENT_ID: HeaderName = HeaderName::from_static("last-event-id");

/// Where events are published and read; one for the whole process, so that ids name an event among all cameras.
#[derive(Debug)]
pub struct Events {
    memory: Mutex<Memory>,
    live: broadcast::Sender<Arc<Event>>,
    readers: Arc<Semaphore>,
}

#[derive(Debug)]
struct Memory {
    last_id: u64,
    recent: VecDeque<Arc<Event>>,
    capacity: usize,
}

#[derive(Debug)]
struct Event {
    id: u64,
    wire: Bytes,
}

impl Events {
    /// Keeps the newest `capacity` events for readers that come back with `Last-Event-ID`.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        let capacity = capacity.max(1);
        let memory = Memory { last_id: 0, recent: VecDeque::with_capacity(capacity), capacity };
        let (live, _) = broadcast::channel(capacity);
        Self { memory: Mutex::new(memory), live, readers: Arc::new(Semaphore::new(MAX_READERS)) }
    }

    /// Publishes one event of a kind; never waits. Gives its id.
    ///
    /// # Errors
    /// When `data` has no JSON form.
    pub fn publish(&self, kind: &str, data: &impl Serialize) -> Result<u64, serde_json::Error> {
        let json = serde_json::to_string(data)?;
        let mut memory = self.memory.lock().unwrap_or_else(PoisonError::into_inner);
        memory.last_id += 1;
        let id = memory.last_id;
        let wire = Bytes::from(format!("id: {id}\nevent: {kind}\ndata: {json}\n\n"));
        let event = Arc::new(Event { id, wire });
        if memory.recent.len() == memory.capacity {
            memory.recent.pop_front();
        }
        memory.recent.push_back(Arc::clone(&event));
        // Sent under the lock: a reader that subscribes sees each event once. Without readers it goes nowhere.
        let _ = self.live.send(event);
        Ok(id)
    }

    /// The stream of events, from behind `Last-Event-ID` when the request names one.
    ///
    /// # Errors
    /// 503 when there are too many readers.
    pub fn respond(&self, request: &HeaderMap) -> Result<Response, Problem> {
        let permit = Arc::clone(&self.readers).try_acquire_owned().map_err(|_| {
            Problem::unavailable(
                format!("{MAX_READERS} readers follow events already"),
                Duration::from_secs(5),
            )
            .because(Refusal::Readers)
        })?;
        let last_id = request
            .get(LAST_EVENT_ID)
            .and_then(|value| value.to_str().ok())
            .and_then(|text| text.trim().parse::<u64>().ok());
        let reader = self.reader(last_id, permit);
        let chunks = futures_util::stream::unfold(reader, |mut reader| async move {
            let chunk = reader.next().await?;
            Some((Ok::<_, Infallible>(chunk), reader))
        });
        let mut response = Response::new(Body::from_stream(chunks));
        response.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static("text/event-stream"));
        Ok(response)
    }

    fn reader(&self, last_id: Option<u64>, permit: OwnedSemaphorePermit) -> Reader {
        let memory = self.memory.lock().unwrap_or_else(PoisonError::into_inner);
        let mut backlog = VecDeque::from([Bytes::from_static(b"retry: 2000\n\n")]);
        if let Some(last_id) = last_id {
            backlog.extend(memory.since(last_id));
        }
        let mut heartbeat = tokio::time::interval(HEARTBEAT);
        heartbeat.set_missed_tick_behavior(MissedTickBehavior::Delay);
        heartbeat.reset();
        Reader { backlog, live: self.live.subscribe(), heartbeat, _permit: permit }
    }
}

impl Memory {
    /// What came after `last_id`, preceded by a word on how many are no longer remembered.
    fn since(&self, last_id: u64) -> Vec<Bytes> {
        // An id we have not given yet is another process's: all we remember is new to that reader.
        let last_id = if last_id > self.last_id { 0 } else { last_id };
        let oldest = self.recent.front().map_or(self.last_id + 1, |event| event.id);
        let forgotten = oldest.saturating_sub(last_id + 1);
        let news = self.recent.iter().filter(|event| event.id > last_id).map(|event| event.wire.clone());
        (forgotten > 0).then(|| lost(forgotten)).into_iter().chain(news).collect()
    }
}

struct Reader {
    backlog: VecDeque<Bytes>,
    live: broadcast::Receiver<Arc<Event>>,
    heartbeat: Interval,
    _permit: OwnedSemaphorePermit,
}

impl Reader {
    async fn next(&mut self) -> Option<Bytes> {
        if let Some(chunk) = self.backlog.pop_front() {
            return Some(chunk);
        }
        tokio::select! {
            event = self.live.recv() => match event {
                Ok(event) => Some(event.wire.clone()),
                Err(RecvError::Lagged(count)) => Some(lost(count)),
                Err(RecvError::Closed) => None,
            },
            _ = self.heartbeat.tick() => Some(Bytes::from_static(b": heartbeat\n\n")),
        }
    }
}

/// Tells a reader how many events it has missed; it has no id, so the reader's position stays.
fn lost(count: u64) -> Bytes {
    Bytes::from(format!("event: lost\ndata: {{\"lost\":{count}}}\n\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    async fn read(events: &Events, last_id: Option<u64>, chunks: usize) -> String {
        let permit = Arc::clone(&events.readers).try_acquire_owned().unwrap();
        let mut reader = events.reader(last_id, permit);
        let mut text = String::new();
        for _ in 0..chunks {
            text.push_str(std::str::from_utf8(&reader.next().await.unwrap()).unwrap());
        }
        text
    }

    #[tokio::test]
    async fn a_reader_that_returns_gets_what_it_missed_once() {
        let events = Events::new(8);
        for n in 1..=5 {
            assert_eq!(events.publish("camera", &n).unwrap(), n);
        }
        let text = read(&events, Some(3), 3).await;
        assert_eq!(text, "retry: 2000\n\nid: 4\nevent: camera\ndata: 4\n\nid: 5\nevent: camera\ndata: 5\n\n");
    }

    #[tokio::test]
    async fn what_is_forgotten_is_counted() {
        let events = Events::new(2);
        for n in 1..=5 {
            events.publish("camera", &n).unwrap();
        }
        let text = read(&events, Some(1), 4).await;
        assert!(text.contains("event: lost\ndata: {\"lost\":2}\n\nid: 4\n"), "{text}");
    }

    #[tokio::test]
    async fn a_slow_reader_is_told_what_it_lost() {
        let events = Events::new(2);
        let permit = Arc::clone(&events.readers).try_acquire_owned().unwrap();
        let mut reader = events.reader(None, permit);
        reader.next().await.unwrap();
        for n in 1..=5 {
            events.publish("camera", &n).unwrap();
        }
        assert_eq!(reader.next().await.unwrap(), "event: lost\ndata: {\"lost\":3}\n\n");
        assert_eq!(reader.next().await.unwrap(), "id: 4\nevent: camera\ndata: 4\n\n");
    }

    #[tokio::test(start_paused = true)]
    async fn silence_is_broken_by_heartbeats() {
        let text = read(&Events::new(2), None, 3).await;
        assert_eq!(text, "retry: 2000\n\n: heartbeat\n\n: heartbeat\n\n");
    }

    #[tokio::test]
    async fn an_id_of_another_process_replays_all() {
        let events = Events::new(4);
        events.publish("camera", &1).unwrap();
        assert!(read(&events, Some(900), 2).await.contains("id: 1\n"));
    }
}
