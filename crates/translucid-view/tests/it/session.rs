//! What pages and server say to each other.

use std::sync::atomic::AtomicBool;

use serde_json::json;
use translucid_image::DisplayTransform;
use translucid_load::{LoadOptions, load_scene};
use translucid_render::{Plan, PreparedScene, Session};
use translucid_scene::Scene;

use crate::client::{Served, small_still_life};

/// Index of the first material with light under its surface.
const MARBLE: usize = 3;

/// The codes of the picture that the command makes of a scene.
fn expected(scene: &Scene) -> Vec<u8> {
    let prepared = PreparedScene::new(scene.clone()).unwrap();
    let view = prepared.view().unwrap();
    let mut session = Session::new(prepared, view);
    let plan = Plan::samples(scene.integrator.samples_per_pixel);
    session.run(&plan, &|_| {}, &AtomicBool::new(false)).unwrap();
    let display = DisplayTransform { exposure: scene.film.exposure, tone_mapping: scene.film.tone_mapping };
    session.film().sums().display_picture(&Default::default()).display_codes(display).unwrap()
}

#[test]
fn picture_of_the_page_is_that_of_the_command() {
    let scene = small_still_life();
    let served = Served::new(scene.clone());
    let mut client = served.connect();
    assert_eq!(client.state["sides"]["a"]["materials"][MARBLE]["name"], "marble");
    let frame = client.finished(0, 1);
    assert_eq!((frame.samples, frame.divisor, frame.codes.len()), (3, 1, 32 * 18 * 4));

    assert!(frame.codes == expected(&scene), "the page's picture differs from the command's");

    // After edits of everything, and back
    let mut edited = scene.clone();
    edited.materials[MARBLE].subsurface_radius.factor = 0.4;
    edited.film.exposure = 1.0;
    edited.camera.position.x += 5.0;
    edited.integrator.seed = 5;
    client.apply(json!({"type":"material","index":MARBLE,"set":{"subsurface_radius":0.4}}));
    client.apply(json!({"type":"film","set":{"exposure":1.0}}));
    client.apply(json!({"type":"integrator","set":{"seed":5}}));
    let mut camera = client.state["camera"].clone();
    camera["position"][0] = json!(edited.camera.position.x);
    let version = client.apply(json!({"type":"camera","camera":camera,"moving":true}));
    assert!(client.finished(0, version).codes == expected(&edited), "after edits it differs");
    (0..3).for_each(|_| _ = client.apply(json!({"type":"undo"})));
    let version = client.apply(json!({"type":"undo"}));
    assert!(client.finished(0, version).codes == expected(&scene), "after undo it differs");
}

#[test]
fn saved_scene_renders_to_the_pixels_of_the_page() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    // Two pixels of sky, brighter on one side
    let sky: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x60\x40\x81\x20\x40\x80\x82";
    let (path, host) = (served.path(), served.host());
    let head =
        format!("POST {path}environment?name=my%20sky.hdr HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}");
    let (status, answer) = served.request(&head, sky);
    assert_eq!(status, 200, "{answer}");
    let environment = client.ask(json!({"type":"pick","x":1,"y":1}));
    assert_eq!(environment["type"], "picked");
    let number = client.state["sides"]["a"]["environment"]["image"].clone();
    assert_eq!(number, 0, "{}", client.state["images"]);
    client.apply(json!({
        "type": "environment",
        "environment": { "radiance": [0.7, 0.8, 0.9], "image": number, "rotation": 33.3, "visible": true },
    }));
    let mut light = client.state["sides"]["a"]["lights"][0].clone();
    light["radiance"] = json!([3.1, 4.7, 5.9]);
    light["center"][1] = json!(31.7);
    client.apply(json!({"type":"light","index":0,"light":light}));
    client.apply(json!({"type":"material","index":MARBLE,"set":{"preset":"jade","specular_roughness":0.37}}));
    client.apply(json!({"type":"film","set":{"exposure":-0.3,"tone_mapping":"agx"}}));
    client.apply(json!({"type":"integrator","set":{"max_diffuse_depth":2,"seed":11}}));
    let mut camera = client.state["camera"].clone();
    camera["position"] = json!([-9.37, 21.3, 61.1]);
    camera["fov"] = json!(37.7);
    camera["shift"] = json!([0.05, -0.1]);
    let version = client.apply(json!({"type":"camera","camera":camera}));
    let frame = client.finished(0, version);

    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my sky.hdr"), sky).unwrap();
    let (status, answer) = served.get("scene.toml");
    assert_eq!(status, 200, "{answer}");
    let (_, text) = answer.split_once("\r\n\r\n").unwrap();
    let file = folder.path().join("saved.toml");
    std::fs::write(&file, text).unwrap();
    let loaded = load_scene(&file, &LoadOptions::default(), &mut Vec::new()).unwrap();
    assert!(frame.codes == expected(&loaded), "the saved scene renders otherwise:\n{text}");
}

