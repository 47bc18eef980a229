//! Who is let in.

use crate::client::{Served, small_still_life};

#[test]
fn strangers_are_turned_away() {
    let served = Served::new(small_still_life());
    let (path, host) = (served.path(), served.host().to_owned());
    let port = host.split(':').nth(1).unwrap().to_owned();
    let status = |head: String| served.request(&head, &[]).0;
    let own = format!("Origin: http://{host}");
    let upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==";

    let (found, page) = served.get("");
    assert_eq!(found, 200);
    assert!(page.contains("content-security-policy: default-src 'none'"), "{page}");
    assert_eq!(status(format!("GET {path} HTTP/1.1\r\nHost: localhost:{port}")), 200);

    // Without the token, by another name, from another site
    assert_eq!(status(format!("GET / HTTP/1.1\r\nHost: {host}")), 401);
    assert_eq!(status(format!("GET /{}/ HTTP/1.1\r\nHost: {host}", "0".repeat(32))), 401);
    assert_eq!(status(format!("GET {path} HTTP/1.1\r\nHost: evil.test:{port}")), 403);
    assert_eq!(status(format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nHost: evil.test")), 403);
    for origin in ["http://evil.test", "null", "https://127.0.0.1", &format!("http://127.0.0.1:{}", 1)] {
        assert_eq!(
            status(format!("GET {path}socket HTTP/1.1\r\nHost: {host}\r\n{upgrade}\r\nOrigin: {origin}")),
            403
        );
        let upload =
            format!("POST {path}environment?name=a.hdr HTTP/1.1\r\nHost: {host}\r\nOrigin: {origin}");
        assert_eq!(status(upload), 403);
    }
    assert_eq!(status(format!("GET {path}socket HTTP/1.1\r\nHost: {host}\r\n{upgrade}")), 403, "no origin");
    assert_eq!(status(format!("GET {path}socket HTTP/1.1\r\nHost: {host}\r\n{own}")), 400, "no upgrade");

    // No file but the page's own
    for file in
        ["../Cargo.toml", "..%2f..%2fetc/passwd", "%2e%2e/Cargo.toml", "/etc/passwd", "page.rs", "style.css/"]
    {
        assert_eq!(served.get(file).0, 404, "{file}");
    }
    assert_eq!(served.get("style.css").0, 200);
}
