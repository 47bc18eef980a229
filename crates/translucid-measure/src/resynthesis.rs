//! The setup of an edge with the material that was measured, as a scene: its picture should be the photograph.

use std::f64::consts::PI;

use translucid_profile::Configuration;

use crate::edge_line::EdgeLine;
use crate::fit::{Card, Outline};
use crate::measurement::Measurement;
use crate::options::Setup;
use crate::remark::three_digits;
use crate::trace::Trace;

/// Longest edge of the pictures in pixels.
const LONGEST: usize = 200;

/// Samples per pixel: seconds.
const SAMPLES: u32 = 48;

/// The setup of an edge with the material that was measured.
///
/// Diffuse light through a diffuse surface counts by its cosine, whatever its direction, so that parallel light, of which a card
/// throws a sharp shadow, stands for it.
#[derive(Clone, Copy, Debug)]
pub struct Resynthesis<'a> {
    measurement: &'a Measurement,
    /// In the region.
    line: EdgeLine,
    card: Card,
    /// Where the card ends \[mm\].
    position: f64,
}

/// Pictures of the region of the same size and in the same numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct ResynthesizedPictures {
    /// Width and height.
    pub size: [usize; 2],
    /// The photograph.
    pub photographed: Vec<[f32; 3]>,
    /// The rendering.
    pub rendered: Vec<[f32; 3]>,
    /// The brightest light of the fit, of all channels.
    pub brightest: f64,
}

impl<'a> Resynthesis<'a> {
    /// The setup of a measurement; `None` of spots and slabs, and of media that no model renders as they are fitted.
    pub fn new(measurement: &'a Measurement) -> Option<Self> {
        let options = &measurement.options;
        let is_edge = options.setup == Setup::Edge && options.incidence.is_none();
        let is_diffuse = options.configuration != Some(Configuration::Searchlight);
        if !is_edge || options.eta != 1.0 || (options.g != 0.0 && !is_diffuse) {
            return None;
        }
        match (measurement.fit.outline, measurement.trace) {
            (Outline::Edge { card, position }, Trace::Line(line)) => {
                Some(Self { measurement, line, card, position })
            }
            _ => None,
        }
    }

    /// The scene file: x goes across the edge toward the light, which falls straight down; y is up.
    pub fn scene(&self) -> String {
        let [x0, y0, x1, y1] = self.measurement.region.map(|v| v as f64);
        let extent = self.measurement.mm_per_pixel * (x1 - x0).hypot(y1 - y0);
        [self.view(extent), self.piece(extent), self.screen(extent)].concat()
    }

    /// Camera, film and light.
    fn view(&self, extent: f64) -> String {
        let [x0, y0, x1, y1] = self.measurement.region.map(|v| v as f64);
        let (line, mm) = (self.line, self.measurement.mm_per_pixel);
        let [ax, ay] = line.across;
        let offset = [0.5 * (x1 - x0) - line.point[0], 0.5 * (y1 - y0) - line.point[1]].map(|v| mm * v);
        let [x, z] = [offset[0] * ax + offset[1] * ay - self.position, offset[1] * ax - offset[0] * ay];
        let [width, height] = self.size();
        format!(
            r#"# A piece with the material that was measured, half of it in the shadow of a card.
unit = "mm"

[camera]
projection = "orthographic"
position = [{x}, {extent}, {z}]
target = [{x}, 0, {z}]
up = [{}, 0, {}]
width = {}

[film]
size = [{width}, {height}]

[integrator]
samples_per_pixel = {SAMPLES}

[[light]]
type = "distant"
direction = [0, 1, 0]
irradiance = {PI}
"#,
            -ay,
            -ax,
            mm * (x1 - x0),
        )
    }

