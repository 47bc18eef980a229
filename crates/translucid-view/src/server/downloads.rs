//! Files that a page takes away: the scene, the picture.

use axum::extract::{Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;

use super::{Context, refusal};
use crate::files::{PictureFormat, encode_picture};
use crate::message::Side;

#[derive(Deserialize)]
pub(super) struct SideQuery {
    #[serde(default)]
    side: Side,
}

/// The scene with the edits of the active side.
pub(super) async fn scene(State(context): State<Context>) -> Response {
    let Some(shared) = context.scene().await else { return StatusCode::SERVICE_UNAVAILABLE.into_response() };
    let name = shared.settings.scene_file();
    match tokio::task::spawn_blocking(move || shared.scene_text()).await {
        Ok(Ok(text)) => attachment(&name, "application/toml", text.into_bytes()),
        Ok(Err(error)) => refusal(StatusCode::CONFLICT, &error),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// The picture with its layers.
pub(super) async fn exr(context: State<Context>, query: Query<SideQuery>) -> Response {
    picture(context, query, PictureFormat::Exr).await
}

/// The picture as a display shows it.
pub(super) async fn png(context: State<Context>, query: Query<SideQuery>) -> Response {
    picture(context, query, PictureFormat::Png).await
}

async fn picture(
    State(context): State<Context>,
    Query(SideQuery { side }): Query<SideQuery>,
    format: PictureFormat,
) -> Response {
    let Some(shared) = context.scene().await else { return StatusCode::SERVICE_UNAVAILABLE.into_response() };
    let Some(film) = shared.side(side).filter(|side| side.film.samples() > 0) else {
        return (StatusCode::NOT_FOUND, "there is no picture yet").into_response();
    };
    let name = shared.settings.picture_file(format.extension());
    let encoded = tokio::task::spawn_blocking(move || encode_picture(&shared, &film, format));
    match encoded.await {
        Ok(Ok(bytes)) => attachment(&name, "application/octet-stream", bytes),
        _ => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// A file for the browser to keep; its name as RFC 5987 encodes it.
fn attachment(name: &str, media_type: &'static str, bytes: Vec<u8>) -> Response {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'-' | b'_');
    let name: String = name
        .bytes()
        .map(|byte| if is_plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect();
    let disposition = format!("attachment; filename*=UTF-8''{name}");
    ([(header::CONTENT_TYPE, media_type.to_owned()), (header::CONTENT_DISPOSITION, disposition)], bytes)
        .into_response()
}
