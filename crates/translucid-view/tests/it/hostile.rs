//! Messages and files that nobody would send in good faith.

use serde_json::{Value, json};
use translucid_testing::mutants;

use crate::client::{Served, small_still_life};

/// Messages as a page says them, to be broken.
fn messages() -> Vec<Value> {
    let camera = json!({
        "position": [0.0, 20.0, 70.0],
        "target": [0.0, 9.0, 0.0],
        "up": [0.0, 1.0, 0.0],
        "fov": 40.0,
        "shift": [0.0, 0.0],
        "lens_radius": 0.0,
        "focus_distance": 60.0,
    });
    vec![
        json!({"type":"material","index":3,"set":{"subsurface_radius":0.5,"subsurface_color":[0.5,0.4,0.3]},"gesture":1}),
        json!({"type":"material","index":4,"set":{"preset":"jade","subsurface_model":"dipole"}}),
        json!({"type":"light","index":0,"light":{"type":"sphere","center":[0,30,9],"radius":3,"radiance":[9,9,9],"visible":true}}),
        json!({"type":"environment","environment":{"radiance":[1,1,1],"image":null,"rotation":30,"visible":false}}),
        json!({"type":"integrator","set":{"samples_per_pixel":2,"subsurface_sharing":false,"seed":7}}),
        json!({"type":"film","set":{"exposure":1.5,"tone_mapping":"agx","size":[24,16]}}),
        json!({"type":"camera","camera":camera,"moving":true}),
        json!({"type":"show","view":"normal"}),
        json!({"type":"compare","on":true}),
        json!({"type":"side","side":"b"}),
        json!({"type":"pick","x":3.5,"y":4.5}),
        json!({"type":"profile","index":3}),
        json!({"type":"numbers","index":3}),
        json!({"type":"painted","frame":4}),
        json!({"type":"undo"}),
        json!({"type":"frame"}),
    ]
}

#[test]
fn server_survives_a_flood_of_broken_messages() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    let texts: Vec<String> = messages().iter().map(Value::to_string).collect();
    for text in &texts {
        for bytes in mutants(text.as_bytes(), 40) {
            client.say_text(&String::from_utf8_lossy(&bytes));
        }
    }
    let version = client.apply(json!({"type":"reset"}));
    assert!(version > 1);
    client.apply(json!({"type":"integrator","set":{"samples_per_pixel":1}}));
    let notes = client.state["notes"].to_string();
    assert!(!notes.contains("a defect"), "{notes}");

    // A message beyond the limit closes this page's socket and no other's
    let mut loud = served.connect();
    loud.say_text(&" ".repeat((64 << 10) + 1));
    let gone = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| while loud.hear().is_none() {}));
    assert!(gone.is_err(), "the socket should have been closed");
    assert_eq!(client.ask(json!({"type":"pick","x":1,"y":1}))["type"], "picked");
}

#[test]
fn hostile_images_are_refused_in_words() {
    let served = Served::new(small_still_life());
    let upload = |bytes: &[u8], name: &str| {
        let (path, host) = (served.path(), served.host());
        let head =
            format!("POST {path}environment?name={name} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}");
        served.request(&head, bytes)
    };
    let sky = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n\x80\x80\x80\x81\x80\x80\x80\x81\x80\x80\x80\x81\x80\x80\x80\x81";
    let mut refused = 0;
    for bytes in mutants(sky, 200) {
        let (status, answer) = upload(&bytes, "sky.hdr");
        assert!(status == 200 || status == 422 && answer.contains("\"message\":\""), "{status}: {answer}");
        refused += u32::from(status == 422);
    }
    assert!(refused > 50, "{refused}");
    for (bytes, words) in [
        (&b""[..], "sky.hdr"),
        (b"<html>", "sky.hdr"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999999 +X 99999999\n", "sky.hdr"),
    ] {
        let (status, answer) = upload(bytes, "..%2Fsky.hdr");
        assert!(status == 422 && answer.contains(words), "{status}: {answer}");
    }
    let mut client = served.connect();
    assert_eq!(client.ask(json!({"type":"pick","x":1,"y":1}))["type"], "picked");
}