#[test]
fn state_says_which_model_a_default_is() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    for (edit, named, model) in [
        (json!({"type":"film","set":{"exposure":0.5}}), "default", "random-walk"),
        (
            json!({"type":"integrator","set":{"subsurface_method":"point-based"}}),
            "default",
            "normalized-diffusion-oblique",
        ),
        (
            json!({"type":"material","index":MARBLE,"set":{"subsurface_eta":1.4}}),
            "default",
            "normalized-diffusion-refined",
        ),
        (json!({"type":"material","index":MARBLE,"set":{"subsurface_model":"dipole"}}), "dipole", "dipole"),
        (
            json!({"type":"material","index":MARBLE,"set":{"subsurface_model":"default"}}),
            "default",
            "normalized-diffusion-refined",
        ),
    ] {
        client.apply(edit);
        let profile = client.ask(json!({"type":"profile","index":MARBLE}));
        assert_eq!(profile["model"], model, "{profile}");
        // The state came before the answer
        let material = &client.state["sides"]["a"]["materials"][MARBLE];
        assert_eq!((&material["subsurface_model"], &material["model"]), (&json!(named), &json!(model)));
    }
}

#[test]
fn sides_are_rendered_beside_each_other() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    client.apply(json!({"type":"compare","on":true}));
    client.apply(json!({"type":"side","side":"b"}));
    let edited = client.apply(json!({"type":"material","index":MARBLE,"set":{"subsurface_model":"none"}}));
    let version = client.apply(json!({"type":"show","view":"difference"}));
    let map = client.finished(2, version);
    // B may have been finished before its edit, too
    let [a, b] = [(0, 1), (1, edited)].map(|(kind, version)| client.finished(kind, version));
    assert!(a.codes != b.codes && map.codes.len() == a.codes.len());
    while client.status["phase"] != "done" || client.status["version"] != version {
        client.hear();
    }
    assert!(client.status["difference"]["relative_mse"].as_f64().unwrap() > 0.0, "{}", client.status);
    client.apply(json!({"type":"swap"}));
    let version = client.apply(json!({"type":"compare","on":false}));
    assert!(client.finished(0, version).codes == b.codes, "A is what B was");
}

