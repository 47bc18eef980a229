//! The setup of an edge with the material that was measured, as a scene and as its picture.

use std::path::Path;

use translucid_image::{CodedPicture, ToneMapping, display_from_linear};
use translucid_laboratory::Plate;
use translucid_load::{LoadOptions, SceneFile};
use translucid_measure::{Card, EdgeLine};
use translucid_profile::Configuration;
use translucid_render::{FilmLayer, Outcome, Plan, PreparedScene, Session, View};

use super::report::three_digits;
use super::shown::Shown;
use crate::failure::Failure;
use crate::interrupt;

/// Name of the scene's file.
pub(super) const SCENE: &str = "setup.toml";
/// Names of the pictures: what the camera saw, and what the renderer makes of the setup.
const PICTURES: [&str; 2] = ["region.png", "setup.png"];
/// Longest edge of the pictures.
const LONGEST: usize = 200;
/// Samples per pixel: seconds.
const SAMPLES: u32 = 48;

/// What the scene says beside the fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setup {
    /// In the region.
    pub(super) line: EdgeLine,
    pub(super) card: Card,
    /// Where the card ends \[mm\].
    pub(super) position: f64,
    pub(super) mm_per_pixel: f64,
    pub(super) surface_albedos: [f64; 3],
    pub(super) configuration: Configuration,
    pub(super) eta: f64,
    pub(super) g: f64,
}

impl Setup {
    /// The scene: x goes across the edge toward the light, which falls straight down; y is up.
    ///
    /// Diffuse light through a diffuse surface counts by its cosine, whatever its direction, so that parallel light, of which
    /// a card throws a sharp shadow, stands for it. `None` of media that no model renders as they are fitted.
    pub(super) fn scene(&self, shown: &Shown<'_>) -> Option<String> {
        let is_diffuse = self.configuration == Configuration::Diffuse;
        if self.eta != 1.0 || (self.g != 0.0 && !is_diffuse) {
            return None;
        }
        let [x0, y0, x1, y1] = shown.region.map(|v| v as f64);
        let size = self.size(shown);
        let (line, mm) = (self.line, self.mm_per_pixel);
        let [ax, ay] = line.across;
        let offset = [0.5 * (x1 - x0) - line.point[0], 0.5 * (y1 - y0) - line.point[1]].map(|v| mm * v);
        let [x, z] = [offset[0] * ax + offset[1] * ay - self.position, offset[1] * ax - offset[0] * ay];
        let extent = mm * (x1 - x0).hypot(y1 - y0);
        // A card that the camera does not see is above it
        let card = if self.card == Card::Visible { 1e-3 } else { 2.0 } * extent;
        let list = |values: [f64; 3]| values.map(three_digits).join(", ");
        let channels = &shown.fit.channels;
        let mfps = channels.each_ref().map(|channel| if channel.is_seen { channel.mfp.value } else { 0.0 });
        let dark: [f64; 3] = std::array::from_fn(|c| match self.card {
            Card::Visible => (channels[c].stray * self.surface_albedos[c]).clamp(0.0, 1.0),
            Card::Hidden => 0.0,
        });
        let [model, configuration] =
            if is_diffuse { ["random-walk-diffuse", "diffuse"] } else { ["exact", "searchlight"] };
        Some(format!(
            r#"# A piece with the material that was measured, half of it in the shadow of a card.
unit = "mm"

[camera]
projection = "orthographic"
position = [{x}, {extent}, {z}]
target = [{x}, 0, {z}]
up = [{}, 0, {}]
width = {}

[film]
size = [{}, {}]

[integrator]
samples_per_pixel = {SAMPLES}

[[light]]
type = "distant"
direction = [0, 1, 0]
irradiance = {}

[[material]]
name = "piece"
specular_weight = 0
subsurface_weight = 1
subsurface_color = [{}]
subsurface_radius = 1
subsurface_radius_scale = [{}]
subsurface_scatter_anisotropy = {}
subsurface_model = "{model}"
subsurface_configuration = "{configuration}"

[[object]]
shape = "box"
width = {w}
height = {w}
depth = {w}
translate = [0, {}, 0]
material = "piece"

[[material]]
name = "card"
specular_weight = 0
base_color = [{}]

[[object]]
shape = "rectangle"
width = {w}
height = {w}
rotate = [-90, 0, 0]
translate = [{}, {card}, 0]
material = "card"
"#,
            -ay,
            -ax,
            mm * (x1 - x0),
            size[0],
            size[1],
            std::f64::consts::PI,
            list(self.surface_albedos.map(|a| a.clamp(0.0, 0.9999))),
            list(mfps),
            self.g,
            -2.0 * extent,
            list(dark),
            -2.0 * extent,
            w = 4.0 * extent,
        ))
    }

