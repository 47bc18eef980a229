//! Light of one wave number k in layers, direction by direction.
//!
//! Light that varies as e^{ikx} along the layers obeys, for the direction (θ, φ) with φ from x,
//!
//! ```text
//! ±μ dI/dz = −(σ_t + i k sin θ cos φ) I + S,     S = σ_s ∫ p I dΩ
//! ```
//!
//! Rays of all layers are those of the totals, by p = η sin θ; radiances are over η². As I at π − φ is conjugate to I at φ,
//! its orders I_m = (1/π) ∫ I cos mφ dφ are real for even m and imaginary for odd m, and a quarter of the circle does.
//! The unknown is S at all depths, directions and orders, as S↓ ± S↑; a sweep along all rays, whose reflections between
//! faces are summed up, makes light of it, and the phase function's Legendre moments S of light.

use std::f64::consts::{FRAC_PI_2, PI};

use fearless_simd::{Level, Simd};
use num_complex::Complex64;
use translucid_profile::quadrature::gauss_legendre;

use super::super::matrix::Matrix;
use super::super::operators::{face, normalized};
use super::super::rays::Rays;
use super::super::{Ground, Layer, Layers};
use super::chain::{Exits, Pass, beam, etas, reflect, straight};
use super::depths::{ends_to, in_unit};
use super::panel::{Panel, PanelRule};
use crate::walk::instruction_sets::dispatched;

/// How finely light is resolved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resolution {
    /// Rays between two indices.
    pub(super) rays: usize,
    /// Moments of phase functions.
    pub(super) moments: usize,
    /// Orders of the azimuth.
    pub(super) orders: usize,
    /// Azimuths in a quarter of the circle.
    pub(super) azimuths: usize,
    /// Nodes of a panel of depths.
    pub(super) nodes: usize,
    /// Norm of what is left over that of the first sources, at which a solution is one.
    pub(super) enough: f64,
}

/// Layers under a beam, for one wave number.
pub(super) struct Stack {
    rays: Rays,
    orders: usize,
    azimuths: Azimuths,
    pub(super) sheets: Vec<Sheet>,
    /// Reflectances of faces by ray, from above the first layer on.
    faces: Vec<Vec<f64>>,
    /// Number of unknowns; the last is light from the ground.
    pub(super) size: usize,
    /// Part of the arriving flux, in radiance, that a Lambertian ground returns.
    returned: f64,
    /// Beam that arrives at the ground.
    beam_below: f64,
    pub(super) k: f64,
}

/// One layer.
pub(super) struct Sheet {
    pub(super) layer: Layer,
    /// σ_s and σ_t, without the peak that counts as not scattered.
    pub(super) scattering: f64,
    pub(super) extinction: f64,
    /// Number of rays, with their cosines and weights dμ.
    pub(super) cosines: Vec<f64>,
    pub(super) weights: Vec<f64>,
    /// Depths in the layer with their weights.
    pub(super) depths: Vec<[f64; 2]>,
    /// Index of the distinct panel for each panel.
    panels: Vec<usize>,
    /// By ray, then azimuth.
    streams: Vec<Stream>,
    /// σ_s h w by order and parity, row by row; empty where it is 0.
    kernels: Vec<[Vec<f64>; 2]>,
    /// First unknown.
    pub(super) first: usize,
    /// Flux of the beam down at the upper face and up at the lower one.
    pub(super) beam: [f64; 2],
    /// σ_s (2l + 1) χ_l, without the peak.
    pub(super) factors: Vec<f64>,
    /// Mean cosine of the phase function that scatters.
    pub(super) g: f64,
}

/// One direction in a layer.
struct Stream {
    through: Complex64,
    /// Part of light from the upper face that gets to each depth.
    reached: Parts,
    /// Distinct panels.
    panels: Vec<Panel>,
}

/// Real and imaginary parts.
type Parts = [Vec<f64>; 2];

