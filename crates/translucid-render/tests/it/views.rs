//! Regions and fractions of a picture.

use std::sync::atomic::AtomicBool;

use glam::{Affine3A, Vec2, Vec3};
use translucid_profile::Model;
use translucid_render::{FilmLayer, FilmSums, Fraction, Goal, LiveFilm, PreparedScene, View};
use translucid_scene::{
    Camera, ColorInput, Film, FilterKind, Integrator, Light, Material, Projection, ScalarInput, Scene,
    SubsurfaceModel,
};

use crate::common::{distant, scene, sphere, uniform_environment};

/// A ball of wax whose light is shared by pixels of a block.
fn ball(sharing: bool) -> Scene {
    let wax = Material {
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(Vec3::new(0.9, 0.6, 0.3)),
        subsurface_radius: ScalarInput::constant(0.5),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique),
        ..Material::default()
    };
    let mut scene = scene(vec![sphere(1.0, 24)], wax);
    (scene.film.width, scene.film.height) = (71, 45);
    scene.camera.position = Vec3::new(0.0, 0.0, 4.0);
    scene.environment = uniform_environment(Vec3::splat(0.3));
    scene.lights = vec![distant(Vec3::ONE)];
    scene.integrator = Integrator { max_depth: 4, subsurface_sharing: sharing, ..Integrator::default() };
    scene
}

fn rendered(prepared: &PreparedScene, view: &View, samples: u32) -> FilmSums {
    let region = view.region();
    let film = LiveFilm::new(FilmSums::new(region.width, region.height));
    prepared.render(
        view,
        &film,
        &Goal { samples: 0..samples, deadline: None },
        &|_| {},
        &AtomicBool::new(false),
    );
    film.into_sums()
}

#[test]
fn region_has_the_pixels_of_the_whole_picture() {
    for sharing in [true, false] {
        let prepared = PreparedScene::new(ball(sharing)).expect("a valid scene");
        let view = prepared.view().expect("a valid view");
        let whole = rendered(&prepared, &view, 3);
        for [x0, y0, x1, y1] in [[0, 0, 71, 45], [20, 11, 53, 30], [31, 22, 32, 23], [55, 40, 71, 45]] {
            let region = view.with_region([x0, y0, x1, y1]).expect("a region of the film");
            let part = rendered(&prepared, &region, 3);
            for (x, y) in region.region().pixels() {
                assert_eq!(part.mean(x - x0, y - y0), whole.mean(x, y), "{sharing} {x} {y}");
            }
        }
    }
}

#[test]
fn region_beyond_the_film_is_refused() {
    let view = PreparedScene::new(ball(true)).expect("a valid scene").view().expect("a valid view");
    for region in [[0, 0, 0, 1], [3, 3, 3, 9], [0, 0, 72, 45], [0, 0, 71, 46], [5, 5, 4, 9]] {
        let error = view.with_region(region).expect_err("not a region").to_string();
        assert!(error.contains("71") && error.contains("45"), "{error}");
    }
}

/// A fraction shows the same picture: means over the same squares agree, up to the change at the edges of pixels.
#[test]
fn fraction_shows_the_same_picture() {
    let prepared = PreparedScene::new(ball(true)).expect("a valid scene");
    let view = prepared.view().expect("a valid view");
    let whole = rendered(&prepared, &view, 4);
    for fraction in [Fraction::Half, Fraction::Quarter, Fraction::Eighth] {
        let n = fraction.divisor();
        let small = rendered(&prepared, &view.at(fraction), 16);
        assert_eq!([small.width, small.height], [71_u32.div_ceil(n), 45_u32.div_ceil(n)]);
        let mut difference = 0.0;
        let (columns, rows) = (71 / n, 45 / n);
        for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
            let square = (0..n * n).map(|i| whole.radiance(x * n + i % n, y * n + i / n)[0]).sum::<f64>();
            difference += (square / f64::from(n * n) - small.radiance(x, y)[0]).abs();
        }
        let mean = difference / f64::from(columns * rows);
        assert!(mean < 0.05, "{fraction:?}: {mean}");
    }
    assert_eq!(view.at(Fraction::Half).at(Fraction::Whole).region(), view.region());
}

