//! The shaders' walk in Rust, operation by operation: what its bits are to be.
//!
//! Rust rounds every sum and product once and joins none, as the shaders' `fixed` asks for; so the two agree to the bit, or
//! a device does not keep the rules.

use std::ops::Range;

use translucid_reference::walk::{Device, DeviceTally, DeviceWalk};

use super::walk_numbers::{
    self, COSINE_MATCHED, COSINE_RARER, HENYEY_GREENSTEIN, ISOTROPIC, Interface, PENCIL, UNIFORM_COSINE,
    WalkNumbers,
};

/// Walks photons one after the other.
pub(crate) struct Twin;

impl Device for Twin {
    fn walk(
        &self,
        walk: &DeviceWalk,
        photons: Range<u64>,
        _: &dyn Fn() -> bool,
        _: &dyn Fn(u64),
    ) -> Result<DeviceTally, String> {
        let numbers = WalkNumbers::new(walk)?;
        let mut tally = DeviceTally { exits: vec![(0, 0); numbers.bins.cells()], ..DeviceTally::default() };
        for index in photons {
            numbers.walk_one(index, &mut tally);
        }
        Ok(tally)
    }
}

fn reciprocal(x: f32) -> f32 {
    let mut y = f32::from_bits(0x7ef3_11c7u32.wrapping_sub(x.to_bits()));
    for _ in 0..3 {
        y *= 2.0 - x * y;
    }
    y
}

fn root(x: f32) -> f32 {
    let half = 0.5 * x;
    let mut y = f32::from_bits(0x5f37_5a86 - (x.to_bits() >> 1));
    for _ in 0..3 {
        y *= 1.5 - half * y * y;
    }
    x * y
}

fn complement(x: f32) -> f32 {
    root((1.0 - x.abs()) * (1.0 + x.abs()))
}

fn unit(word: u32) -> f32 {
    ((word >> 8) | 1) as f32 / 16_777_216.0
}

fn signed(word: u32) -> f32 {
    ((word.cast_signed() >> 8) | 1) as f32 / 8_388_608.0
}

fn polynomial(x: f32, coefficients: &[f32]) -> f32 {
    coefficients
        .iter()
        .rev()
        .copied()
        .reduce(|value, coefficient| value * x + coefficient)
        .unwrap_or_default()
}

fn exponential(word: u32) -> f32 {
    const LOG: [f32; 9] = [
        0.9999999741,
        -0.49999996,
        0.33334193,
        -0.25001352,
        0.19955933,
        -0.16577993,
        0.1497740128,
        -0.14269258,
        0.08533313,
    ];
    let odd = word | 1;
    let zeros = odd.leading_zeros();
    let bits = 0x3f80_0000 | ((((odd << zeros) >> 8) | 1) & 0x7f_ffff);
    let above = u32::from(bits > 0x3fb5_04f3);
    let t = f32::from_bits(bits - (above << 23)) - 1.0;
    (zeros + 1 - above) as f32 * std::f32::consts::LN_2 - t * polynomial(t, &LOG)
}

fn circle(word: u32) -> [f32; 2] {
    const SIN: [f32; 4] = [std::f32::consts::FRAC_PI_4, -0.0807454347, 0.0024900068, -3.595429e-5];
    const COS: [f32; 4] = [0.9999999723, -0.30842425, 0.01584991, -3.1887748e-4];
    let t = signed(word << 2);
    let q = t * t;
    let (s, c) = (polynomial(q, &SIN) * t, polynomial(q, &COS));
    let [x, y] = if word & 0x4000_0000 != 0 { [s, c] } else { [c, s] };
    if word & 0x8000_0000 != 0 { [-x, -y] } else { [x, y] }
}