/// Rule of azimuths.
struct Azimuths {
    weights: Vec<f64>,
    cosines: Vec<f64>,
    /// cos mφ by azimuth, then order.
    harmonics: Vec<f64>,
}

/// What a sweep makes of sources.
pub(super) struct Swept {
    /// Light in all layers, as the sources are ordered.
    pub(super) light: Vec<f64>,
    /// Flux that leaves above, and that arrives at the face below.
    pub(super) exits: [f64; 2],
}

/// Ends of panels from a face, in the length on which light varies there.
const PANELS: [f64; 5] = [0.03, 0.2, 0.7, 1.7, 3.6];
/// Growth of panels farther in.
const GROWTH: f64 = 1.8;
/// Depth in an endless layer, by the beam's and by the light's own decay, in which nothing returns from.
const DEEPEST: [f64; 2] = [14.0, 10.0];

impl Stack {
    pub(super) fn new(layers: &Layers, unit: f64, k: f64, resolution: &Resolution) -> Self {
        let rays = Rays::new(layers, resolution.rays, None);
        let scattering = layers.layers().iter().filter(|layer| layer.scattering > 0.0);
        let least = scattering.map(|layer| layer.extinction() * unit).fold(1.0, f64::min);
        let azimuths = Azimuths::new(resolution.azimuths, resolution.orders, k / least);
        let rule = PanelRule::new(resolution.nodes);
        let mut first = 0;
        let mut sheets = Vec::new();
        for layer in layers.layers() {
            let layer = in_unit(layer, unit);
            let mut sheet = Sheet::new(layer, &rays, &azimuths, &rule, k, resolution);
            sheet.first = first;
            first += 2 * resolution.orders * sheet.block();
            sheets.push(sheet);
        }
        let most = sheets.iter().map(|sheet| sheet.cosines.len()).max().unwrap_or(0);
        let mut faces = vec![Vec::new(); most];
        for pair in etas(layers).windows(2) {
            let common = face(&rays, pair[0], pair[1]);
            for (ray, faces) in faces.iter_mut().enumerate() {
                faces.push(common.get(ray).copied().unwrap_or(1.0));
            }
        }
        // A ground without an index has an open face
        faces.iter_mut().for_each(|faces| faces.resize(sheets.len() + 1, 0.0));
        let depths = sheets.iter().map(|sheet| sheet.extinction * sheet.layer.thickness);
        let (beams, beam_below) = beam(layers, depths);
        sheets.iter_mut().zip(beams).for_each(|(sheet, beam)| sheet.beam = beam);
        let last = sheets.last().map_or(0, |sheet| sheet.cosines.len());
        let returned = match layers.ground() {
            Ground::Lambertian { reflectance } => {
                let whole: f64 = (0..last).map(|ray| rays.root(ray) * rays.root(ray)).sum();
                reflectance / (PI * whole)
            }
            _ => 0.0,
        };
        let orders = resolution.orders;
        Self { rays, orders, azimuths, sheets, faces, size: first + 1, returned, beam_below, k }
    }

    /// Sources of light that the beam scatters first, and that a ground returns of it.
    pub(super) fn first_sources(&self) -> Vec<f64> {
        let mut sources = vec![0.0; self.size];
        for sheet in &self.sheets {
            let [down, up] = sheet.beam_kernels();
            let nodes = sheet.depths.len();
            let square = sheet.layer.eta * sheet.layer.eta;
            for ray in 0..sheet.cosines.len() {
                for (node, [z, _]) in sheet.depths.iter().enumerate() {
                    let falling = sheet.beam[0] * libm::exp(-sheet.extinction * z);
                    let rest = sheet.layer.thickness - z;
                    let rising = if rest.is_finite() {
                        sheet.beam[1] * libm::exp(-sheet.extinction * rest)
                    } else {
                        0.0
                    };
                    let into =
                        [falling * down[ray] + rising * up[ray], falling * up[ray] + rising * down[ray]];
                    let place = sheet.first + ray * nodes + node;
                    sources[place] = (into[0] + into[1]) / square;
                    sources[place + self.orders * sheet.block()] = (into[0] - into[1]) / square;
                }
            }
        }
        sources[self.size - 1] = self.returned * self.beam_below;
        sources
    }

