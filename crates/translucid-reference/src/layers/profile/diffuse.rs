//! Light that layers return around a point that diffuse light falls on, for pictures.
//!
//! Light that arrives from all directions alike at one point is, before its first collision at the depth z and the optical
//! depth τ, by Legendre moment l and order m of the azimuth
//!
//! ```text
//! Ψ_lm(z) = ∫₀¹ (1 − F) e^{−τ/μ} J_m(k z tan θ) P_lm(μ) dμ
//! ```
//!
//! and the same is the share of a source's light that leaves without another collision, as light and detector may be
//! interchanged. So the light that leaves is a sum over Ψ and the moments of all light in the layers, of which discrete
//! directions give only what has collided: their errors count twice over, as a product.

use std::f64::consts::PI;

use rayon::prelude::*;
use translucid_profile::quadrature::gauss_legendre;
use translucid_profile::{ParameterError, ProfileRow, fresnel_from_outside, require};

use super::super::{Ground, Layer, Layers, LayersError};
use super::diffusion::Diffusion;
use super::hankel::Hankel;
use super::poles::Poles;
use super::remainder::solve;
use super::stack::{Resolution, Sheet, Stack, associated_legendre};
use crate::{Incidence, specular_reflectance};

/// Profile R(r) of the light that returns around a point that diffuse light falls on, as [`Layers::diffuse_profile`]
/// solves it.
///
/// One unit of flux enters at the point: what the first face reflects is no part of it.
#[derive(Clone, Debug)]
pub struct DiffuseProfile {
    /// Length in which the solution counts \[L\].
    unit: f64,
    /// Factor and decay of the part near the point, e^{−br}/(2πr).
    near: [f64; 2],
    far: Hankel,
    /// The exact total over that of `near` and `far`.
    scale: f64,
    total: f64,
    /// Radius from which on there is nothing to be known \[unit\].
    farthest: f64,
}

/// Points of a panel of depths, and of poles in ln κ and wave numbers in ln k the steps.
const NODES: usize = 4;
const POLE_STEP: f64 = 0.9;
const STEP: f64 = 0.4;
/// Numbers of moments, of which the first does that leaves a peak so small.
const MOMENTS: [usize; 7] = [2, 4, 6, 8, 12, 16, 24];
const SMALL_PEAK: f64 = 0.07;
/// Wave numbers, by the least transport coefficient, the slowest decay and the greatest extinction coefficient.
const LEAST: [f64; 2] = [0.001, 0.05];
const MOST: f64 = 40.0;
/// A wave number at which the total is reached, by the least one.
const NONE: f64 = 0.01;
/// Poles, by the least and the greatest wave number.
const POLES: [f64; 2] = [0.3, 1.0];
/// Decay of the part near the point, by the extinction coefficient of the first layer that scatters.
const NEAR_DECAY: f64 = 2.0;
/// Norm of what is left of the equations over that of the first sources, at which a solution is one.
const ENOUGH: f64 = 1e-5;
/// Greatest difference of the solution's total from the exact one, as a part of it.
const MOST_DOUBT: f64 = 0.01;

