//! Tests of the state.

use translucid_load::{LoadOptions, UpAxis, still_life};
use translucid_profile::convention::preset;
use translucid_scene::Pixels;

use super::*;
use crate::message::Numbered;

fn studio() -> Studio {
    Studio::new(&still_life(&LoadOptions::default()).unwrap(), None, false).unwrap()
}

fn say(studio: &mut Studio, text: &str) -> Result<(), SceneError> {
    studio.apply(Numbered::parse(text).message.unwrap())
}

fn radius(studio: &Studio, side: usize) -> f32 {
    studio.setup.looks[side].materials[2].subsurface_radius.factor
}

fn set_radius(studio: &mut Studio, radius: f32, gesture: u32) {
    let text = format!(
        r#"{{"type":"material","index":2,"set":{{"subsurface_radius":{radius}}},"gesture":{gesture}}}"#
    );
    say(studio, &text).unwrap();
}

#[test]
fn gestures_are_steps_of_undo() {
    let mut studio = studio();
    let first = radius(&studio, 0);
    for (value, gesture) in [(1.0, 1), (1.5, 1), (2.0, 1), (3.0, 2), (4.0, 2)] {
        set_radius(&mut studio, value, gesture);
    }
    assert_eq!(studio.done.len(), 2);
    let undo = |studio: &mut Studio| say(studio, r#"{"type":"undo"}"#).unwrap();
    undo(&mut studio);
    assert_eq!(radius(&studio, 0), 2.0);
    undo(&mut studio);
    assert_eq!(radius(&studio, 0), first);
    undo(&mut studio);
    assert_eq!(radius(&studio, 0), first);
    for _ in 0..2 {
        say(&mut studio, r#"{"type":"redo"}"#).unwrap();
    }
    assert_eq!(radius(&studio, 0), 4.0);
    // The same gesture after an undo is a step of its own, and forgets what was undone
    undo(&mut studio);
    set_radius(&mut studio, 9.0, 2);
    assert!(studio.undone.is_empty() && studio.done.len() == 2);
    say(&mut studio, r#"{"type":"reset"}"#).unwrap();
    assert_eq!(radius(&studio, 0), first);
    undo(&mut studio);
    assert_eq!(radius(&studio, 0), 9.0);
}

#[test]
fn edits_concern_the_active_side() {
    let mut studio = studio();
    let first = radius(&studio, 0);
    assert!(say(&mut studio, r#"{"type":"side","side":"b"}"#).is_err());
    say(&mut studio, r#"{"type":"compare","on":true}"#).unwrap();
    say(&mut studio, r#"{"type":"side","side":"b"}"#).unwrap();
    set_radius(&mut studio, 5.0, 1);
    assert_eq!([0, 1].map(|side| radius(&studio, side)), [first, 5.0]);
    say(&mut studio, r#"{"type":"show","view":"flip"}"#).unwrap();
    say(&mut studio, r#"{"type":"swap"}"#).unwrap();
    assert_eq!([0, 1].map(|side| radius(&studio, side)), [5.0, first]);
    say(&mut studio, r#"{"type":"compare","on":false}"#).unwrap();
    let wanted = studio.wanted();
    assert!(wanted.looks[1].is_none() && wanted.active == Side::A && !wanted.shown.compares());
}

#[test]
fn wrong_edits_change_nothing_and_say_what_is_allowed() {
    let mut studio = studio();
    let before = studio.state(&[], "").message(None);
    for (text, words) in [
        (r#"{"type":"material","index":99,"set":{}}"#, "material 99 is not there"),
        (r#"{"type":"material","index":2,"set":{"subsurface_color":2}}"#, "must be in [0, 1]"),
        (r#"{"type":"material","index":2,"set":{"subsurface_colour":1}}"#, "it has no key subsurface_colour"),
        (r#"{"type":"material","index":2,"set":{"base_color":{"file":"/etc/passwd"}}}"#, "no further images"),
        (r#"{"type":"material","index":2,"set":{"geometry_normal":"/etc/passwd"}}"#, "no further images"),
        (r#"{"type":"material","index":2,"set":{"subsurface_table":"/etc/passwd"}}"#, "no further tables"),
        (r#"{"type":"film","set":{"size":[16384,16384]}}"#, "but a page shows at most"),
        (r#"{"type":"film","set":{"exposure":99}}"#, "must be in [-32, 32]"),
        (r#"{"type":"integrator","set":{"samples_per_pixel":0}}"#, "samples_per_pixel is 0"),
        (
            r#"{"type":"environment","environment":{"radiance":[1,1,1],"image":3,"rotation":0,"visible":true}}"#,
            "image",
        ),
        (
            r#"{"type":"light","index":0,"light":{"type":"sphere","center":[0,0,0],"radius":-1,"radiance":[1,1,1],"visible":true}}"#,
            "light 0: radius is -1, but must be in (0, 1e10]",
        ),
        (
            r#"{"type":"camera","camera":{"position":[0,0,0],"target":[0,0,0],"up":[0,1,0],"fov":40,"shift":[0,0],"lens_radius":0,"focus_distance":1}}"#,
            "target",
        ),
        (r#"{"type":"show","view":"everything"}"#, "must be one of radiance"),
    ] {
        let error = say(&mut studio, text).unwrap_err().to_string();
        assert!(error.contains(words), "{text}: {error}");
    }
    assert_eq!(studio.state(&[], "").message(None), before);
}

#[test]
fn name_from_a_preset_follows_it_if_it_is_free() {
    let mut scene = still_life(&LoadOptions::default()).unwrap();
    scene.materials[2] = Material::of_preset(preset("marble").unwrap(), scene.unit);
    scene.materials[3].name = "jade".into();
    let mut studio = Studio::new(&scene, None, false).unwrap();
    for (preset, name) in
        [("skin1", "skin1"), ("marble", "marble"), ("jade", "marble"), ("ketchup", "ketchup")]
    {
        let text = format!(r#"{{"type":"material","index":2,"set":{{"preset":"{preset}"}}}}"#);
        say(&mut studio, &text).unwrap();
        assert_eq!(studio.active_look().materials[2].name, name, "{preset}");
    }
    say(&mut studio, r#"{"type":"undo"}"#).unwrap();
    assert_eq!(studio.active_look().materials[2].name, "marble");
}

/// The camera and lights that were made for a mesh follow it, and those of a person stay; one step takes both back.
#[test]
fn turned_mesh_has_its_camera_and_lights_and_keeps_those_of_a_person() {
    let scene = still_life(&LoadOptions::default()).unwrap();
    let orientation = |up| Orientation { up, rotate: [0.0; 3] };
    let mut turned = scene.clone();
    turned.camera.position.y += 1.0;
    turned.lights.truncate(1);
    let mut studio = Studio::new(&scene, Some(orientation(UpAxis::Y)), false).unwrap();
    let base = Base::of(&turned, Some(orientation(UpAxis::Z)));
    studio.turn(base.clone(), None).unwrap();
    assert_eq!(studio.orientation(), Some(orientation(UpAxis::Z)));
    assert_eq!((*studio.camera(), &studio.active_look().lights), (turned.camera, &turned.lights));
    say(&mut studio, r#"{"type":"undo"}"#).unwrap();
    assert_eq!(studio.orientation(), Some(orientation(UpAxis::Y)));
    assert_eq!((*studio.camera(), &studio.active_look().lights), (scene.camera, &scene.lights));
    say(&mut studio, r#"{"type":"remove_light","index":0}"#).unwrap();
    let of_person = studio.active_look().lights.clone();
    studio.turn(base, None).unwrap();
    assert_eq!((*studio.camera(), &studio.active_look().lights), (turned.camera, &of_person));
    let materials = scene.materials.iter().chain(&scene.materials[..1]).cloned().collect();
    let other = Scene { materials, ..turned };
    assert!(studio.turn(Base::of(&other, Some(orientation(UpAxis::X))), None).is_err());
    assert_eq!(studio.orientation(), Some(orientation(UpAxis::Z)));
}

#[test]
fn exposure_is_metered_until_a_picture_or_a_person_decides() {
    let scene = still_life(&LoadOptions::default()).unwrap();
    let metered = || Studio::new(&scene, None, true).unwrap();
    let mut studio = metered();
    studio.meter(-0.5, 1, false);
    set_radius(&mut studio, 3.0, 1);
    studio.meter(-0.8, 64, true);
    assert!(studio.film().exposure == -0.8 && !studio.is_metering());
    // Steps before know it, too
    say(&mut studio, r#"{"type":"undo"}"#).unwrap();
    assert!(studio.film().exposure == -0.8 && !studio.is_metering());
    say(&mut studio, r#"{"type":"film","set":{"exposure":1}}"#).unwrap();
    say(&mut studio, r#"{"type":"reset"}"#).unwrap();
    assert!(studio.film().exposure == -0.8 && studio.is_metering());
    let mut chosen = metered();
    say(&mut chosen, r#"{"type":"film","set":{"exposure":1}}"#).unwrap();
    assert!(chosen.film().exposure == 1.0 && !chosen.is_metering());
}

#[test]
fn preset_keeps_the_name_of_a_person() {
    let mut studio = studio();
    let name = studio.active_look().materials[2].name.clone();
    say(&mut studio, r#"{"type":"material","index":2,"set":{"preset":"jade"}}"#).unwrap();
    let material = &studio.active_look().materials[2];
    assert_eq!(material.name, name);
    assert!(material.subsurface_color.texture.is_none() && !material.subsurface_color.vertex_color);
}

#[test]
fn images_of_pages_light_the_scene() {
    let mut studio = studio();
    let image = || Image {
        name: "sky.hdr".into(),
        path: None,
        width: 1,
        height: 1,
        color_space: translucid_scene::ColorSpace::Linear,
        pixels: Pixels::Float(vec![[1.0; 4]]),
    };
    studio.add_environment(image()).unwrap();
    assert_eq!(studio.active_look().environment.unwrap().image, Some(0));
    for _ in 1..MOST_IMAGES {
        studio.add_environment(image()).unwrap();
    }
    assert!(studio.add_environment(image()).is_err());
}

/// A page's messages, to be broken.
const MESSAGES: [&str; 10] = [
    r#"{"type":"material","index":3,"set":{"subsurface_radius":0.5,"subsurface_color":[0.5,0.4,0.3]},"gesture":1}"#,
    r#"{"type":"material","index":4,"set":{"preset":"jade","subsurface_model":"dipole"}}"#,
    r#"{"type":"light","index":0,"light":{"type":"sphere","center":[0,30,9],"radius":3,"radiance":[9,9,9],"visible":true}}"#,
    r#"{"type":"environment","environment":{"radiance":[1,1,1],"image":null,"rotation":30,"visible":false}}"#,
    r#"{"type":"integrator","set":{"samples_per_pixel":2,"subsurface_sharing":false,"seed":7}}"#,
    r#"{"type":"film","set":{"exposure":1.5,"tone_mapping":"agx","size":[24,16]}}"#,
    r#"{"type":"camera","camera":{"position":[0,20,70],"target":[0,9,0],"up":[0,1,0],"fov":40,"shift":[0,0],"lens_radius":0,"focus_distance":60}}"#,
    r#"{"type":"compare","on":true}"#,
    r#"{"type":"side","side":"b"}"#,
    r#"{"type":"undo"}"#,
];

/// More than 100,000 are read, most of them refused; whatever is not leaves a state that is valid.
#[test]
fn mutated_messages_are_refused_or_valid() {
    let mut scene = still_life(&LoadOptions::default()).unwrap();
    let mut studio = Studio::new(&scene, None, false).unwrap();
    let (mut read, mut applied) = (0, 0);
    for text in MESSAGES {
        for bytes in translucid_testing::mutants(text.as_bytes(), 10_500) {
            read += 1;
            let message = Numbered::parse(&String::from_utf8_lossy(&bytes)).message;
            if message.is_ok_and(|message| studio.apply(message).is_ok()) {
                applied += 1;
                scene.camera = *studio.camera();
                scene.film = studio.setup.film;
                let look = studio.active_look();
                scene.materials.clone_from(&look.materials);
                scene.lights.clone_from(&look.lights);
                scene.environment = look.environment;
                scene.integrator = look.integrator;
                let parts = [scene.camera.validate(), scene.film.validate(), scene.integrator.validate()];
                let materials = (0..scene.materials.len()).map(|i| scene.validate_material(i));
                let lights = (0..scene.lights.len()).map(|i| scene.validate_light(i));
                let all =
                    parts.into_iter().chain(materials).chain(lights).chain([scene.validate_environment()]);
                all.for_each(|result| result.unwrap());
            }
        }
    }
    assert!(read > 100_000 && applied > 100 && applied < read / 2, "{applied} of {read}");
    assert!(studio.done.len() <= MOST_STEPS);
}