    /// Light of sources.
    pub(super) fn sweep(&self, sources: &[f64]) -> Swept {
        // The same products and sums, and so the same bits, with vectors of any width
        dispatched!(Level::new(), simd => self.sweep_by(simd, sources), narrow => self.sweep_by(simd, sources))
    }

    #[inline(always)]
    fn sweep_by<S: Simd>(&self, simd: S, sources: &[f64]) -> Swept {
        let mut swept = Swept { light: vec![0.0; self.size], exits: [0.0; 2] };
        let ground = sources[self.size - 1];
        let azimuths = self.azimuths.weights.len();
        for (ray, faces) in self.faces.iter().enumerate() {
            let mut fields = self.fields(simd, ray, sources);
            for azimuth in 0..azimuths {
                let mut passes: Vec<Pass> = fields.iter().map(|field| field.passes[azimuth]).collect();
                let exits = reflect(faces, &mut passes, Complex64::ZERO, ground.into());
                self.add_exits(ray, azimuth, exits, &mut swept.exits);
                for (field, pass) in fields.iter_mut().zip(passes) {
                    field.passes[azimuth] = pass;
                }
            }
            for (sheet, field) in self.sheets.iter().zip(&mut fields) {
                if !sheet.depths.is_empty() && ray < sheet.cosines.len() {
                    field.add_incoming(sheet, ray);
                    self.add_orders(sheet, ray, field, &mut swept.light);
                }
            }
        }
        swept
    }

    /// Flux of sources that leaves above, and arrives below, without a reflection.
    pub(super) fn straight(&self, sources: &[f64]) -> [f64; 2] {
        dispatched!(Level::new(), simd => self.straight_by(simd, sources), narrow => self.straight_by(simd, sources))
    }

    #[inline(always)]
    fn straight_by<S: Simd>(&self, simd: S, sources: &[f64]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (ray, faces) in self.faces.iter().enumerate() {
            let fields = self.fields(simd, ray, sources);
            for azimuth in 0..self.azimuths.weights.len() {
                let passes: Vec<Pass> = fields.iter().map(|field| field.passes[azimuth]).collect();
                self.add_exits(ray, azimuth, straight(faces, &passes), &mut sums);
            }
        }
        sums
    }

    /// Part of diffuse light that the first face reflects, and the last one or the ground.
    pub(super) fn reflectances(&self) -> [f64; 2] {
        let of_face = |sheet: &Sheet, face: usize| {
            let rays = 0..sheet.cosines.len();
            let weight = |ray: usize| self.rays.root(ray) * self.rays.root(ray);
            let whole: f64 = rays.clone().map(weight).sum();
            rays.map(|ray| weight(ray) * self.faces[ray][face]).sum::<f64>() / whole
        };
        let (first, last) = (&self.sheets[0], &self.sheets[self.sheets.len() - 1]);
        let whole: f64 = (0..last.cosines.len()).map(|ray| self.rays.root(ray) * self.rays.root(ray)).sum();
        let ground = self.returned * PI * whole;
        [of_face(first, 0), of_face(last, self.sheets.len()).max(ground)]
    }

    fn add_exits(&self, ray: usize, azimuth: usize, exits: Exits, sums: &mut [f64; 2]) {
        // ½ d(p²) dφ over four quarters
        let weight = 2.0 * self.rays.root(ray) * self.rays.root(ray) * self.azimuths.weights[azimuth];
        let below = 1.0 - self.faces[ray][self.sheets.len()];
        sums[0] += weight * exits[0].re;
        sums[1] += weight * below * exits[1].re;
    }

    /// Light of a ray from sources in each layer, without what comes in.
    #[inline(always)]
    fn fields<S: Simd>(&self, simd: S, ray: usize, sources: &[f64]) -> Vec<Field> {
        let mut fields = Vec::with_capacity(self.sheets.len());
        for sheet in &self.sheets {
            fields.push(self.field(simd, sheet, ray, sources));
        }
        fields
    }