impl Layers {
    /// Solves for the profile of light that arrives from all directions alike at a point, for pictures.
    ///
    /// One rule of few directions gives it, in some 10 to 300 ms of one core. Its total is that of
    /// [`totals`](Self::totals). The light within any radius is exact to 0.4 % of the total, to 1 % where nothing absorbs.
    /// R(r) of isotropic scatterers is exact to 0.6 % from 0.01 to 3 mean free paths, and to 2.5 % at 0.001; with g it is less
    /// exact near the point, where hardly any light is.
    ///
    /// ```
    /// use translucid_reference::layers::{Ground, Layer, Layers};
    ///
    /// let epidermis = Layer::new(40.0, 8.0, 0.01).with_g(0.7);
    /// let dermis = Layer::new(10.0, 0.1, f64::INFINITY);
    /// let profile = Layers::new(1.0, vec![epidermis, dermis], Ground::None)?.diffuse_profile()?;
    /// assert!(profile.total() < 0.8 && profile.reflectance(0.1) > profile.reflectance(0.2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The last layer is not endless, the layers have several indices of refraction or one below that above them, no layer
    /// scatters, or there are more than 10 that do, of extinction coefficients that differ by more than a factor of 1000 or
    /// |g| above 0.93. The solution's total is refused where it is off by more than 1 %.
    pub fn diffuse_profile(&self) -> Result<DiffuseProfile, LayersError> {
        let (eta, entered) = self.check_for_pictures()?;
        let totals = self.totals(Incidence::Cosine).map_err(of_all)?;
        let total = totals.diffuse_reflectance / entered;

        // Solve for all wave numbers
        let scattering = || self.layers.iter().filter(|layer| layer.scattering > 0.0);
        let unit = 1.0 / scattering().map(Layer::extinction).fold(0.0, f64::max);
        let k0 = self.slowest_decay(unit);
        let transport =
            |layer: &Layer| unit * (layer.extinction() - layer.scattering * layer.phase_function.moment(1));
        let low = (LEAST[0] * scattering().map(transport).fold(1.0, f64::min)).max(LEAST[1] * k0);
        let span = libm::log(MOST / low);
        let count = (span / STEP).ceil() as usize + 1;
        let k = |i: usize| low * libm::exp(span * i as f64 / (count - 1) as f64);
        let peak = |moments: usize| -> f64 {
            scattering().map(|layer| layer.phase_function.moment(moments).abs()).fold(0.0, f64::max)
        };
        let [.., most] = MOMENTS;
        let moments = MOMENTS.into_iter().find(|moments| peak(*moments) < SMALL_PEAK).unwrap_or(most);
        let value = |i: usize| [k(i), returned(self, unit, k(i), &resolution(moments, k(i)), eta) / entered];
        let values: Vec<[f64; 2]> = (0..count).into_par_iter().map(value).collect();

        // Take away what makes R grow like 1/r, and find the rest by poles
        let [last, light] = values[count - 1];
        let first = scattering().next().map_or(1.0, |layer| unit * layer.extinction());
        let near = [last * light, NEAR_DECAY * first];
        let rest = [[NONE * low, total]].into_iter().chain(values).map(|[k, value]| {
            let beside = near_transform(near, k);
            [k, value - beside, beside]
        });
        let samples: Vec<[f64; 3]> = rest.collect();
        let poles = Poles::new(&samples, k0, [POLES[0] * low, POLES[1] * MOST], POLE_STEP);
        let plain: Vec<[f64; 2]> = samples[1..].iter().map(|[k, value, _]| [*k, *value]).collect();
        let bend =
            plain.iter().find(|[_, value]| value.abs() < 0.5 * plain[0][1].abs()).map_or(1.0, |[k, _]| *k);
        let far = Hankel::new(poles, &plain, bend);
        let solved = near_transform(near, NONE * low) + far.transform(NONE * low);
        let off = (solved / total - 1.0).abs();
        let allowed = "at most 0.01: these layers are too far apart for a profile";
        // What is not a number is no profile
        if off > MOST_DOUBT || off.is_nan() {
            return Err(of_all(ParameterError::new("error of the profile's total", off, allowed)));
        }
        Ok(DiffuseProfile { unit, near, far, scale: total / solved, total, farthest: 10.0 / low })
    }

    /// Relative index of refraction, and the part of diffuse light that enters.
    fn check_for_pictures(&self) -> Result<(f64, f64), LayersError> {
        let refuse = |parameter, value, allowed| Err(of_all(ParameterError::new(parameter, value, allowed)));
        if self.ground != Ground::None {
            let thickness: f64 = self.layers.iter().map(|layer| layer.thickness).sum();
            return refuse("thickness of all layers", thickness, "infinite for a profile of diffuse light");
        }
        let eta = self.layers[0].eta;
        if let Some(other) = self.layers.iter().find(|layer| layer.eta != eta) {
            return refuse("eta", other.eta, "that of the first layer for a profile of diffuse light");
        }
        let eta = eta / self.eta_above;
        if eta < 1.0 {
            return refuse("eta over eta_above", eta, "at least 1 for a profile of diffuse light");
        }
        if self.layers.iter().all(|layer| layer.scattering == 0.0) {
            return refuse("scattering", 0.0, "greater than 0 in one layer for a profile");
        }
        self.check_for_directions()?;
        Ok((eta, 1.0 - specular_reflectance(Incidence::Cosine, eta)))
    }
}