#[test]
fn live_film_gives_layers_and_says_what_has_changed() {
    let prepared = PreparedScene::new(ball(true)).expect("a valid scene");
    let view = prepared.view().expect("a valid view");
    let film = LiveFilm::new(FilmSums::new(71, 45));
    assert!(film.tiles_changed_since(0).is_empty());
    let goal = |samples| Goal { samples: 0..samples, deadline: None };
    prepared.render(&view, &film, &goal(1), &|_| {}, &AtomicBool::new(false));
    let first = film.changes();
    let area: u64 = film.tiles_changed_since(0).iter().map(|tile| tile.area()).sum();
    assert_eq!(area, 71 * 45);
    assert!(film.tiles_changed_since(first).is_empty());
    prepared.render(&view, &film, &goal(2), &|_| {}, &AtomicBool::new(false));
    assert!(film.changes() > first && !film.tiles_changed_since(first).is_empty());
    for layer in FilmLayer::ALL {
        let pixels = film.layer(layer);
        assert_eq!(pixels.len(), 71 * 45 * layer.channels(), "{layer:?}");
        assert!(pixels.iter().all(|value| value.is_finite()), "{layer:?}");
    }
    let radiance = film.layer(FilmLayer::Radiance);
    let expected = film.sums().radiance(40, 20).map(|value| value as f32);
    assert_eq!(radiance[(20 * 71 + 40) * 3..][..3], expected);
}

#[test]
fn lamps_are_seen_where_their_middles_project() {
    // Small enough that the middle of its picture is the picture of its middle, to 0.01 pixels. Sums over pixels give the middle
    // only behind a smooth filter. Four standard deviations are 0.04 pixels
    const RADIUS: f32 = 0.06;
    let size = [96.0, 64.0];
    let film =
        Film { width: 96, height: 64, filter: FilterKind::Gaussian, filter_radius: 1.5, ..Film::default() };
    for projection in
        [Projection::Perspective { horizontal_fov: 30.0 }, Projection::Orthographic { width: 2.5 }]
    {
        let camera = Camera {
            position: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            projection,
            shift: Vec2::new(0.25, -0.125),
            ..Camera::default()
        };
        for center in [Vec3::new(0.3, 0.2, 0.0), Vec3::new(-0.4, -0.9, -1.0), Vec3::new(0.9, -0.5, 1.0)] {
            let mut scene = scene(vec![sphere(0.5, 8)], Material::default());
            // Nothing but the lamp is in the picture
            scene.objects[0].world_from_local = Affine3A::from_translation(Vec3::Z * 50.0);
            (scene.camera, scene.film) = (camera, film);
            scene.lights = vec![Light::Sphere { center, radius: RADIUS, radiance: Vec3::ONE, visible: true }];
            let width = match projection {
                Projection::Perspective { .. } => 2.0 * f64::from(5.0 - center.z) * 15f64.to_radians().tan(),
                Projection::Orthographic { .. } => 2.5,
            };
            let expected = [
                size[0] * (0.5 + f64::from(center.x) / width - 0.25),
                0.5 * size[1] - size[0] * (f64::from(center.y) / width + 0.125),
            ];
            // Eight pixels to each side, where the whole lamp is if it is where it should be
            let [x0, y0] = expected.map(|at| (at as u32).saturating_sub(8));
            let [x1, y1] = [(x0 + 17).min(96), (y0 + 17).min(64)];
            let prepared = PreparedScene::new(scene).expect("a valid scene");
            let view = prepared.view().and_then(|view| view.with_region([x0, y0, x1, y1]));
            let picture = rendered(&prepared, &view.expect("a valid view"), 1024);
            let (mut sum, mut at) = (0.0, [0.0; 2]);
            for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
                let light = picture.mean(x - x0, y - y0)[9];
                sum += light;
                at = [at[0] + light * (f64::from(x) + 0.5), at[1] + light * (f64::from(y) + 0.5)];
            }
            let off = (at[0] / sum - expected[0]).hypot(at[1] / sum - expected[1]);
            assert!(off < 0.05, "{projection:?}, {center}: {off} pixels off {expected:?}");
        }
    }
}