    #[inline(always)]
    fn field<S: Simd>(&self, simd: S, sheet: &Sheet, ray: usize, sources: &[f64]) -> Field {
        let (azimuths, nodes) = (self.azimuths.weights.len(), sheet.depths.len());
        let mut field = Field {
            light: [0, 1].map(|_| [0, 1].map(|_| vec![0.0; azimuths * nodes])),
            passes: vec![Pass::default(); azimuths],
        };
        if ray >= sheet.cosines.len() {
            return field;
        }
        let [mut parities, mut ways] = [0, 1].map(|_| [0, 1].map(|_| [0, 1].map(|_| vec![0.0; nodes])));
        for azimuth in 0..azimuths {
            let stream = &sheet.streams[ray * azimuths + azimuth];
            let pass = &mut field.passes[azimuth];
            pass.through = stream.through;
            if nodes == 0 {
                continue;
            }
            let harmonics = &self.azimuths.harmonics[azimuth * self.orders..][..self.orders];
            for (parity, parts) in parities.iter_mut().enumerate() {
                parts.iter_mut().for_each(|part| part.fill(0.0));
                for (order, harmonic) in harmonics.iter().enumerate() {
                    let factor = if order == 0 { 0.5 } else { *harmonic };
                    let row = &sources[sheet.place(self.orders, parity, order, ray)..][..nodes];
                    for (sum, s) in parts[order % 2].iter_mut().zip(row) {
                        *sum += factor * s;
                    }
                }
            }
            let [up, down] = &mut ways;
            for part in 0..2 {
                let both = parities[0][part].iter().zip(&parities[1][part]);
                for ((a, b), (down, up)) in both.zip(down[part].iter_mut().zip(up[part].iter_mut().rev())) {
                    (*down, *up) = (a + b, a - b);
                }
            }
            for (way, light) in field.light.iter_mut().enumerate() {
                let light = light.each_mut().map(|part| &mut part[azimuth * nodes..][..nodes]);
                pass.leaving[way] = sheet.stream(simd, stream, &ways[way], light, way == 0);
            }
        }
        field
    }

    /// Adds the orders of a ray's light.
    #[inline(always)]
    fn add_orders(&self, sheet: &Sheet, ray: usize, field: &Field, light: &mut [f64]) {
        let nodes = sheet.depths.len();
        let mut parities = [0, 1].map(|_| [0, 1].map(|_| vec![0.0; nodes]));
        for (azimuth, weight) in self.azimuths.weights.iter().enumerate() {
            let harmonics = &self.azimuths.harmonics[azimuth * self.orders..][..self.orders];
            let [sums, differences] = &mut parities;
            for part in 0..2 {
                let [up, down] =
                    field.light.each_ref().map(|way| way[part][azimuth * nodes..][..nodes].iter());
                let both = sums[part].iter_mut().zip(&mut differences[part]);
                for ((sum, difference), (down, up)) in both.zip(down.zip(up.rev())) {
                    (*sum, *difference) = (down + up, down - up);
                }
            }
            for (parity, parts) in parities.iter().enumerate() {
                for (order, harmonic) in harmonics.iter().enumerate() {
                    let factor = weight * harmonic * (2.0 / PI);
                    let row = &mut light[sheet.place(self.orders, parity, order, ray)..][..nodes];
                    for (sum, x) in row.iter_mut().zip(&parts[order % 2]) {
                        *sum += factor * x;
                    }
                }
            }
        }
    }

    /// Sources of light that light makes by being scattered once more.
    pub(super) fn scatter(&self, swept: &Swept) -> Vec<f64> {
        dispatched!(Level::new(), _simd => self.scatter_in_lanes(swept), narrow => self.scatter_in_lanes(swept))
    }

