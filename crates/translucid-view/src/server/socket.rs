//! The conversation with a page.
//!
//! Nothing queues up: states, reports and pictures are the latest ones, whatever was in between, and a page gets the next
//! picture only when it has shown the last.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::{Message as Packet, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use tokio::sync::{Semaphore, mpsc, watch};

use super::Context;
use crate::conversation::{Heard, Question, hear};
use crate::page_state::PageState;
use crate::shared::{Frame, Shared};

/// Most bytes of a message.
const LONGEST_MESSAGE: usize = 64 << 10;
/// Messages a second that are read, and those that may come at once.
const MESSAGES_PER_SECOND: f64 = 500.0;
const MOST_AT_ONCE: f64 = 500.0;
/// Answers that wait to be sent.
const MOST_ANSWERS: usize = 256;

/// Opens a page's socket.
pub(super) async fn upgrade(State(context): State<Context>, upgrade: WebSocketUpgrade) -> Response {
    let Ok(place) = Arc::clone(&context.pages).try_acquire_owned() else {
        let message = "too many pages are open: close one";
        return (StatusCode::SERVICE_UNAVAILABLE, message).into_response();
    };
    upgrade.max_message_size(LONGEST_MESSAGE).max_frame_size(LONGEST_MESSAGE).on_upgrade(
        async move |socket| {
            if let Some(shared) = context.scene().await {
                Conversation::new(shared, socket).run().await;
            }
            drop(place);
        },
    )
}

/// The page is gone.
struct Gone;

struct Conversation {
    shared: Arc<Shared>,
    socket: WebSocket,
    state: watch::Receiver<Arc<PageState>>,
    /// The state that the page was told last.
    told: Option<Arc<PageState>>,
    status: watch::Receiver<Arc<str>>,
    frames: [watch::Receiver<Option<Frame>>; 3],
    /// Numbers of pictures that were sent and are not shown yet.
    on_their_way: [Option<u32>; 3],
    answers: (mpsc::Sender<String>, mpsc::Receiver<String>),
    /// What is computed in the background, one after another; of several that wait only the last.
    turn: Arc<Semaphore>,
    newest: [Arc<AtomicU32>; 2],
    allowance: Allowance,
}

impl Conversation {
    fn new(shared: Arc<Shared>, socket: WebSocket) -> Self {
        let newest = || Arc::new(AtomicU32::new(0));
        Self {
            state: shared.state.subscribe(),
            told: None,
            status: shared.status.subscribe(),
            frames: std::array::from_fn(|kind| shared.frames[kind].subscribe()),
            on_their_way: [None; 3],
            answers: mpsc::channel(MOST_ANSWERS),
            turn: Arc::new(Semaphore::new(1)),
            newest: [newest(), newest()],
            allowance: Allowance { left: MOST_AT_ONCE, counted: Instant::now() },
            shared,
            socket,
        }
    }

    async fn run(mut self) {
        // An error is a page that has gone, which needs no answer
        let _ = self.talk().await;
    }

    async fn talk(&mut self) -> Result<(), Gone> {
        let hello = self.shared.hello.clone();
        self.send(hello).await?;
        self.state.mark_changed();
        self.status.mark_changed();
        self.frames.iter_mut().for_each(watch::Receiver::mark_changed);
        loop {
            let [a, b, both] = &mut self.frames;
            let [a_free, b_free, both_free] = self.on_their_way.map(|number| number.is_none());
            let kind = tokio::select! {
                packet = self.socket.recv() => {
                    let Some(Ok(packet)) = packet else { return Err(Gone) };
                    if let Packet::Text(text) = packet {
                        self.tell().await?;
                        self.hear(text.as_str()).await?;
                    }
                    continue;
                }
                Some(answer) = self.answers.1.recv() => {
                    self.tell().await?;
                    self.send(answer).await?;
                    continue;
                }
                changed = self.state.changed() => {
                    changed.map_err(|_| Gone)?;
                    self.tell().await?;
                    continue;
                }
                changed = self.status.changed() => {
                    changed.map_err(|_| Gone)?;
                    let text = self.status.borrow_and_update().to_string();
                    self.send(text).await?;
                    continue;
                }
                changed = a.changed(), if a_free => changed.map(|()| 0),
                changed = b.changed(), if b_free => changed.map(|()| 1),
                changed = both.changed(), if both_free => changed.map(|()| 2),
            };
            let kind = kind.map_err(|_| Gone)?;
            let frame = self.frames[kind].borrow_and_update().clone();
            if let Some(frame) = frame {
                self.tell().await?;
                self.on_their_way[kind] = Some(frame.number);
                self.socket.send(Packet::Binary(Bytes::from_owner(frame.bytes))).await.map_err(|_| Gone)?;
            }
        }
    }