fn of_all(error: ParameterError) -> LayersError {
    LayersError { layer: None, error }
}

/// Resolution for a wave number in mean free paths.
fn resolution(moments: usize, k: f64) -> Resolution {
    let growth = libm::log1p(k);
    let orders = ((2.0 + 6.0 * k.min(10.0)) as usize).min(moments).min(16);
    Resolution {
        rays: (moments / 2).max(4) + growth as usize,
        moments,
        orders,
        azimuths: (2.0 + 0.6 * orders as f64 + 1.5 * growth) as usize,
        nodes: NODES,
        enough: ENOUGH,
    }
}

fn near_transform([factor, decay]: [f64; 2], k: f64) -> f64 {
    factor / libm::hypot(k, decay)
}

/// Radii of a row in a factor of ten, and the first one in mean free paths of the densest layer.
const PER_DECADE: f64 = 12.0;
const FIRST_RADIUS: f64 = 1e-3;
/// Part of the light that has to be within the last radius.
const KNOWN: f64 = 0.98;
/// Number of last radii over which r R falls.
const FALLING: usize = 4;
/// Part of the light that may be beyond the last radius of a row.
const BEYOND_ROW: f64 = 1e-4;

impl DiffuseProfile {
    /// Part of the light that enters which returns.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Light R(r) that leaves per area at the distance r > 0 \[L⁻²\]; it grows like 1/r.
    pub fn reflectance(&self, r: f64) -> f64 {
        (self.eval(r / self.unit) / (self.unit * self.unit)).clamp(0.0, f64::MAX)
    }

    /// The profile as a row of a table, with its total as the surface albedo: radii \[L\] up to where a ten-thousandth of the
    /// light is left or is not known, with the light within each.
    ///
    /// # Errors
    /// More than a fiftieth of the light is beyond.
    pub fn row(&self) -> Result<ProfileRow, LayersError> {
        let step = libm::log(10.0) / PER_DECADE;
        let mut row = ProfileRow { surface_albedo: Some(self.total.min(1.0)), ..ProfileRow::default() };
        let mut r = FIRST_RADIUS;
        let [factor, decay] = self.near;
        let near = -factor / decay * libm::expm1(-decay * r);
        let mut value = self.eval(r);
        let mut within = self.scale * near + PI * r * r * (value - self.scale * self.eval_near(r)).max(0.0);
        while r < self.farthest && value > 0.0 && within < self.total {
            row.radii.push(r * self.unit);
            row.reflectances.push(value / (self.unit * self.unit));
            row.enclosed.push(within);
            if within > (1.0 - BEYOND_ROW) * self.total {
                break;
            }
            // ∫ 2πr² R d ln r by Simpson's rule
            let [middle, end] = [0.5, 1.0].map(|part| r * libm::exp(part * step));
            let [inside, next] = [middle, end].map(|r| self.eval(r).max(0.0));
            if next >= value && within > KNOWN * self.total {
                // What grows again far away is rounding
                break;
            }
            let light = r * r * value + 4.0 * middle * middle * inside + end * end * next;
            within += 2.0 * PI * step / 6.0 * light;
            (r, value) = (end, next);
        }
        // A table goes on as the last radii fall
        let falls = |row: &ProfileRow| {
            let lines: Vec<f64> =
                row.radii.iter().zip(&row.reflectances).map(|(r, value)| r * value).collect();
            lines.iter().rev().take(FALLING).is_sorted_by(|a, b| a < b)
        };
        while !row.radii.is_empty() && !falls(&row) {
            row.radii.pop();
            row.reflectances.pop();
            row.enclosed.pop();
        }
        let known = row.enclosed.last().map_or(0.0, |within| within / self.total);
        let allowed = "at least 0.98: so much is lost in rounding";
        require(known >= KNOWN, "part of the light at radii that are known", known, allowed)
            .map_err(of_all)?;
        Ok(row)
    }

