//! Who is let in: this machine's own pages, and nobody who only guesses.
//!
//! A page of another site can make a browser send requests here, under this server's numbers or, by rebinding, under a
//! name of its own. The first lack the token and come with another `Origin`, the second with another `Host`.

use std::io;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Headers of every answer.
const HEADERS: [(HeaderName, &str); 7] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' blob: data:; \
         form-action 'none'; base-uri 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::CACHE_CONTROL, "no-store"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
];

pub(super) struct Guard {
    port: u16,
    /// 128 random bits.
    token: String,
}

impl Guard {
    pub(super) fn new(port: u16) -> io::Result<Self> {
        let mut bytes = [0_u8; 16];
        getrandom::fill(&mut bytes).map_err(|error| io::Error::other(error.to_string()))?;
        Ok(Self { port, token: bytes.iter().map(|byte| format!("{byte:02x}")).collect() })
    }

    pub(super) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Why a request is turned away.
    fn refusal(
        &self,
        method: &Method,
        path: &str,
        headers: &HeaderMap,
    ) -> Option<(StatusCode, &'static str)> {
        let single = |name: HeaderName| {
            let mut values = headers.get_all(name).iter();
            values.next().filter(|_| values.next().is_none()).and_then(|value| value.to_str().ok())
        };
        let Some(host) = single(header::HOST).filter(|host| is_this_machine(host)) else {
            return Some((StatusCode::FORBIDDEN, "this server goes by 127.0.0.1 and localhost only"));
        };
        // A browser names the origin wherever more than reading is meant
        let changes = *method != Method::GET || headers.contains_key(header::UPGRADE);
        let is_own = |origin: &str| origin.strip_prefix("http://") == Some(host);
        if (changes || headers.contains_key(header::ORIGIN)) && !single(header::ORIGIN).is_some_and(is_own) {
            return Some((StatusCode::FORBIDDEN, "only this server's own page may do that"));
        }
        let token = path.strip_prefix('/').and_then(|path| path.split('/').next()).unwrap_or_default();
        if !is_same(token, &self.token) {
            return Some((
                StatusCode::UNAUTHORIZED,
                "the address lacks its token: open the one that `translucid view` printed",
            ));
        }
        None
    }
}

/// Whether a host is this machine by name. Its port is that of a tunnel's other end, or any: a page elsewhere that has its name
/// lead to this machine comes by its own name.
fn is_this_machine(host: &str) -> bool {
    let (name, port) = host.split_once(':').unwrap_or((host, "80"));
    let is_port = port.bytes().all(|byte| byte.is_ascii_digit()) && port.parse::<u16>().is_ok();
    ["127.0.0.1", "localhost"].contains(&name) && is_port
}

/// Whether texts are equal, in a time that does not say where they differ.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |all, (x, y)| all | (x ^ y)) == 0
}

/// Lets a request pass, or answers it.
pub(super) async fn check(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let refusal = guard.refusal(request.method(), request.uri().path(), request.headers());
    let mut response = match refusal {
        Some(refusal) => refusal.into_response(),
        None => next.run(request).await,
    };
    for (name, value) in HEADERS {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(
        guard: &Guard,
        method: &Method,
        path: &str,
        headers: &[(HeaderName, &str)],
    ) -> Option<StatusCode> {
        let headers =
            headers.iter().map(|(name, value)| (name.clone(), HeaderValue::from_str(value).unwrap()));
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.append(name, value);
        }
        guard.refusal(method, path, &map).map(|(status, _)| status)
    }

    #[test]
    fn guard_lets_in_its_own_page_and_nobody_else() {
        let guard = Guard::new(4000).unwrap();
        let path = format!("/{}/socket", guard.token);
        let host = (header::HOST, "127.0.0.1:4000");
        let own = (header::ORIGIN, "http://127.0.0.1:4000");
        let upgrade = (header::UPGRADE, "websocket");
        let get = |path: &str, headers: &[(HeaderName, &str)]| refused(&guard, &Method::GET, path, headers);
        assert_eq!(get(&path, std::slice::from_ref(&host)), None);
        assert_eq!(get(&path, &[host.clone(), upgrade.clone(), own.clone()]), None);
        assert_eq!(refused(&guard, &Method::POST, &path, &[host.clone(), own.clone()]), None);
        // Through a tunnel with another port at its other end
        for name in ["localhost:9000", "127.0.0.1:4001", "localhost"] {
            let origin = format!("http://{name}");
            let headers = [(header::HOST, name), upgrade.clone(), (header::ORIGIN, &origin)];
            assert_eq!(get(&path, &headers), None, "{name}");
        }

        let forbidden = Some(StatusCode::FORBIDDEN);
        for name in [
            "evil.test:4000",
            "localhost:4000.evil.test",
            "localhost.evil.test:4000",
            "localhost:",
            "localhost:+4000",
            "localhost:65536",
            "",
            "LOCALHOST:4000 ",
        ] {
            assert_eq!(get(&path, &[(header::HOST, name)]), forbidden, "{name}");
        }
        assert_eq!(get(&path, &[]), forbidden);
        assert_eq!(get(&path, &[host.clone(), host.clone()]), forbidden);
        assert_eq!(get(&path, &[host.clone(), upgrade.clone()]), forbidden);
        assert_eq!(refused(&guard, &Method::POST, &path, std::slice::from_ref(&host)), forbidden);
        for origin in
            // Another server's page on this machine
            [
                "http://evil.test",
                "null",
                "http://localhost:4000",
                "http://127.0.0.1:5000",
                "http://127.0.0.1:4000.evil.test",
            ]
        {
            assert_eq!(
                get(&path, &[host.clone(), upgrade.clone(), (header::ORIGIN, origin)]),
                forbidden,
                "{origin}"
            );
        }

        let unknown = Some(StatusCode::UNAUTHORIZED);
        for path in ["/", "", "/socket", "//socket", "/00000000000000000000000000000000/socket", &path[..20]]
        {
            assert_eq!(get(path, std::slice::from_ref(&host)), unknown, "{path}");
        }
        assert_ne!(guard.token, Guard::new(4000).unwrap().token);
    }
}
