//! Profiles of layers of any phase function and faces: real wave numbers by discrete directions, and poles.

use rayon::prelude::*;

use super::poles::Poles;
use super::remainder::{Remainder, remainder};
use super::single2::{Single, Span};
use super::stack::{Resolution, Stack};
use super::super::{Ground, Layer, Layers};
use crate::Estimate;

/// Light that leaves through one face.
#[derive(Clone, Debug)]
pub(super) struct Side {
    single: Single,
    /// By the finest solution first.
    rests: Vec<Poles>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    pub(super) moments: usize,
    pub(super) rays: usize,
    pub(super) nodes: usize,
    pub(super) orders: [f64; 2],
    pub(super) azimuths: [f64; 2],
    /// Wave numbers in mean transport... 
    pub(super) k: [f64; 2],
    pub(super) k_step: f64,
    pub(super) poles: [f64; 2],
    pub(super) pole_step: f64,
}

impl Settings {
    fn resolution(&self, k: f64) -> Resolution {
        let at = |[first, slope]: [f64; 2]| (first + slope * k).round() as usize;
        Resolution {
            rays: self.rays,
            moments: self.moments,
            orders: at(self.orders).clamp(1, self.moments),
            azimuths: at(self.azimuths).clamp(4, 28),
            nodes: self.nodes,
        }
    }
}

pub(super) fn solve(layers: &Layers, unit: f64, settings: &Settings) -> [(Single, Poles); 2] {
    let transport = |layer: &Layer| unit * (layer.extinction() - layer.scattering * layer.deflection.moment(1));
    let scattering = || layers.layers().iter().filter(|layer| layer.scattering > 0.0);
    let least = scattering().map(transport).fold(1.0, f64::min);
    let most = scattering().map(|layer| unit * layer.extinction()).fold(0.0, f64::max);
    let [low, high] = [settings.k[0] * least, settings.k[1] * most];
    let count = (libm::log(high / low) / settings.k_step).ceil() as usize + 1;
    let step = libm::log(high / low) / (count - 1) as f64;
    let ks: Vec<f64> = (0..count).map(|i| low * libm::exp(step * i as f64)).collect();
    let values: Vec<Remainder> =
        ks.par_iter().map(|k| remainder(layers, unit, *k, &settings.resolution(*k))).collect();
    let k0 = layers.slowest_decay(unit);
    let side = |side: usize| {
        let samples: Vec<[f64; 3]> = ks
            .iter()
            .zip(&values)
            .map(|(k, value)| [*k, value.rest[side], value.straight[side]])
            .collect();
        let poles = Poles::new(&samples, k0, [settings.poles[0] * low, settings.poles[1] * high], settings.pole_step);
        let stack = Stack::new(layers, unit, low, &settings.resolution(low));
        (single(layers, &stack, side), poles)
    };
    [side(0), side(1)]
}