    fn eval_near(&self, r: f64) -> f64 {
        let [factor, decay] = self.near;
        factor * libm::exp(-decay * r) / (2.0 * PI * r)
    }

    fn eval(&self, r: f64) -> f64 {
        self.scale * (self.eval_near(r) + self.far.eval(r))
    }
}

/// Part of diffuse flux of a wave number that leaves above, per unit that arrives.
fn returned(layers: &Layers, unit: f64, k: f64, resolution: &Resolution, eta: f64) -> f64 {
    let stack = Stack::new(layers, unit, k, resolution);
    let light = Uncollided::of(&stack, eta, resolution);
    let first = light.first_sources(&stack);
    let right = stack.scatter(&stack.sweep(&first));
    let diffusion = Diffusion::new(&stack, stack.reflectances());
    let (rest, _) = solve(&stack, &diffusion, resolution, &right);
    let sources: Vec<f64> = first.iter().zip(&rest).map(|(a, b)| a + b).collect();
    let collided = stack.sweep(&sources).light;
    eta * eta * light.leaving(&stack, &collided)
}

/// Light before its first collision.
struct Uncollided {
    orders: usize,
    moments: usize,
    /// Ψ by layer, then order, moment and depth.
    psi: Vec<Vec<f64>>,
}

/// Ends of pieces of the cosine outside, with their points.
const PIECES: [(f64, f64, usize); 3] = [(0.0, 0.03, 8), (0.03, 0.2, 12), (0.2, 1.0, 24)];
/// Optical thickness along a ray behind which nothing counts.
const DARK: f64 = 18.0;

impl Uncollided {
    fn of(stack: &Stack, eta: f64, resolution: &Resolution) -> Self {
        let &Resolution { orders, moments, .. } = resolution;
        let rays: Vec<Ray> = PIECES
            .iter()
            .flat_map(|&(from, to, points)| {
                let half = 0.5 * (to - from);
                gauss_legendre(points)
                    .into_iter()
                    .map(move |(x, weight)| (from + half * (1.0 + x), half * weight))
            })
            .map(|(outside, weight)| Ray::new(outside, weight, eta, resolution))
            .collect();
        let mut bessel = vec![0.0; orders];
        let (mut tau, mut z) = (0.0, 0.0);
        let psi = stack.sheets.iter().map(|sheet| {
            let nodes = sheet.depths.len();
            let mut psi = vec![0.0; orders * moments * nodes];
            for (node, [inside, _]) in sheet.depths.iter().enumerate() {
                let (tau, z) = (tau + sheet.extinction * inside, z + inside);
                for ray in &rays {
                    let way = tau / ray.cosine;
                    if way > DARK {
                        continue;
                    }
                    let light = ray.weight * libm::exp(-way);
                    bessel_j(stack.k * z * ray.tangent, &mut bessel);
                    for (m, j) in bessel.iter().enumerate() {
                        let polynomials = &ray.polynomials[m];
                        for (l, polynomial) in (m..).zip(polynomials) {
                            psi[(m * moments + l) * nodes + node] += light * j * polynomial;
                        }
                    }
                }
            }
            tau += sheet.extinction * sheet.layer.thickness;
            z += sheet.layer.thickness;
            psi
        });
        let psi = psi.collect();
        Self { orders, moments, psi }
    }

    fn at(&self, sheet: usize, order: usize, moment: usize, nodes: usize) -> &[f64] {
        &self.psi[sheet][(order * self.moments + moment) * nodes..][..nodes]
    }

