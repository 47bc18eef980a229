//! The server of the page: its files, its socket, what it takes and gives.

mod downloads;
mod guard;
mod socket;

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;

use axum::Router;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, Path, Query, State};
use axum::http::{StatusCode, header};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::{any, get, post};
use serde::Deserialize;
use tokio::sync::{Semaphore, watch};
use translucid_scene::SceneError;

use crate::conversation;
use crate::files::bring_environment;
use crate::page::PAGE_FILES;
use crate::shared::Shared;
use guard::Guard;

/// Most bytes of an image that a page sends.
const MOST_UPLOADED: usize = 128 << 20;
/// Most pages that are connected at a time.
const MOST_PAGES: usize = 16;

/// A page's address, which is served from now on; it shows nothing before the scene is there.
pub(crate) struct Server {
    guard: Arc<Guard>,
    scene: watch::Sender<Option<Arc<Shared>>>,
    /// Serves until it is dropped.
    _runtime: tokio::runtime::Runtime,
}

/// State shared by all handlers.
#[derive(Clone)]
struct Context {
    scene: watch::Receiver<Option<Arc<Shared>>>,
    guard: Arc<Guard>,
    pages: Arc<Semaphore>,
    uploads: Arc<Semaphore>,
}

impl Context {
    /// The scene, once it is there; none if the program ends before.
    async fn scene(&self) -> Option<Arc<Shared>> {
        let mut scene = self.scene.clone();
        let there = scene.wait_for(Option::is_some).await.ok()?;
        there.clone()
    }
}

impl Server {
    /// Begins to serve on this machine alone, at a port or, for 0, at any that is free.
    ///
    /// # Errors
    /// The port is taken, or the threads cannot be started.
    pub(crate) fn start(port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port)))?;
        listener.set_nonblocking(true)?;
        let guard = Arc::new(Guard::new(listener.local_addr()?.port())?);
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .max_blocking_threads(4)
            .thread_name("page")
            .enable_io()
            .enable_time()
            .build()?;
        let scene = watch::Sender::new(None);
        let context = Context {
            scene: scene.subscribe(),
            guard: Arc::clone(&guard),
            pages: Arc::new(Semaphore::new(MOST_PAGES)),
            uploads: Arc::new(Semaphore::new(1)),
        };
        let router = router(context);
        let _entered = runtime.enter();
        let listener = tokio::net::TcpListener::from_std(listener)?;
        runtime.spawn(async move {
            // It serves for as long as its runtime lives
            let _ = axum::serve(listener, router).await;
        });
        Ok(Self { guard, scene, _runtime: runtime })
    }

    /// The page's address, which lets in whoever knows it.
    pub(crate) fn address(&self) -> String {
        self.guard.address()
    }

    /// Lets pages see a scene.
    pub(crate) fn show(&self, shared: Arc<Shared>) {
        self.scene.send_replace(Some(shared));
    }
}

fn router(context: Context) -> Router {
    Router::new()
        .route("/{token}/", get(|| async { page_file("index.html") }))
        .route("/{token}/socket", any(socket::upgrade))
        .route("/{token}/environment", post(environment))
        .route("/{token}/scene.toml", get(downloads::scene))
        .route("/{token}/picture.png", get(downloads::png))
        .route("/{token}/picture.exr", get(downloads::exr))
        .route(
            "/{token}/{*file}",
            get(|Path((_, file)): Path<(String, String)>| async move { page_file(&file) }),
        )
        .layer(DefaultBodyLimit::max(MOST_UPLOADED))
        .layer(middleware::from_fn_with_state(Arc::clone(&context.guard), guard::check))
        .with_state(context)
}

fn page_file(path: &str) -> Response {
    match PAGE_FILES.iter().find(|file| file.path == path) {
        Some(file) => ([(header::CONTENT_TYPE, file.media_type)], file.bytes).into_response(),
        None => (StatusCode::NOT_FOUND, "there is nothing here").into_response(),
    }
}

/// An answer in words that the page shows.
fn refusal(status: StatusCode, error: &SceneError) -> Response {
    let body = conversation::refusal(error);
    (status, [(header::CONTENT_TYPE, "application/json")], body.to_string()).into_response()
}

#[derive(Deserialize)]
struct UploadQuery {
    name: String,
}

/// Makes a picture that the page sends the environment.
async fn environment(
    State(context): State<Context>,
    Query(query): Query<UploadQuery>,
    bytes: Bytes,
) -> Response {
    let Some(shared) = context.scene().await else { return StatusCode::SERVICE_UNAVAILABLE.into_response() };
    // One at a time: each may take much memory
    let Ok(_turn) = context.uploads.acquire().await else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let brought = tokio::task::spawn_blocking(move || bring_environment(&shared, &query.name, &bytes));
    match brought.await {
        Ok(Ok(())) => ([(header::CONTENT_TYPE, "application/json")], r#"{"ok":true}"#).into_response(),
        Ok(Err(error)) => refusal(StatusCode::UNPROCESSABLE_ENTITY, &error),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}
