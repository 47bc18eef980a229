//! Environment maps against quadratures of their texels.

use super::*;

#[test]
fn environment_map_irradiance_is_that_of_quadrature() {
    // The second has nine pixels to the cell of the table, the third is one pixel.
    let normals = [Vec3::X, Vec3::NEG_X, Vec3::new(0.48, 0.6, 0.64)];
    for (width, height) in [(64, 32), (2050, 1030), (1, 1)] {
        let lights = light_set(Vec::new(), Vec::new(), Some(sunny(width, height)));
        let arriving = directions(800).fold([0.0; 3], |sums: [f64; 3], (d, solid_angle)| {
            let radiance = lights.environment_radiance(d).x;
            std::array::from_fn(|i| sums[i] + solid_angle * f64::from(radiance * d.dot(normals[i]).max(0.0)))
        });
        for (normal, expected) in normals.into_iter().zip(arriving) {
            let (mean, error) = irradiance(&lights, Vec3::ZERO, normal, normal, 40_000);
            // The edge of the sun costs the quadrature up to 3e-3.
            let allowed = 4.0 * error + 3e-3 * expected;
            assert!((mean - expected).abs() < allowed, "{width} {normal}: {mean} ± {error}, {expected}");
            assert!(error < 0.02 * expected, "{width} {normal}: {mean} ± {error}");
        }
    }
}

#[test]
fn environment_map_shows_its_middle_along_minus_z_and_its_top_along_y() {
    let (mut environment, images) = image_sky(8, 4, |x, y| Vec3::new(x as f32, y as f32, 0.0));
    environment.world_from_environment = Mat3::IDENTITY;
    let lights = light_set(Vec::new(), Vec::new(), Some((environment, images.clone())));
    let close = |direction: Vec3, x: f32, y: f32| {
        let color = lights.environment_radiance(direction.normalize());
        assert!(color.distance(Vec3::new(x, y, 0.0)) < 1e-4, "{direction}: {color}");
    };
    // Halfway between pixels 3 and 4 in azimuth, rows 1 and 2 in elevation; then a quarter turn to the right.
    close(Vec3::NEG_Z, 3.5, 1.5);
    close(Vec3::X, 5.5, 1.5);
    close(Vec3::NEG_X, 1.5, 1.5);
    close(Vec3::Z, 3.5, 1.5); // The seam: the mean of pixels 7 and 0.
    assert!(lights.environment_radiance(Vec3::Y).y < 1e-4);
    assert!((lights.environment_radiance(Vec3::NEG_Y).y - 3.0).abs() < 1e-4);
    // A rotation takes environment directions to world directions.
    environment.world_from_environment = Mat3::from_cols(Vec3::Y, Vec3::Z, Vec3::X);
    let turned = light_set(Vec::new(), Vec::new(), Some((environment, images)));
    assert!((turned.environment_radiance(Vec3::Y).x - 5.5).abs() < 1e-4);
}

/// Red light of a color beyond Rec. 709 is negative: its irradiance is π L, as of any constant sky.
#[test]
fn environment_map_keeps_negative_channels() {
    let color = Vec3::new(-0.17, 0.88, 0.12);
    let lights = light_set(Vec::new(), Vec::new(), Some(image_sky(8, 4, |_, _| color)));
    assert!(lights.environment_radiance(Vec3::Y).abs_diff_eq(color, 1e-6));
    let (mean, error) = irradiance(&lights, Vec3::ZERO, Vec3::X, Vec3::X, 40_000);
    assert!((mean + 0.17 * f64::from(PI)).abs() < 4.0 * error, "{mean} ± {error}");
}

#[test]
fn environment_map_can_be_sampled_wherever_it_shines() {
    let sky = image_sky(16, 8, |x, y| if (x, y) == (0, 3) { RADIANCE } else { Vec3::ZERO });
    let lights = light_set(Vec::new(), Vec::new(), Some(sky));
    let shining = directions(150).filter(|&(d, _)| lights.environment_radiance(d).x > 1e-5);
    let mut count = 0;
    for (direction, _) in shining {
        assert!(lights.environment_pdf(Vec3::ZERO, Vec3::ZERO, direction) > 0.0, "{direction}");
        count += 1;
    }
    assert!(count > 100);
}

/// A surface that faces up draws hardly anything below its horizon of a sky that is brightest there, and what is above with
/// its cosine: the irradiance has a fourth of the standard error that drawing by radiance alone would leave it.
#[test]
fn environment_map_is_drawn_with_the_cosine() {
    let (mut sky, images) = image_sky(128, 64, |_, y| Vec3::splat(if y < 32 { 1.0 } else { 4.0 }));
    sky.world_from_environment = Mat3::IDENTITY;
    let lights = light_set(Vec::new(), Vec::new(), Some((sky, images)));
    for normal in [Vec3::Y, Vec3::new(0.36, 0.8, 0.48)] {
        let samples = (0..4096).filter_map(|i| {
            let u = sobol_burley::sample_4d(i, 0, 1);
            lights.sample(Vec3::ZERO, normal, u[0], [u[1], u[2]])
        });
        let below = samples.filter(|sample| sample.direction.dot(normal) <= 0.0).count();
        assert!(below < 400, "{normal}: {below} of 4096 below the horizon");
        let (mean, error) = irradiance(&lights, Vec3::ZERO, normal, normal, 4096);
        assert!(error * 64.0 < 0.5 * mean, "{normal}: {mean} ± {error}");
    }
}

/// The density integrates to one over the sphere for any normal, or to the share of light that the surface can have.
#[test]
fn environment_map_density_integrates_to_one() {
    for (width, height) in [(64, 32), (300, 150), (7, 3), (1, 1)] {
        let lights = light_set(Vec::new(), Vec::new(), Some(sunny(width, height)));
        for normal in [Vec3::ZERO, Vec3::X, Vec3::new(-0.48, 0.6, 0.64)] {
            let density = |(d, solid_angle): (Vec3, f64)| {
                solid_angle * f64::from(lights.environment_pdf(Vec3::ZERO, normal, d))
            };
            let sum: f64 = directions(400).map(density).sum();
            assert!((sum - 1.0).abs() < 0.01, "{width} {normal}: {sum}");
        }
    }
}