    /// Sources of light that collides for the first time, of one unit of flux that arrives.
    fn first_sources(&self, stack: &Stack) -> Vec<f64> {
        let mut sources = vec![0.0; stack.size];
        for (number, sheet) in stack.sheets.iter().enumerate() {
            let nodes = sheet.depths.len();
            for_each_moment(sheet, self.orders, |order, moment, factor, polynomials| {
                let psi = self.at(number, order, moment, nodes);
                let factor = factor * 2.0 * sign(order) / PI;
                for (ray, polynomial) in polynomials.iter().enumerate() {
                    let place = sheet.place(self.orders, (moment - order) % 2, order, ray);
                    let row = &mut sources[place..][..nodes];
                    row.iter_mut().zip(psi).for_each(|(sum, psi)| *sum += factor * polynomial * psi);
                }
            });
        }
        sources
    }

    /// Flux over η² that leaves above without another collision.
    fn leaving(&self, stack: &Stack, collided: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (number, sheet) in stack.sheets.iter().enumerate() {
            let nodes = sheet.depths.len();
            for_each_moment(sheet, self.orders, |order, moment, factor, polynomials| {
                let psi = self.at(number, order, moment, nodes);
                let mut light: Vec<f64> = psi.iter().map(|psi| 2.0 * sign(order) / PI * psi).collect();
                for (ray, (polynomial, weight)) in polynomials.iter().zip(&sheet.weights).enumerate() {
                    let place = sheet.place(self.orders, (moment - order) % 2, order, ray);
                    let row = &collided[place..][..nodes];
                    light.iter_mut().zip(row).for_each(|(sum, light)| *sum += polynomial * weight * light);
                }
                let side = if moment % 2 == 0 { 1.0 } else { -1.0 };
                let half = if order == 0 { 0.5 } else { 1.0 };
                let integral: f64 = light
                    .iter()
                    .zip(psi)
                    .zip(&sheet.depths)
                    .map(|((light, psi), [_, weight])| light * psi * weight)
                    .sum();
                sum += PI * half * side * sign(order) * factor * integral;
            });
        }
        sum
    }
}

/// A direction in which light enters.
struct Ray {
    cosine: f64,
    tangent: f64,
    /// (1 − F) dμ.
    weight: f64,
    /// P_lm by order, from l = m on.
    polynomials: Vec<Vec<f64>>,
}

impl Ray {
    fn new(outside: f64, weight: f64, eta: f64, resolution: &Resolution) -> Self {
        let sine = (1.0 - outside * outside).max(0.0).sqrt() / eta;
        let cosine = (1.0 - sine * sine).sqrt();
        let weight = weight * outside / (eta * eta * cosine) * (1.0 - fresnel_from_outside(outside, eta));
        let polynomials = |m: usize| associated_legendre(cosine, m, resolution.moments);
        Self {
            cosine,
            tangent: sine / cosine,
            weight,
            polynomials: (0..resolution.orders).map(polynomials).collect(),
        }
    }
}

/// Calls `visit` with the order, the moment, its factor and polynomials by ray for all moments of a layer.
fn for_each_moment(sheet: &Sheet, orders: usize, mut visit: impl FnMut(usize, usize, f64, &[f64])) {
    if sheet.depths.is_empty() {
        return;
    }
    for order in 0..orders {
        let polynomials: Vec<Vec<f64>> =
            sheet.cosines.iter().map(|mu| associated_legendre(*mu, order, sheet.factors.len())).collect();
        for (moment, factor) in
            sheet.factors.iter().enumerate().skip(order).filter(|(_, factor)| **factor != 0.0)
        {
            let of_rays: Vec<f64> = polynomials.iter().map(|row| row[moment - order]).collect();
            visit(order, moment, *factor, &of_rays);
        }
    }
}

/// (−i)^m without i for odd m, in which orders are imaginary.
fn sign(order: usize) -> f64 {
    if matches!(order % 4, 0 | 3) { 1.0 } else { -1.0 }
}