/// pcg4d with a round more.
fn random(key: [u32; 4], index: u64, step: u32) -> [u32; 4] {
    let words = [index as u32, (index >> 32) as u32, step, 0];
    let mut v: [u32; 4] =
        std::array::from_fn(|i| (words[i] ^ key[i]).wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mix = |v: &mut [u32; 4]| {
        for (to, a, b) in [(0, 1, 3), (1, 2, 0), (2, 0, 1), (3, 1, 2)] {
            v[to] = v[to].wrapping_add(v[a].wrapping_mul(v[b]));
        }
    };
    for _ in 0..2 {
        mix(&mut v);
        v = v.map(|word| word ^ (word >> 16));
    }
    mix(&mut v);
    v
}

fn squared_distance(x: f32, y: f32) -> [f32; 2] {
    let [a, b] = [x, y].map(|x| f32::from_bits(x.to_bits() & 0xffff_f000));
    let (p, q) = (a * a, b * b);
    let upper = p + q;
    let lost = p.min(q) - (upper - p.max(q));
    let rest = lost + ((x - a) * (x + a) + (y - b) * (y + b));
    let sum = upper + rest;
    [sum, rest - (sum - upper)]
}

fn reflectance(mu: f32, side: &Interface) -> f32 {
    let squared = mu * mu * side.eta_squared + side.one_minus_eta_squared;
    if squared <= 0.0 {
        return 1.0;
    }
    let refracted = root(squared.min(1.0));
    let (a, b) = (mu * side.eta, refracted * side.eta);
    let perpendicular = (a - refracted) * reciprocal(a + refracted);
    let parallel = (b - mu) * reciprocal(b + mu);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

fn rayleigh(x: f32) -> [f32; 2] {
    let start = x * polynomial(x * x, &[1.3298686, -0.6705609, 0.5480744, -0.20843726]);
    let square = start * start;
    let third_slope = square + 1.0;
    let f = start * (square + 3.0) - 4.0 * x;
    let below = third_slope * third_slope * 3.0 - f * start;
    let cosine = (start - f * third_slope * reciprocal(below)).clamp(-1.0, 1.0);
    [cosine, complement(cosine)]
}

fn turned(u: [f32; 3], [cosine, sine]: [f32; 2], [x, y]: [f32; 2]) -> [f32; 3] {
    let (p, q) = (sine * x, sine * y);
    let d = p * u[0] + q * u[1];
    let k = cosine + d * reciprocal(u[2].abs() + 1.0);
    let v = [k * u[0] - p, k * u[1] - q, cosine * u[2] + if u[2] < 0.0 { -d } else { d }];
    let shrink = 1.5 - 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    v.map(|component| component * shrink)
}

impl WalkNumbers {
    fn henyey_greenstein(&self, xi: f32) -> [f32; 2] {
        let twice = xi * (2.0 * self.g);
        let ratio = self.one_minus_g * reciprocal(twice + self.one_minus_g);
        let versine = ((1.0 - xi) * (twice + 2.0) * (ratio * ratio)).min(2.0);
        let cosine = 1.0 - versine;
        [if self.backwards { -cosine } else { cosine }, root(versine * (2.0 - versine))]
    }

    fn scattered(&self, before: [f32; 3], polar: u32, azimuth: u32) -> [f32; 3] {
        let [x, y] = circle(azimuth);
        match self.phase_function {
            ISOTROPIC => {
                let z = signed(polar);
                let sine = complement(z);
                [sine * x, sine * y, z]
            }
            HENYEY_GREENSTEIN => turned(before, self.henyey_greenstein(unit(polar)), [x, y]),
            _ => turned(before, rayleigh(signed(polar)), [x, y]),
        }
    }

    /// Direction of the start, and the first step that it leaves.
    fn start(&self, index: u64) -> ([f32; 3], u32) {
        if self.incidence == PENCIL {
            return ([self.sine, 0.0, self.cosine], 1);
        }
        for step in 1.. {
            let words = random(self.key, index, step);
            let mut cosine = unit(words[0]);
            if self.incidence != UNIFORM_COSINE {
                cosine = root(cosine);
                if self.incidence != COSINE_MATCHED && unit(words[1]) <= reflectance(cosine, &self.rarer) {
                    continue;
                }
            }
            let mut sine = complement(cosine);
            if self.incidence > COSINE_RARER {
                sine *= self.inverse_eta;
                cosine = complement(sine);
            }
            let [x, y] = circle(words[2]);
            return ([sine * x, sine * y, cosine], step + 1);
        }
        unreachable!("a candidate is accepted")
    }

    fn is_outside(&self, z: f32) -> bool {
        z < 0.0 || z > self.thickness
    }

    fn walk_one(&self, index: u64, tally: &mut DeviceTally) {
        let words = random(self.key, index, 0);
        let budget = (exponential(words[0]) * self.collisions_per_unit) as u32;
        let (radius, place) = (root(unit(words[1])) * self.spot_radius, circle(words[2]));
        let mut p = [radius * place[0], radius * place[1], 0.0];
        let (mut u, first) = self.start(index);
        let mut order = 0;
        tally.launched += 1;
        for step in first.. {
            let words = random(self.key, index, step);
            if !self.is_outside(p[2]) {
                let flight = exponential(words[0]);
                p = std::array::from_fn(|i| p[i] + flight * u[i]);
            }
            if self.is_outside(p[2]) {
                let upper = p[2] < 0.0;
                if self.matched || unit(words[1]) >= reflectance(u[2].abs(), &self.face) {
                    let beyond = if upper { -p[2] } else { p[2] - self.thickness } * reciprocal(u[2].abs());
                    self.count([p[0] - beyond * u[0], p[1] - beyond * u[1]], order, !upper, tally);
                    return;
                }
                p[2] = if upper { -p[2] } else { 2.0 * self.thickness - p[2] };
                u[2] = -u[2];
            }
            if self.is_outside(p[2]) {
                continue;
            }
            tally.collisions += 1;
            if order == budget {
                tally.absorbed += 1;
                return;
            }
            order += 1;
            u = self.scattered(u, words[2], words[3]);
        }
    }

    fn count(&self, [x, y]: [f32; 2], order: u32, is_transmitted: bool, tally: &mut DeviceTally) {
        let bins = &self.bins;
        let (squares, more) = bins.bounds.split_at(bins.radii as usize);
        let (between, more) = more.split_at(2 * (bins.sectors - 1) as usize);
        let (orders, rests) = more.split_at(bins.order_bins as usize - 1);
        let [square, rest] = squared_distance(x, y);
        let is_within = |(&bound, &bound_rest): (&u32, &u32)| {
            square.to_bits() < bound || square.to_bits() == bound && rest < f32::from_bits(bound_rest)
        };
        let ring = squares.len() - squares.iter().zip(rests).filter(|bound| is_within(*bound)).count();
        let is_beyond = |bound: &&[u32; 2]| {
            let [cosine, sine] = bound.map(f32::from_bits);
            cosine * y.abs() - sine * x > 0.0
        };
        let sector = between.as_chunks().0.iter().take_while(is_beyond).count();
        let bin = orders.iter().filter(|first| **first <= order).count();
        let face = usize::from(is_transmitted) * (bins.radii as usize + 1);
        let cell = ((face + ring) * bins.sectors as usize + sector) * bins.order_bins as usize + bin;
        tally.exits[cell].0 += 1;
        tally.exits[cell].1 += u64::from(order);
    }
}

pub(crate) mod laws;