    #[inline(always)]
    fn scatter_in_lanes(&self, swept: &Swept) -> Vec<f64> {
        let mut sources = vec![0.0; self.size];
        for sheet in &self.sheets {
            let (block, nodes) = (sheet.block(), sheet.depths.len());
            for (order, kernels) in sheet.kernels.iter().enumerate() {
                for (parity, kernel) in kernels.iter().enumerate().filter(|(_, kernel)| !kernel.is_empty()) {
                    let place = sheet.place(self.orders, parity, order, 0);
                    let light = &swept.light[place..][..block];
                    let target = &mut sources[place..][..block];
                    for (row, kernel) in
                        target.chunks_exact_mut(nodes).zip(kernel.chunks_exact(sheet.cosines.len()))
                    {
                        for (factor, light) in kernel.iter().zip(light.chunks_exact(nodes)) {
                            for (sum, x) in row.iter_mut().zip(light) {
                                *sum += factor * x;
                            }
                        }
                    }
                }
            }
        }
        // Flux that arrives below, for which a ground's face counts as open
        sources[self.size - 1] = self.returned * swept.exits[1];
        sources
    }
}

/// Light of one ray in one layer.
struct Field {
    /// Up, from the lower face on, and down, by azimuth, then depth.
    light: [Parts; 2],
    passes: Vec<Pass>,
}

impl Field {
    #[inline(always)]
    fn add_incoming(&mut self, sheet: &Sheet, ray: usize) {
        let nodes = sheet.depths.len();
        for (azimuth, pass) in self.passes.iter().enumerate() {
            let stream = &sheet.streams[ray * self.passes.len() + azimuth];
            let [down, up] = pass.incoming;
            let [reached_re, reached_im] = &stream.reached;
            for ([light_re, light_im], incoming) in self.light.iter_mut().zip([up, down]) {
                let light = light_re[azimuth * nodes..][..nodes].iter_mut();
                let reached = reached_re.iter().zip(reached_im);
                for ((re, im), (a, b)) in light.zip(&mut light_im[azimuth * nodes..][..nodes]).zip(reached) {
                    *re += incoming.re * a - incoming.im * b;
                    *im += incoming.re * b + incoming.im * a;
                }
            }
        }
    }
}

impl Sheet {
    fn new(
        layer: Layer,
        rays: &Rays,
        azimuths: &Azimuths,
        rule: &PanelRule,
        k: f64,
        resolution: &Resolution,
    ) -> Self {
        let count = rays.count(layer.eta);
        let cosines: Vec<f64> = (0..count).map(|ray| rays.cosine(ray, layer.eta)).collect();
        let weights: Vec<f64> = (0..count).map(|ray| rays.cosine_weight(ray, layer.eta)).collect();
        let moments = resolution.moments;
        let peak = layer.phase_function.moment(moments);
        let scattering = layer.scattering * (1.0 - peak);
        let extinction = without_peak(&layer, moments);
        let ends = if scattering > 0.0 { panel_ends(&layer, extinction, k) } else { Vec::new() };
        let mut depths = Vec::new();
        let (mut panels, mut widths) = (Vec::new(), Vec::<f64>::new());
        for panel in ends.windows(2) {
            let width = panel[1] - panel[0];
            depths.extend(
                rule.nodes
                    .iter()
                    .map(|(x, weight)| [panel[0] + 0.5 * width * (1.0 + x), 0.5 * width * weight]),
            );
            let known = widths.iter().position(|known| (known / width - 1.0).abs() < 1e-9);
            panels.push(known.unwrap_or(widths.len()));
            if known.is_none() {
                widths.push(width);
            }
        }
        let mut streams = Vec::new();
        for mu in &cosines {
            let sine = (1.0 - mu * mu).max(0.0).sqrt();
            for cosine in &azimuths.cosines {
                let sigma = Complex64::new(extinction, k * sine * cosine);
                let distinct: Vec<Panel> =
                    widths.iter().map(|width| rule.panel(*width, sigma, *mu)).collect();
                let mut reached = [0, 1].map(|_| Vec::with_capacity(depths.len()));
                let mut through = Complex64::ONE;
                for panel in &panels {
                    let [re, im] = &distinct[*panel].passed;
                    let passed = |node: usize| through * Complex64::new(re[node], im[node]);
                    reached[0].extend((0..rule.nodes.len()).map(|node| passed(node).re));
                    reached[1].extend((0..rule.nodes.len()).map(|node| passed(node).im));
                    through = passed(rule.nodes.len());
                }
                if layer.thickness.is_infinite() {
                    through = Complex64::ZERO;
                } else if panels.is_empty() {
                    through = crate::exact::complex::exp(-sigma * (layer.thickness / mu));
                }
                streams.push(Stream { through, reached, panels: distinct });
            }
        }
        let factors: Vec<f64> = (0..moments)
            .map(|l| scattering * (2 * l + 1) as f64 * (layer.phase_function.moment(l) - peak) / (1.0 - peak))
            .collect();
        let g = if moments > 1 { (layer.phase_function.moment(1) - peak) / (1.0 - peak) } else { 0.0 };
        let kernels = if scattering > 0.0 {
            kernels(&factors, &cosines, &weights, resolution.orders)
        } else {
            Vec::new()
        };
        Self {
            factors,
            layer,
            scattering,
            extinction,
            cosines,
            weights,
            depths,
            panels,
            streams,
            kernels,
            first: 0,
            beam: [0.0; 2],
            g,
        }
    }