/// J₀ … of x ≥ 0.
fn bessel_j(x: f64, values: &mut [f64]) {
    let count = values.len();
    if x >= count as f64 {
        let (mut before, mut now) = (libm::j0(x), libm::j1(x));
        for (m, value) in values.iter_mut().enumerate() {
            *value = before;
            (before, now) = (now, 2.0 * (m + 1) as f64 / x * now - before);
        }
        return;
    }
    // J. C. P. Miller's recurrence from far above, where the sum J₀ + 2 J₂ + 2 J₄ + … is 1
    let (mut above, mut now, mut sum) = (0.0, 1e-30, 0.0);
    for m in (0..count + BEYOND).rev() {
        if m < count {
            values[m] = now;
        }
        if m % 2 == 0 {
            sum += if m == 0 { now } else { 2.0 * now };
        }
        let below = 2.0 * m as f64 / x.max(1e-12) * now - above;
        (above, now) = (now, below);
        if now.abs() > 1e200 {
            for value in values.iter_mut().chain([&mut above, &mut now, &mut sum]) {
                *value *= 1e-200;
            }
        }
    }
    values.iter_mut().for_each(|value| *value /= sum);
}

/// Orders above those that are asked for.
const BEYOND: usize = 14;

#[cfg(test)]
mod tests {
    use translucid_testing::is_thorough;

    use super::*;
    use crate::exact::HalfSpace;

    fn layered(layers: Vec<Layer>) -> Layers {
        Layers::new(1.0, layers, Ground::None).unwrap()
    }

    /// The half space of isotropic scatterers, without and with a boundary.
    #[test]
    fn profile_of_one_medium_is_that_of_the_half_space() {
        for (alpha, eta) in [(0.6, 1.0), (0.9, 1.0), (0.999, 1.0), (1.0, 1.0), (0.9, 1.4), (1.0, 1.4)] {
            let layer = Layer::new(2.0 * alpha, 2.0 * (1.0 - alpha), f64::INFINITY).with_eta(eta);
            let profile = layered(vec![layer]).diffuse_profile().unwrap();
            let exact = match eta {
                1.0 => HalfSpace::new(alpha, Incidence::Cosine),
                _ => HalfSpace::with_boundary(alpha, eta, Incidence::Cosine),
            };
            let exact = exact.unwrap();
            assert!((profile.total() - exact.total().value).abs() < 1e-6, "{alpha} {eta}");
            for (r, most) in [
                (1e-3, 0.025),
                (0.01, 0.006),
                (0.03, 0.006),
                (0.1, 2e-3),
                (0.3, 2e-3),
                (1.0, 2e-3),
                (3.0, 3e-3),
            ] {
                let off = profile.reflectance(0.5 * r) / (4.0 * exact.eval(r).value) - 1.0;
                assert!(off.abs() < most, "{alpha} {eta} {r}: {off:e}");
            }
            let row = profile.row().unwrap();
            for (r, within) in row.radii.iter().zip(&row.enclosed).step_by(5) {
                let off = within - exact.enclosed(2.0 * r).value;
                let most = if alpha == 1.0 { 0.01 } else { 4e-3 };
                assert!(off.abs() < most * profile.total(), "{alpha} {eta} {r}: {off:e}");
            }
        }
    }

