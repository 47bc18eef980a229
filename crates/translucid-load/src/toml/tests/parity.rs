//! Whatever a scene file is refused for, a scene made in code is refused for, too, and the other way round.

use glam::Vec3;
use translucid_broken_scenes::scene_of_everything;
use translucid_scene::{Light, Material, PARAMETERS, Projection, Scene, Slot};

use super::{BALL, parse};

/// Values as files write them.
const VALUES: [&str; 17] = [
    "nan", "inf", "-inf", "-1", "0", "1", "0.5", "2", "4.5", "100", "179.5", "180", "1e7", "1e10", "3e10",
    "1e20", "1e-30",
];

/// Checks that a piece of a scene file and a change of a scene are accepted or refused together.
fn check(piece: &str, value: f32, change: &dyn Fn(&mut Scene, f32)) {
    let in_file = parse(&format!("unit = \"mm\"\n{BALL}{piece}\n"));
    let mut scene = scene_of_everything();
    change(&mut scene, value);
    let in_code = scene.validate();
    assert_eq!(in_file.is_ok(), in_code.is_ok(), "{piece}\n{:?}\n{in_code:?}", in_file.err());
}

fn check_all(piece: &str, change: &dyn Fn(&mut Scene, f32)) {
    for text in VALUES {
        check(&piece.replace('?', text), text.parse().expect("a number"), change);
    }
}

#[test]
fn materials_have_the_same_ranges_in_files_and_in_code() {
    for parameter in PARAMETERS {
        let piece = format!("[[material]]\nname = \"m\"\n{} = ?", parameter.name);
        check_all(&piece, &|scene, value| {
            let mut material = Material::default();
            match parameter.slot(&mut material) {
                Slot::Number(number) => *number = value,
                Slot::Scalar(input) => input.factor = value,
                Slot::Color(input) => input.factor = Vec3::splat(value),
            }
            scene.materials[2] = material;
        });
    }
}

#[test]
fn settings_have_the_same_ranges_in_files_and_in_code() {
    let camera = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n";
    check_all(&format!("{camera}fov = ?"), &|scene, x| {
        scene.camera.projection = Projection::Perspective { horizontal_fov: x };
    });
    check_all(&format!("{camera}projection = \"orthographic\"\nwidth = ?"), &|scene, x| {
        scene.camera.projection = Projection::Orthographic { width: x };
    });
    check_all(&format!("{camera}shift = [?, 0]"), &|scene, x| scene.camera.shift.x = x);
    check_all(&format!("{camera}lens_radius = ?"), &|scene, x| scene.camera.lens_radius = x);
    check_all(&format!("{camera}focus_distance = ?"), &|scene, x| scene.camera.focus_distance = x);
    check_all(&format!("{camera}up = [?, 0, 0]"), &|scene, x| scene.camera.up = Vec3::X * x);
    let moved = "[camera]\nposition = [0, 0, 5]\ntarget = [?, 0, 5]";
    check_all(moved, &|scene, x| scene.camera.target = Vec3::new(x, 0.0, 5.0));
    check_all("[film]\nfilter_radius = ?", &|scene, x| scene.film.filter_radius = x);
    check_all("[film]\nexposure = ?", &|scene, x| scene.film.exposure = x);
    check_all("[integrator]\nsubsurface_tail = ?", &|scene, x| scene.integrator.subsurface_tail = x);
    check_all("[integrator]\npoint_tolerance = ?", &|scene, x| scene.integrator.point_tolerance = x);
}

type Setter = fn(&mut Scene, u32);

#[test]
fn counts_have_the_same_ranges_in_files_and_in_code() {
    let counts: [(&str, Setter); 6] = [
        ("[film]\nsize = [?, 1]", |scene, n| scene.film.width = n),
        ("[film]\nsize = [1, ?]", |scene, n| scene.film.height = n),
        ("[integrator]\nsamples_per_pixel = ?", |scene, n| scene.integrator.samples_per_pixel = n),
        ("[integrator]\nmax_depth = ?", |scene, n| scene.integrator.max_depth = n),
        ("[integrator]\nmax_diffuse_depth = ?", |scene, n| scene.integrator.max_diffuse_depth = n),
        ("[integrator]\npoint_memory = ?", |scene, n| scene.integrator.point_memory = n),
    ];
    for (piece, set) in counts {
        for n in [0, 1, 1024, 1025, 16_384, 16_385, 1 << 20, (1 << 20) + 1, 1 << 24, (1 << 24) + 1, u32::MAX]
        {
            check(&piece.replace('?', &n.to_string()), 0.0, &|scene, _| set(scene, n));
        }
    }
}

#[test]
fn lights_have_the_same_ranges_in_files_and_in_code() {
    let light = |kind: &str, rest: &str| format!("[[light]]\ntype = \"{kind}\"\n{rest}");
    let one = Vec3::ONE;
    let center = Vec3::ZERO;
    let sphere = |center, radius, radiance| Light::Sphere { center, radius, radiance, visible: true };
    check_all(&light("sphere", "center = [?, 0, 0]\nradius = 1\nradiance = 1"), &|scene, x| {
        scene.lights[0] = sphere(Vec3::X * x, 1.0, one);
    });
    check_all(&light("sphere", "center = [0, 0, 0]\nradius = ?\nradiance = 1"), &|scene, x| {
        scene.lights[0] = sphere(center, x, one);
    });
    check_all(&light("sphere", "center = [0, 0, 0]\nradius = 1\nradiance = ?"), &|scene, x| {
        scene.lights[0] = sphere(center, 1.0, one * x);
    });
    let rectangle = "center = [0, 0, 0]\ndirection = [0, 0, 1]\nsize = [?, 1]\nradiance = 1";
    // A negative edge only turns a rectangle that is made in code.
    for text in VALUES.into_iter().filter(|text| !text.starts_with('-')) {
        let size = text.parse().expect("a number");
        check(&light("rectangle", &rectangle.replace('?', text)), size, &|scene, x| {
            let (edge_x, edge_y) = (Vec3::X * x, Vec3::Y);
            scene.lights[0] = Light::Rectangle { center, edge_x, edge_y, radiance: one, visible: true };
        });
    }
    check_all(&light("distant", "direction = [0, 1, 0]\nangular_radius = ?\nirradiance = 1"), &|scene, x| {
        scene.lights[0] = Light::Distant { direction: Vec3::Y, angular_radius: x, irradiance: one };
    });
    let spot = |inner_angle, outer_angle| Light::Spot {
        radius: 0.0,
        visible: true,
        position: center,
        direction: Vec3::Y,
        intensity: one,
        inner_angle,
        outer_angle,
    };
    let piece = "position = [0, 0, 0]\ndirection = [0, 1, 0]\nintensity = 1\n";
    check_all(&light("spot", &format!("{piece}outer_angle = ?\ninner_angle = 0")), &|scene, x| {
        scene.lights[0] = spot(0.0, x);
    });
    check_all(&light("spot", &format!("{piece}inner_angle = ?")), &|scene, x| {
        scene.lights[0] = spot(x, 45.0);
    });
    check_all(
        &light("beam", "origin = [0, 0, 0]\ndirection = [0, 1, 0]\nradius = ?\npower = 1"),
        &|scene, x| {
            scene.lights[0] = Light::Beam { origin: center, direction: Vec3::Y, radius: x, power: one };
        },
    );
    check_all("[environment]\nradiance = ?", &|scene, x| {
        scene.environment = Some(translucid_scene::Environment { radiance: one * x, ..Default::default() });
    });
}