    fn size(&self, shown: &Shown<'_>) -> [usize; 2] {
        let [x0, y0, x1, y1] = shown.region;
        let step = (x1 - x0).max(y1 - y0).div_ceil(LONGEST).max(1);
        [(x1 - x0) / step, (y1 - y0) / step].map(|edge| edge.max(1))
    }

    /// The region of the photograph, and the scene's picture in the same numbers.
    pub(super) fn plates(&self, scene: &str, shown: &Shown<'_>) -> Result<Option<[Plate; 2]>, Failure> {
        let mut scene = SceneFile::parse(scene, Path::new(SCENE))
            .and_then(|file| file.load(&LoadOptions::default(), &mut Vec::new()))?;
        scene.integrator.seed = 1;
        let view = View::new(scene.camera, scene.film, 1)?;
        let mut session = Session::new(PreparedScene::new(scene)?, view);
        if session.run(&Plan::samples(SAMPLES), &|_: &_| (), &interrupt::STOP)? != Outcome::Finished {
            return Ok(None);
        }
        let size = self.size(shown);
        let brightest: [f64; 3] = std::array::from_fn(|c| {
            shown.fit.light.iter().map(|light| light[c]).fold(f64::MIN_POSITIVE, f64::max)
        });
        let most = brightest.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        // Stray light lies on all of what is seen beside a hidden card
        let [stray, gain]: [[f64; 3]; 2] = {
            let stray = shown.fit.channels.each_ref().map(|channel| match self.card {
                Card::Hidden => channel.stray,
                Card::Visible => 0.0,
            });
            // Without a white card the photograph is as bright as it is
            let mean = shown.photo.part(shown.region).mean();
            let layer = session.film().layer(FilmLayer::Radiance);
            let gain: [f64; 3] = std::array::from_fn(|c| {
                let light: f64 = layer.chunks_exact(3).map(|pixel| f64::from(pixel[c])).sum();
                let share = light / (size[0] * size[1]) as f64 / self.surface_albedos[c].max(1e-6);
                let measured = shown.fit.channels[c].surface_albedo;
                measured.map_or(mean[c] / (stray[c] + share), |albedo| albedo.value)
            });
            [std::array::from_fn(|c| stray[c] * gain[c]), gain]
        };
        let rendered: Vec<[f32; 3]> = session
            .film()
            .layer(FilmLayer::Radiance)
            .chunks_exact(3)
            .map(|pixel| {
                std::array::from_fn(|c| {
                    let reflectance = f64::from(pixel[c]) / self.surface_albedos[c].max(1e-6);
                    (stray[c] + gain[c] * reflectance) as f32
                })
            })
            .collect();
        let [x0, y0, x1, y1] = shown.region;
        let seen = (0..size[0] * size[1]).map(|i| {
            let edges = |i: usize, n: usize, first: usize, end: usize| {
                let at = |i: usize| first + i * (end - first) / n;
                [at(i), at(i + 1)]
            };
            let [left, right] = edges(i % size[0], size[0], x0, x1);
            let [top, bottom] = edges(i / size[0], size[1], y0, y1);
            shown.photo.part([left, top, right, bottom]).mean().map(|v| v as f32)
        });
        let plate = |file: &str, alternative: &str, caption: &str, pixels: &[[f32; 3]]| {
            let codes: Vec<u8> = pixels
                .iter()
                .flat_map(|pixel| {
                    // Darker than white by a stop, or noise would be clipped
                    display_from_linear(ToneMapping::Srgb, pixel.map(|v| 0.5 * v.max(0.0) / most as f32))
                        .map(|v| (255.0 * v).round() as u8)
                })
                .collect();
            let png = CodedPicture::rgb(size, &codes).encode();
            let png = png.map_err(|error| Failure::work(format!("cannot draw a picture: {error}")))?;
            let [file, alternative, caption] = [file, alternative, caption].map(String::from);
            Ok::<Plate, Failure>(Plate { file, alternative, caption, size, png })
        };
        Ok(Some([
            plate(PICTURES[0], "The region of the photograph", "The photograph.", &seen.collect::<Vec<_>>())?,
            plate(
                PICTURES[1],
                "A rendering of the setup with the material that was measured",
                "The same setup with the measured material, rendered (setup.toml): without the camera's blur, and in even light.",
                &rendered,
            )?,
        ]))
    }
}