    /// Layers with g and clear ones, with and without a face, by photons.
    #[test]
    fn profile_of_layers_is_that_of_the_walk() {
        let layer = |s: f64, a: f64, thickness: f64, g: f64| Layer::new(s, a, thickness).with_g(g);
        let endless = f64::INFINITY;
        let stacks = [
            ("skin", 1.0, vec![layer(50.0, 16.0, 0.01, 0.7), layer(11.0, 0.1, endless, 0.0)]),
            ("skin, eta 1.4", 1.4, vec![layer(20.0, 1.5, 0.1, 0.8), layer(15.0, 0.5, endless, 0.8)]),
            (
                "clear layer",
                1.0,
                vec![
                    layer(6.0, 0.4, 0.15, 0.5),
                    layer(3.0, 0.2, 0.5, 0.0),
                    layer(0.0, 0.0, 0.4, 0.0),
                    layer(1.0, 0.02, endless, 0.0),
                ],
            ),
            (
                "gap below",
                1.0,
                vec![layer(6.0, 0.4, 0.15, 0.0), layer(0.1, 0.02, 0.4, 0.0), layer(1.0, 0.005, endless, 0.0)],
            ),
            ("absorber below", 1.0, vec![layer(5.0, 1.6, 0.1, 0.7), layer(0.0, 2.0, endless, 0.0)]),
            ("bright below", 1.0, vec![layer(1.0, 0.001, 0.5, -0.3), layer(10.0, 0.01, endless, 0.8)]),
        ];
        let photons = if is_thorough() { 20_000_000 } else { 300_000 };
        for (name, eta, layers) in stacks {
            let layers = layered(layers.into_iter().map(|layer| layer.with_eta(eta)).collect());
            let entered = 1.0 - specular_reflectance(Incidence::Cosine, eta);
            let profile = layers.diffuse_profile().unwrap();
            let row = profile.row().unwrap();
            for dr in [0.02, 0.3] {
                let grid = crate::layers::Grid { dz: 1.0, dr, nz: 1, nr: 12, na: 1 };
                let tally = layers
                    .walk(Incidence::Cosine, grid, photons, 3, &crate::walk::Control::default())
                    .unwrap();
                let mut within = 0.0;
                for ring in 0..11 {
                    within += tally.reflectance(ring).value * grid.ring_area(ring) / entered;
                    let r = dr * (ring + 1) as f64;
                    let after = row.radii.partition_point(|known| *known < r).clamp(1, row.radii.len() - 1);
                    let part = (libm::log(r / row.radii[after - 1])
                        / libm::log(row.radii[after] / row.radii[after - 1]))
                    .clamp(0.0, 1.0);
                    let [low, high] = [row.enclosed[after - 1], row.enclosed[after]];
                    let found = low + part * (high - low);
                    let noise = (within * (1.0 - within) / (photons as f64 * entered)).sqrt();
                    let off = (found - within).abs();
                    assert!(off < 4.0 * noise + 4e-3 * profile.total(), "{name} {r}: {found} {within}");
                }
            }
        }
    }

    #[test]
    fn stacks_that_are_not_solved_are_refused() {
        let endless = Layer::new(1.0, 0.1, f64::INFINITY);
        let slab = Layers::new(1.0, vec![Layer::new(1.0, 0.1, 1.0)], Ground::AIR).unwrap();
        let many = [vec![Layer::new(1.0, 0.1, 1.0); 10], vec![endless.clone()]].concat();
        for (layers, message) in [
            (slab, "thickness of all layers is 1, but must be infinite"),
            (
                layered(vec![Layer::new(1.0, 0.1, 1.0).with_eta(1.4), endless.clone()]),
                "eta is 1, but must be that of the first",
            ),
            (layered(vec![endless.clone().with_eta(0.9)]), "eta over eta_above is 0.9"),
            (layered(vec![Layer::new(0.0, 1.0, f64::INFINITY)]), "scattering is 0"),
            (layered(vec![endless.clone().with_g(0.95)]), "layer 1: moment 32"),
            (layered(vec![Layer::new(1e4, 0.1, 1.0), endless]), "greatest extinction over the least"),
            (layered(many), "number of layers that scatter is 11"),
        ] {
            let error = layers.diffuse_profile().unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }

    #[test]
    fn bessel_functions_are_those_of_the_library() {
        for x in [0.0, 1e-9, 0.3, 2.0, 7.0, 11.9, 12.0, 40.0, 1e4] {
            let mut values = [0.0; 12];
            bessel_j(x, &mut values);
            for (m, value) in values.iter().enumerate() {
                let off = (value - libm::jn(m as i32, x)).abs();
                assert!(off < 1e-7, "{m} {x}: {off:e}");
            }
        }
    }
}