#[test]
fn lights_come_and_go_and_the_saved_scene_has_them() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    let count = client.state["sides"]["a"]["lights"].as_array().unwrap().len();
    let sun =
        json!({"type":"distant","direction":[0.0,0.6,0.8],"angular_radius":0.5,"irradiance":[2.0,1.5,1.0]});
    let bulb = json!({"type":"spot","position":[0,40,30],"direction":[0,-0.8,-0.6],"intensity":[900,900,900],
        "inner_angle":0,"outer_angle":180,"radius":1.5,"visible":false});
    client.apply(json!({"type":"add_light","light":sun}));
    client.apply(json!({"type":"add_light","light":bulb}));
    let version = client.apply(json!({"type":"remove_light","index":0}));
    let lit = client.finished(0, version);
    assert_eq!(client.state["sides"]["a"]["lights"].as_array().unwrap().len(), count + 1);

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("saved.toml");
    let (_, answer) = served.get("scene.toml");
    std::fs::write(&file, answer.split_once("\r\n\r\n").unwrap().1).unwrap();
    let loaded = load_scene(&file, &LoadOptions::default(), &mut Vec::new()).unwrap();
    assert_eq!(loaded.lights.len(), count + 1);
    assert!(lit.codes == expected(&loaded), "the saved scene renders otherwise:\n{answer}");

    for (message, words) in [
        (json!({"type":"remove_light","index":count + 1}), "is not there"),
        (
            json!({"type":"add_light","light":{"type":"point","position":[0,0,0]}}),
            "it needs the key intensity",
        ),
        (
            json!({"type":"add_light","light":{"type":"sphere","center":[0,0,0],"radius":0,"radiance":[1,1,1],"visible":true}}),
            "radius",
        ),
    ] {
        let answer = client.ask(message);
        assert!(answer["type"] == "error" && answer["message"].as_str().unwrap().contains(words), "{answer}");
    }
    (0..2).for_each(|_| _ = client.apply(json!({"type":"undo"})));
    let version = client.apply(json!({"type":"undo"}));
    assert!(client.finished(0, version).codes == expected(&small_still_life()), "after undo it differs");
}

#[test]
fn edits_of_both_sides_reach_both() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    assert_eq!(client.hello["sides"], json!(["a", "b", "both"]));
    client.apply(json!({"type":"compare","on":true}));
    client.apply(json!({"type":"side","side":"b"}));
    client.apply(json!({"type":"material","index":MARBLE,"set":{"subsurface_model":"none"}}));
    client.apply(json!({"type":"side","side":"both"}));
    let set = json!({"type":"material","index":MARBLE,"set":{"subsurface_radius":0.9}});
    let version = client.apply(set);
    let mut edited = small_still_life();
    edited.materials[MARBLE].subsurface_radius.factor = 0.9;
    assert!(client.finished(0, version).codes == expected(&edited), "A");
    edited.materials[MARBLE].subsurface_model = translucid_scene::SubsurfaceModel::None;
    assert!(client.finished(1, version).codes == expected(&edited), "B");
    // One of them cannot: neither does
    client.apply(json!({"type":"side","side":"b"}));
    let light = client.state["sides"]["a"]["lights"][0].clone();
    client.apply(json!({"type":"add_light","light":light}));
    client.apply(json!({"type":"side","side":"both"}));
    let last = client.state["sides"]["b"]["lights"].as_array().unwrap().len() - 1;
    let before = client.state["sides"].clone();
    assert_eq!(client.ask(json!({"type":"remove_light","index":last}))["type"], "error");
    client.apply(json!({"type":"pause","on":false}));
    assert_eq!(client.state["sides"], before);
}

#[test]
fn pages_are_told_what_has_changed() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    let told = |client: &crate::client::Client| {
        client.news.as_object().unwrap().keys().cloned().collect::<Vec<_>>().join(" ")
    };
    let mut camera = client.state["camera"].clone();
    for step in 1..=3 {
        camera["position"][0] = json!(f64::from(step));
        let version = client.apply(json!({"type":"camera","camera":camera,"moving":true,"gesture":5}));
        while client.state["version"] != version {
            client.hear();
        }
        let keys = if step == 1 { "camera type undo version" } else { "camera type version" };
        assert_eq!(told(&client), keys);
    }
    let version = client.apply(json!({"type":"material","index":MARBLE,"set":{"specular_roughness":0.123}}));
    while client.state["version"] != version {
        client.hear();
    }
    assert_eq!(told(&client), "sides type version");
    // A page that comes later hears it all
    let other = served.connect();
    assert_eq!((&other.state, &other.news["camera"]), (&client.state, &client.state["camera"]));
    // The three camera moves were one gesture
    client.apply(json!({"type":"undo"}));
    let version = client.apply(json!({"type":"undo"}));
    while client.state["version"] != version {
        client.hear();
    }
    assert_eq!(client.state["undo"], false);
    assert_eq!(client.state["camera"]["position"], client.state["cameras"][0]["camera"]["position"]);
}