fn single(layers: &Layers, stack: &Stack, side: usize) -> Single {
    let mut spans: Vec<Span> = stack.sheets.iter().map(|sheet| {
        let [down, up] = sheet.beam;
        Span {
            eta: sheet.layer.eta,
            thickness: sheet.layer.thickness,
            extinction: sheet.extinction,
            scattering: sheet.layer.scattering,
            deflection: sheet.layer.deflection.clone(),
            beam: if side == 0 { [down, up] } else { [up, down] },
        }
    }).collect();
    let mut eta = layers.eta_above();
    if side == 1 {
        spans.reverse();
        eta = match layers.ground() {
            Ground::Medium { eta } => eta,
            _ => 0.0,
        };
    }
    Single::new(eta, spans)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Incidence;
    use crate::layers::Grid;

    fn env(name: &str, default: f64) -> f64 {
        std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
    }

    #[test]
    fn try_r() {
        let (g, eta, alpha) = (env("G", 0.8), env("ETA", 1.4), env("ALPHA", 0.99));
        let thick = env("THICK", f64::INFINITY);
        let layers = Layers::new(1.0, vec![Layer::new(alpha, 1.0 - alpha, thick).with_g(g).with_eta(eta)], if thick.is_finite() { Ground::AIR} else {Ground::None}).unwrap();
        let base = Settings { moments: 24, rays: 16, nodes: 6, orders: [3.0, 8.0], azimuths: [6.0, 4.0], k: [0.02, 30.0], k_step: 0.4, poles: [0.3, 4.0], pole_step: 0.7 };
        let list = std::env::var("LIST").unwrap_or("24,16,6 16,12,6 12,8,6 8,8,6".into());
        let star = 1.0 / (1.0 - alpha * g);
        let radii: Vec<f64> = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0].iter().map(|r| r * star).collect();
        let mut first: Vec<[f64; 2]> = vec![];
        for item in list.split(' ') {
            let n: Vec<usize> = item.split(',').map(|x| x.parse().unwrap()).collect();
            let [moments, rays, nodes] = n[..] else { panic!() };
            let settings = Settings { moments, rays, nodes, k: [0.02, env("KMAX", 30.0)], k_step: env("KSTEP", 0.4), pole_step: env("PSTEP", 0.7), orders: [env("O0", 3.0), env("O1", 8.0)], azimuths: [env("A0", 6.0), env("A1", 4.0)], ..base };
            let start = std::time::Instant::now();
            let sides = solve(&layers, 1.0, &settings);
            let time = start.elapsed();
            let values: Vec<[f64; 2]> = radii.iter().map(|r| [0, 1].map(|s| sides[s].0.eval(*r).value + sides[s].1.eval(*r))).collect();
            if first.is_empty() { first = values.clone(); }
            eprintln!("r {item} {time:?}");
            for (i, r) in radii.iter().enumerate() {
                let v = values[i];
                let f = first[i];
                eprintln!("r   {:.3} R {:.6e} (single {:.2e}) change {:.1e}  T {:.6e} change {:.1e}", r / star, v[0], sides[0].0.eval(*r).value / v[0], v[0] / f[0] - 1.0, v[1], v[1] / f[1] - 1.0);
            }
        }
        let photons = env("PHOTONS", 0.0) as u64;
        if photons > 0 {
            let n: Vec<usize> = list.split(' ').next().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
            let settings = Settings { moments: n[0], rays: n[1], nodes: n[2], k: [0.02, env("KMAX", 30.0)], k_step: env("KSTEP", 0.4), pole_step: env("PSTEP", 0.7), orders: [env("O0", 3.0), env("O1", 8.0)], azimuths: [env("A0", 6.0), env("A1", 4.0)], ..base };
            let sides = solve(&layers, 1.0, &settings);
            for dr in [0.02 * star, 0.3 * star, 2.0 * star] {
                let grid = Grid { dz: 1.0, dr, nz: 1, nr: 12, na: 1 };
                let tally = layers.walk(Incidence::NORMAL, grid, photons, 11, &Default::default()).unwrap();
                let rule = translucid_profile::quadrature::gauss_legendre(10);
                for ring in 0..11 {
                    for side in 0..2 {
                        let walked = if side == 0 { tally.reflectance(ring) } else { tally.transmittance(ring) };
                        let r0 = ring as f64 * dr;
                        let expected = translucid_profile::quadrature::integrate(&rule, r0, r0 + dr, |r| {
                            2.0 * std::f64::consts::PI * r * (sides[side].0.eval(r).value + sides[side].1.eval(r))
                        }) / grid.ring_area(ring);
                        if walked.value > 0.0 {
                        eprintln!("w side {side} {:.3}..{:.3}: walk {:.5e} +- {:.1e} profile {:.5e} off {:.1e} z {:.1}", r0 / star, (r0 + dr) / star, walked.value, walked.error / walked.value, expected, expected / walked.value - 1.0, (expected - walked.value) / walked.error);
                        }
                    }
                }
            }
        }
    }
}