    /// Nodes of a panel.
    fn per_panel(&self) -> usize {
        self.depths.len() / self.panels.len().max(1)
    }

    /// Unknowns of one order and parity.
    pub(super) fn block(&self) -> usize {
        self.cosines.len() * self.depths.len()
    }

    /// Place of the depths of a ray.
    pub(super) fn place(&self, orders: usize, parity: usize, order: usize, ray: usize) -> usize {
        self.first + ((parity * orders + order) * self.cosines.len() + ray) * self.depths.len()
    }

    /// σ_s p for light of the beam that is scattered to the beam's own side and to the other, by ray.
    fn beam_kernels(&self) -> [Vec<f64>; 2] {
        let sides = [1.0, -1.0].map(|side| -> Vec<f64> {
            let radiance = |mu: &f64| {
                let values = associated_legendre(side * mu, 0, self.factors.len());
                values.iter().zip(&self.factors).map(|(a, b)| a * b).sum::<f64>() / (4.0 * PI)
            };
            self.cosines.iter().map(radiance).collect()
        });
        let both = sides.iter().flat_map(|side| side.iter().zip(&self.weights));
        let sum: f64 = both.map(|(value, weight)| 2.0 * PI * value * weight).sum();
        let scale = if sum > 0.0 { self.scattering / sum } else { 0.0 };
        sides.map(|side| side.iter().map(|value| value * scale).collect())
    }

    /// Light at all depths in the direction of a stream; returns what leaves.
    #[inline(always)]
    fn stream<S: Simd>(
        &self,
        simd: S,
        stream: &Stream,
        sources: &Parts,
        [light_re, light_im]: [&mut [f64]; 2],
        is_reversed: bool,
    ) -> Complex64 {
        let per_panel = self.per_panel();
        let count = self.panels.len();
        let mut arriving = Complex64::ZERO;
        for i in 0..count {
            let number = self.panels[if is_reversed { count - 1 - i } else { i }];
            let place = i * per_panel..(i + 1) * per_panel;
            let sources = sources.each_ref().map(|part| &part[place.clone()]);
            let [re, im] = stream.panels[number].light(simd, arriving, sources);
            light_re[place.clone()].copy_from_slice(&re[..per_panel]);
            light_im[place].copy_from_slice(&im[..per_panel]);
            arriving = Complex64::new(re[per_panel], im[per_panel]);
        }
        arriving
    }
}