    /// Sends what has changed of the state: before an answer or a picture that speaks of it.
    async fn tell(&mut self) -> Result<(), Gone> {
        let state = Arc::clone(&self.state.borrow_and_update());
        if self.told.as_ref().is_some_and(|told| Arc::ptr_eq(told, &state)) {
            return Ok(());
        }
        let text = state.message(self.told.as_deref());
        self.told = Some(state);
        self.send(text).await
    }

    async fn send(&mut self, text: String) -> Result<(), Gone> {
        self.socket.send(Packet::Text(text.into())).await.map_err(|_| Gone)
    }

    /// Does what a message asks for, and answers.
    async fn hear(&mut self, text: &str) -> Result<(), Gone> {
        if let Some(pause) = self.allowance.take() {
            tokio::time::sleep(pause).await;
        }
        match hear(&self.shared, text) {
            Heard::Answer(answer) => self.send(answer).await,
            Heard::Question(question) => {
                self.ask(question);
                Ok(())
            }
            Heard::Turn(turn) => {
                // The page waits, and the others do not
                let (id, shared) = (turn.id(), Arc::clone(&self.shared));
                let answer = tokio::task::spawn_blocking(move || turn.answer(&shared)).await;
                self.send(answer.unwrap_or_else(|_| Question::failed(id))).await
            }
            Heard::Painted(frame) => {
                for number in &mut self.on_their_way {
                    number.take_if(|number| *number == frame);
                }
                Ok(())
            }
        }
    }

    /// Computes an answer in the background.
    fn ask(&self, question: Question) {
        let shared = Arc::clone(&self.shared);
        let (turn, newest, answers) = (
            Arc::clone(&self.turn),
            Arc::clone(&self.newest[question.topic as usize]),
            self.answers.0.clone(),
        );
        let number = newest.fetch_add(1, Ordering::Relaxed) + 1;
        tokio::spawn(async move {
            let Ok(_turn) = turn.acquire().await else { return };
            if newest.load(Ordering::Relaxed) != number {
                return;
            }
            let id = question.id();
            let answer = tokio::task::spawn_blocking(move || question.answer(&shared)).await;
            // A page that does not read its answers gets no more of them
            let _ = answers.try_send(answer.unwrap_or_else(|_| Question::failed(id)));
        });
    }
}

/// Messages that may still be read.
struct Allowance {
    left: f64,
    counted: Instant,
}

impl Allowance {
    /// Takes one; how long to wait before it is due.
    fn take(&mut self) -> Option<Duration> {
        let earned = self.counted.elapsed().as_secs_f64() * MESSAGES_PER_SECOND;
        self.counted = Instant::now();
        self.left = (self.left + earned).min(MOST_AT_ONCE) - 1.0;
        (self.left < 0.0).then(|| Duration::from_secs_f64(-self.left / MESSAGES_PER_SECOND))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn allowance_slows_down_those_who_say_too_much() {
        let mut allowance = Allowance { left: MOST_AT_ONCE, counted: Instant::now() };
        let waits = (0..2000).filter_map(|_| allowance.take()).count();
        assert!((1400..=1500).contains(&waits), "{waits}");
    }
}
