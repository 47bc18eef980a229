//! A served page, and a client that speaks to it as a browser does.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use translucid_load::{ExtendedBase, LoadOptions, still_life};
use translucid_scene::Scene;
use translucid_view::{Devices, Page, Settings};
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::{Message, WebSocket};

/// Longest that anything may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// A page that is served until this is dropped.
pub(crate) struct Served {
    pub(crate) address: String,
    quit: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// The still life in a few pixels.
pub(crate) fn small_still_life() -> Scene {
    let mut scene = still_life(&LoadOptions { size: Some([32, 18]), ..LoadOptions::default() }).unwrap();
    scene.integrator.samples_per_pixel = 3;
    scene
}

impl Served {
    pub(crate) fn new(scene: Scene) -> Self {
        let page = Page::serve(0).unwrap();
        let (address, quit) = (page.address(), Arc::new(AtomicBool::new(false)));
        let flag = Arc::clone(&quit);
        let settings = Settings {
            name: "still life".into(),
            base: ExtendedBase { extends: "still-life".into(), ..ExtendedBase::default() },
            load_base: Box::new(|_| still_life(&LoadOptions::default())),
            mesh: None,
            is_metered: false,
            command: String::new(),
            options: String::new(),
            devices: Devices::default(),
        };
        let thread = std::thread::spawn(move || page.show(scene, settings, &flag).unwrap());
        Self { address, quit, thread: Some(thread) }
    }

    /// "127.0.0.1:PORT".
    pub(crate) fn host(&self) -> &str {
        self.address.split('/').nth(2).unwrap()
    }

    /// "/TOKEN/".
    pub(crate) fn path(&self) -> String {
        format!("/{}/", self.address.split('/').nth(3).unwrap())
    }

    /// The answer to a request with these lines: its status, and all of it.
    pub(crate) fn request(&self, head: &str, body: &[u8]) -> (u16, String) {
        let mut stream = TcpStream::connect(self.host()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let head = format!("{head}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n", body.len());
        // The server may answer and close before it has read everything
        let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body));
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let text = String::from_utf8_lossy(&answer).into_owned();
        let status = text.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
        (status, text)
    }

    /// A file below the page's address.
    pub(crate) fn get(&self, file: &str) -> (u16, String) {
        self.request(&format!("GET {}{file} HTTP/1.1\r\nHost: {}", self.path(), self.host()), &[])
    }

    pub(crate) fn connect(&self) -> Client {
        Client::new(self)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.quit.store(true, Ordering::Relaxed);
        let result = self.thread.take().map(JoinHandle::join);
        assert!(std::thread::panicking() || !matches!(result, Some(Err(_))), "the renderer panicked");
    }
}

/// A picture from the server.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) kind: u8,
    pub(crate) divisor: u8,
    pub(crate) is_last: bool,
    pub(crate) number: u32,
    pub(crate) version: u32,
    pub(crate) samples: u32,
    pub(crate) codes: Vec<u8>,
}

/// A page without a browser.
pub(crate) struct Client {
    socket: WebSocket<TcpStream>,
    id: u32,
    pub(crate) hello: Value,
    pub(crate) state: Value,
    /// What the last message `state` said.
    pub(crate) news: Value,
    pub(crate) status: Value,
    /// Pictures that have come, whose kinds were wanted.
    pub(crate) frames: Vec<Frame>,
    /// Whether it says that it has shown them.
    pub(crate) paints: bool,
}

impl Client {
    fn new(served: &Served) -> Self {
        let stream = TcpStream::connect(served.host()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let mut request =
            format!("ws://{}{}socket", served.host(), served.path()).into_client_request().unwrap();
        let origin = HeaderValue::from_str(&format!("http://{}", served.host())).unwrap();
        request.headers_mut().insert("Origin", origin);
        let (socket, _) = tungstenite::client(request, stream).unwrap();
        let mut client = Self {
            socket,
            id: 0,
            hello: Value::Null,
            state: Value::Null,
            news: Value::Null,
            status: Value::Null,
            frames: Vec::new(),
            paints: true,
        };
        while client.state.is_null() {
            client.hear();
        }
        client
    }

    /// Hears the next thing that the server says; its answer to a message, if it is one.
    pub(crate) fn hear(&mut self) -> Option<Value> {
        match self.socket.read().unwrap() {
            Message::Binary(bytes) => {
                let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
                let frame = Frame {
                    kind: bytes[1],
                    divisor: bytes[2],
                    is_last: bytes[3] == 1,
                    number: number(4),
                    version: number(8),
                    samples: number(16),
                    codes: bytes[24..].to_vec(),
                };
                if self.paints {
                    self.say(&json!({ "type": "painted", "frame": frame.number }));
                }
                self.frames.push(frame);
                None
            }
            Message::Text(text) => {
                let value: Value = serde_json::from_str(text.as_str()).unwrap();
                match value["type"].as_str() {
                    Some("hello") => self.hello = value,
                    Some("state") => self.learn(value),
                    Some("status") => self.status = value,
                    _ => return Some(value),
                }
                None
            }
            _ => None,
        }
    }

    /// Takes over what has changed of the state.
    fn learn(&mut self, news: Value) {
        for (key, value) in news.as_object().unwrap() {
            match value.as_object() {
                Some(sides) if key == "sides" => {
                    sides.iter().for_each(|(side, look)| self.state["sides"][side] = look.clone());
                }
                _ => self.state[key] = value.clone(),
            }
        }
        self.news = news;
    }

    pub(crate) fn say(&mut self, message: &Value) {
        self.socket.send(Message::text(message.to_string())).unwrap();
    }

    pub(crate) fn say_text(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// The answer to a message.
    pub(crate) fn ask(&mut self, mut message: Value) -> Value {
        self.id += 1;
        message["id"] = json!(self.id);
        self.say(&message);
        loop {
            if let Some(answer) = self.hear()
                && answer["id"] == json!(self.id)
            {
                return answer;
            }
        }
    }

    /// Does what must succeed; its version.
    pub(crate) fn apply(&mut self, message: Value) -> u32 {
        let answer = self.ask(message);
        assert_eq!(answer["type"], "applied", "{answer}");
        answer["version"].as_u64().unwrap() as u32
    }

    /// The first picture of a side that has all samples of this version.
    pub(crate) fn finished(&mut self, kind: u8, version: u32) -> Frame {
        let start = Instant::now();
        loop {
            let is_it = |frame: &&Frame| frame.kind == kind && frame.is_last && frame.version >= version;
            if let Some(frame) = self.frames.iter().find(is_it) {
                return frame.clone();
            }
            assert!(start.elapsed() < PATIENCE, "{}", self.status);
            self.hear();
        }
    }
}