impl Azimuths {
    /// Nodes that lie as densely around φ = π/2 as 1/(1 + i k cos φ) needs it.
    fn new(count: usize, orders: usize, k: f64) -> Self {
        let bend = libm::asinh(k).clamp(1e-3, MOST_BEND);
        let (mut weights, mut cosines, mut harmonics) = (Vec::new(), Vec::new(), Vec::new());
        for (x, weight) in gauss_legendre(count) {
            let u = 0.5 * (1.0 + x);
            let scale = FRAC_PI_2 / libm::sinh(bend);
            let psi = scale * libm::sinh(bend * u);
            weights.push(0.5 * weight * scale * bend * libm::cosh(bend * u));
            cosines.push(libm::sin(psi));
            harmonics.extend((0..orders).map(|m| libm::cos(m as f64 * (FRAC_PI_2 - psi))));
        }
        Self { weights, cosines, harmonics }
    }
}

/// Greatest concentration of azimuths.
const MOST_BEND: f64 = 4.0;

/// Extinction coefficient of a layer whose moments beyond the first so many are a peak that counts as not scattered
/// (W. J. Wiscombe 1977, *The delta-M method*).
pub(super) fn without_peak(layer: &Layer, moments: usize) -> f64 {
    layer.absorption + layer.scattering * (1.0 - layer.phase_function.moment(moments))
}

/// Ends of panels from face to face.
fn panel_ends(layer: &Layer, extinction: f64, k: f64) -> Vec<f64> {
    let scale = (1.0 / libm::hypot(extinction, k)).min(layer.thickness);
    let is_endless = layer.thickness.is_infinite();
    let middle = if is_endless {
        let transport = layer.extinction() - layer.scattering * layer.phase_function.moment(1);
        let decay = libm::hypot((3.0 * layer.absorption * transport).sqrt(), k).min(extinction);
        (DEEPEST[0] / extinction).max(DEEPEST[1] / decay)
    } else {
        0.5 * layer.thickness
    };
    ends_to(middle, layer.thickness, PANELS.map(|end| end * scale), |_| GROWTH)
}

/// σ_s h w by order and parity.
fn kernels(factors: &[f64], cosines: &[f64], weights: &[f64], orders: usize) -> Vec<[Vec<f64>; 2]> {
    let count = cosines.len();
    let kernel = |order: usize| {
        let polynomials: Vec<Vec<f64>> =
            cosines.iter().map(|mu| associated_legendre(*mu, order, factors.len())).collect();
        [0, 1].map(|parity| {
            let first = order + parity;
            if factors.iter().skip(first).step_by(2).all(|factor| *factor == 0.0) {
                return Vec::new();
            }
            let element = |i: usize, j: usize| -> f64 {
                let moments = (first..factors.len()).step_by(2);
                moments.map(|l| factors[l] * polynomials[i][l - order] * polynomials[j][l - order]).sum()
            };
            let mut matrix = Matrix::from_fn(count, element);
            if first == 0 {
                let scattering = factors[0];
                let unit = Matrix::from_fn(count, |i, j| matrix.at(i, j) / scattering);
                let unit = normalized(&unit, weights);
                matrix = Matrix::from_fn(count, |i, j| unit.at(i, j) * scattering);
            }
            (0..count * count).map(|i| matrix.at(i / count, i % count) * weights[i % count]).collect()
        })
    };
    (0..orders).map(kernel).collect()
}

/// √((l − m)!/(l + m)!) P_lm of a cosine, from l = m to below `count`.
pub(super) fn associated_legendre(mu: f64, order: usize, count: usize) -> Vec<f64> {
    let sine = (1.0 - mu * mu).max(0.0).sqrt();
    let m = order as f64;
    let mut now: f64 = (1..=order).map(|j| sine * ((2 * j - 1) as f64 / (2 * j) as f64).sqrt()).product();
    let mut before = 0.0;
    let mut values = Vec::new();
    for l in order..count {
        values.push(now);
        let l = l as f64;
        let next = ((2.0 * l + 1.0) * mu * now - (l * l - m * m).sqrt() * before)
            / ((l + 1.0) * (l + 1.0) - m * m).sqrt();
        (before, now) = (now, next);
    }
    values
}