    /// The piece and its material.
    fn piece(&self, extent: f64) -> String {
        let Measurement { options, .. } = self.measurement;
        let [model, configuration] = match options.configuration {
            Some(Configuration::Searchlight) => ["exact", "searchlight"],
            _ => ["random-walk-diffuse", "diffuse"],
        };
        format!(
            r#"
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
"#,
            list(self.measurement.surface_albedos().map(|a| a.clamp(0.0, 0.9999))),
            list(self.measurement.mfps()),
            options.g,
            -2.0 * extent,
            w = 4.0 * extent,
        )
    }

    /// The card and its material.
    fn screen(&self, extent: f64) -> String {
        let albedos = self.measurement.surface_albedos();
        // A card that the camera does not see is above it
        let (height, colors) = match self.card {
            Card::Visible => {
                let strays = self.measurement.fit.channels.each_ref().map(|channel| channel.stray);
                (1e-3, std::array::from_fn(|c| (strays[c] * albedos[c]).clamp(0.0, 1.0)))
            }
            Card::Hidden => (2.0, [0.0; 3]),
        };
        format!(
            r#"
[[material]]
name = "card"
specular_weight = 0
base_color = [{}]

[[object]]
shape = "rectangle"
width = {w}
height = {w}
rotate = [-90, 0, 0]
translate = [{}, {}, 0]
material = "card"
"#,
            list(colors),
            -2.0 * extent,
            height * extent,
            w = 4.0 * extent,
        )
    }

    fn size(&self) -> [usize; 2] {
        let [x0, y0, x1, y1] = self.measurement.region;
        let step = (x1 - x0).max(y1 - y0).div_ceil(LONGEST).max(1);
        [(x1 - x0) / step, (y1 - y0) / step].map(|edge| edge.max(1))
    }

    /// The region of the photograph, and the rendered radiance of the [scene](Self::scene) in the same numbers.
    pub fn pictures(&self, radiance: &[f32]) -> ResynthesizedPictures {
        let light = &self.measurement.fit.light;
        ResynthesizedPictures {
            size: self.size(),
            photographed: self.photographed(),
            rendered: self.rendered(radiance),
            brightest: light.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max),
        }
    }

    fn photographed(&self) -> Vec<[f32; 3]> {
        let ([width, height], [x0, y0, x1, y1]) = (self.size(), self.measurement.region);
        let edges = |i: usize, n: usize, first: usize, end: usize| {
            let at = |i: usize| first + i * (end - first) / n;
            [at(i), at(i + 1)]
        };
        let pixel = |i: usize| {
            let [left, right] = edges(i % width, width, x0, x1);
            let [top, bottom] = edges(i / width, height, y0, y1);
            self.measurement.photo.part([left, top, right, bottom]).mean().map(|v| v as f32)
        };
        (0..width * height).map(pixel).collect()
    }

    fn rendered(&self, radiance: &[f32]) -> Vec<[f32; 3]> {
        let albedos = self.measurement.surface_albedos().map(|albedo| albedo.max(1e-6));
        let channels = &self.measurement.fit.channels;
        // Stray light lies on everything that is seen beside a hidden card
        let strays = channels.each_ref().map(|channel| match self.card {
            Card::Hidden => channel.stray,
            Card::Visible => 0.0,
        });
        // Without a white card the photograph is as bright as it is
        let mean = self.measurement.photo.part(self.measurement.region).mean();
        let gain: [f64; 3] = std::array::from_fn(|c| {
            let light: f64 = radiance.chunks_exact(3).map(|pixel| f64::from(pixel[c])).sum();
            let share = light / (radiance.len() / 3) as f64 / albedos[c];
            channels[c].surface_albedo.map_or(mean[c] / (strays[c] + share), |albedo| albedo.value)
        });
        let value = |pixel: &[f32], c: usize| {
            let reflectance = f64::from(pixel[c]) / albedos[c];
            (strays[c] * gain[c] + gain[c] * reflectance) as f32
        };
        radiance.chunks_exact(3).map(|pixel| std::array::from_fn(|c| value(pixel, c))).collect()
    }
}

fn list(values: [f64; 3]) -> String {
    values.map(three_digits).join(", ")
}