#[test]
fn pages_share_one_session_and_come_back_to_it() {
    let served = Served::new(small_still_life());
    let mut first = served.connect();
    let mut second = served.connect();
    first.apply(json!({"type":"material","index":MARBLE,"set":{"subsurface_radius":0.9}}));
    let radius = |client: &crate::client::Client| {
        client.state["sides"]["a"]["materials"][MARBLE]["parameters"]["subsurface_radius"]["value"].as_f64()
    };
    while radius(&second).is_none_or(|value| (value - 0.9).abs() > 1e-6) {
        second.hear();
    }
    drop((first, second));
    let mut third = served.connect();
    assert!((radius(&third).unwrap() - 0.9).abs() < 1e-6);
    assert!(!third.finished(0, 1).codes.is_empty());
}

#[test]
fn page_that_shows_nothing_gets_no_queue_of_pictures() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    client.paints = false;
    let mut version = 0;
    for i in 0..40 {
        let radius = 0.1 + 0.01 * f64::from(i);
        version = client.apply(json!({"type":"material","index":MARBLE,"set":{"subsurface_radius":radius}}));
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    client.apply(json!({"type":"pause","on":true}));
    assert!(client.frames.len() <= 1, "{}", client.frames.len());
    // When it has shown that one it gets the newest, and few of those between
    client.paints = true;
    let shown = client.frames.first().map_or(0, |frame| frame.number);
    client.say(&json!({"type":"painted","frame":shown}));
    while client.frames.last().is_none_or(|frame| frame.version < version) {
        client.hear();
    }
    assert!(client.frames.len() <= 5, "{} of 40", client.frames.len());
}

#[test]
fn questions_are_answered() {
    let served = Served::new(small_still_life());
    let mut client = served.connect();
    client.finished(0, 1);
    let picked = client.ask(json!({"type":"pick","x":20.5,"y":8.5}));
    assert!(picked["object"].is_string() && picked["position"][2].is_number(), "{picked}");
    assert!(picked["sides"]["a"]["radiance"][0].as_f64().unwrap() > 0.0, "{picked}");
    assert!(client.ask(json!({"type":"pick","x":-500,"y":1e30}))["sides"]["a"].is_null());
    let set = json!({"subsurface_model":"normalized-diffusion-oblique"});
    client.apply(json!({"type":"material","index":MARBLE,"set":set}));
    let profile = client.ask(json!({"type":"profile","index":MARBLE}));
    assert_eq!((profile["type"].as_str(), profile["index"].as_u64()), (Some("profile"), Some(MARBLE as u64)));
    assert!(profile["channels"][0]["error_percent"].as_f64().unwrap() < 3.0, "{profile}");
    assert!(!client.ask(json!({"type":"numbers","index":MARBLE}))["rows"].as_array().unwrap().is_empty());
    assert_eq!(client.ask(json!({"type":"numbers","index":999}))["type"], "error");
    for (file, start) in [("picture.png", "\u{fffd}PNG"), ("picture.exr", "v/1"), ("scene.toml", "extends")] {
        let (status, answer) = served.get(file);
        assert!(status == 200 && answer.contains("content-disposition: attachment"), "{file}: {answer}");
        let body = answer.split("\r\n\r\n").nth(1).unwrap();
        assert!(body.trim_start_matches('#').contains(start), "{file}: {}", &body[..40.min(body.len())]);
    }
}
