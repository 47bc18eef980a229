//! CPU time of the guided walk to a given error, beside other schemes, and what each of its parts gains.
//!
//! First table: CPU time to a standard error of 0.1 % of the total and of 1 % of the ring from 1 to 3 ℓ; and how
//! many times that MCML takes, whose photons per second are those of version 1.2.2 on a machine of the kind the
//! rest was developed on, and whose variance per photon is that of its scheme (implicit capture, roulette with
//! survival 1/10 below a weight of 10⁻⁴), run here in a plain loop. The last row of each albedo tallies 40 rings at
//! once, and the error it reaches is 1 % of the median one of the six that make up 1–3 ℓ.
//!
//! Second table: relative variance × collisions, of a plain loop in double precision to which the parts are added
//! one by one. A collision costs much the same in all.

#![allow(clippy::print_stdout, reason = "a bench prints its figures")]

use std::time::Instant;

use translucid_reference::walk::{Control, GuidedWalk, Layout, Parameters, Problem, Side, WhiteTable};
use translucid_reference::{Estimate, exact::HalfSpace};

/// CPU time of this thread in seconds.
fn cpu_time(start: Instant) -> f64 {
    std::thread::yield_now(); // brings the account up to date
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = stat.and_then(|line| line.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}

const RING: [f64; 2] = [1.0, 3.0];

/// Albedos, and photons per second that MCML 1.2.2 walks there.
const MCML_SPEED: [(f64, f64); 4] = [(0.5, 1.65e6), (0.9, 4.9e5), (0.99, 1.86e5), (0.999, 6.2e4)];

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    pool.install(|| {
        println!("CPU time to 0.1 % of the total and to 1 % of the ring 1–3 ℓ; (times MCML takes)");
        MCML_SPEED.iter().for_each(|&(alpha, speed)| compare(alpha, speed));
        println!("\nRelative variance × collisions (times that of MCML's scheme)");
        MCML_SPEED.iter().for_each(|&(alpha, _)| explain(alpha));
    });
}

fn relative_variance(figure: Estimate, photons: u64) -> f64 {
    figure.relative_error().powi(2) * photons as f64
}

/// Prints seconds per photon and relative variances as times.
fn report(name: &str, alpha: f64, seconds: f64, variances: [f64; 2], mcml: Option<[f64; 2]>) -> [f64; 2] {
    let times = [seconds * variances[0] / 1e-6, seconds * variances[1] / 1e-4];
    let cell = |i: usize| {
        let ratio = mcml.map_or(1.0, |mcml| mcml[i] / times[i]);
        format!("{:11.4} ms ({ratio:8.1})", 1e3 * times[i])
    };
    println!("α = {alpha:<6} {name:32} {:9.2} ns/photon {} {}", 1e9 * seconds, cell(0), cell(1));
    times
}

fn compare(alpha: f64, mcml_speed: f64) {
    let mut start_photons = Photons::new(alpha);
    let samples = start_photons.run(Scheme::Mcml, 1 << 20);
    let mcml = report("MCML", alpha, 1.0 / mcml_speed, [samples.total, samples.ring], None);

    let problem = Problem::new(Parameters::default()).unwrap();
    let start = Instant::now();
    let photons = ((1u64 << 22) as f64 * (1.0 - alpha).sqrt()) as u64;
    let mut best = f64::INFINITY;
    let mut variances = [0.0; 2];
    for _ in 0..5 {
        let mut table = WhiteTable::new(problem, Layout::new(&RING, 1).unwrap(), alpha).unwrap();
        let before = cpu_time(start);
        table.run(1, photons, &Control::default()).unwrap();
        best = best.min(cpu_time(start) - before);
        let at = table.at_albedo(alpha).unwrap();
        variances =
            [at.total(Side::Reflected), at.ring(Side::Reflected, 1)].map(|f| relative_variance(f, photons));
    }
    report("analog absorption, in lanes", alpha, best / photons as f64, variances, Some(mcml));

    for (name, radii) in
        [("guided, in lanes", &RING[..]), ("guided, in lanes, 1 % of a sixth", &forty_radii())]
    {
        let ring_start = radii.iter().position(|&r| r == 1.0).unwrap();
        let ring_end = radii.iter().position(|&r| r == 3.0).unwrap();
        let (mut best, mut photons) = (f64::INFINITY, 0);
        let mut variances = [0.0; 2];
        for _ in 0..7 {
            let mut walk = GuidedWalk::new(&problem, alpha, radii).unwrap();
            let before = cpu_time(start);
            walk.run(1, 1 << 22, &Control::default()).unwrap();
            best = best.min(cpu_time(start) - before);
            photons = walk.photons();
            variances[0] = relative_variance(walk.total(), photons);
            if ring_end == ring_start + 1 {
                variances[1] = relative_variance(walk.ring(ring_end), photons);
            } else {
                // The median of the rings between
                let mut rings: Vec<f64> =
                    (ring_start + 1..=ring_end).map(|i| relative_variance(walk.ring(i), photons)).collect();
                rings.sort_by(f64::total_cmp);
                variances[1] = rings[rings.len() / 2];
            }
        }
        report(name, alpha, best / photons as f64, variances, Some(mcml));
    }
}

/// 0.01 to 10 in 41 steps, 1 and 3 among them.
fn forty_radii() -> Vec<f64> {
    let step = |i: i32| 3f64.powf(f64::from(i) / 6.0);
    let mut radii: Vec<f64> = (-25..=15).map(step).collect();
    radii[25] = 1.0;
    radii[31] = 3.0;
    radii
}

fn explain(alpha: f64) {
    let mut photons = Photons::new(alpha);
    let n = 1 << 20;
    let mcml = photons.run(Scheme::Mcml, n);
    let plain = Guided { twice: false, azimuths: false, roulette: false };
    let schemes = [
        ("MCML's scheme", Scheme::Mcml),
        ("analog absorption", Scheme::Analog),
        ("guided", Scheme::Guided(plain)),
        ("… from the second collision on", Scheme::Guided(Guided { twice: true, ..plain })),
        (
            "… all azimuths of the last flight",
            Scheme::Guided(Guided { twice: true, azimuths: true, ..plain }),
        ),
        ("… roulette", Scheme::Guided(Guided { twice: true, azimuths: true, roulette: true })),
    ];
    let line = |name: &str, s: &Samples| {
        let cost = [s.collisions * s.total, s.collisions * s.ring];
        let gain = [mcml.collisions * mcml.total / cost[0], mcml.collisions * mcml.ring / cost[1]];
        println!(
            "α = {alpha:<6} {name:36} {:7.2} collisions, total {:9.2e} ({:8.1}), ring {:8.2} ({:6.1})",
            s.collisions, cost[0], gain[0], cost[1], gain[1]
        );
    };
    for (name, scheme) in schemes {
        line(name, &photons.run(scheme, n));
    }
    let problem = Problem::new(Parameters::default()).unwrap();
    let mut walk = GuidedWalk::new(&problem, alpha, &RING).unwrap();
    walk.run(1, 1 << 23, &Control::default()).unwrap();
    let lattice = Samples {
        collisions: walk.mean_collisions(),
        total: relative_variance(walk.total(), walk.photons()),
        ring: relative_variance(walk.ring(1), walk.photons()),
    };
    line("… lattice (the crate's walk)", &lattice);
}

#[derive(Clone, Copy)]
struct Guided {
    /// Light scattered once is integrated.
    twice: bool,
    /// An exit counts in all rings that its last flight may reach.
    azimuths: bool,
    /// Photons far from the ring are followed less often.
    roulette: bool,
}

#[derive(Clone, Copy)]
enum Scheme {
    Mcml,
    Analog,
    Guided(Guided),
}

/// Per photon: mean collisions and relative variances.
struct Samples {
    collisions: f64,
    total: f64,
    ring: f64,
}

/// One photon's contributions to total and ring, and its collisions.
type Scored = (f64, f64, f64);

/// A plain walk, one photon at a time, in double precision.
struct Photons {
    alpha: f64,
    exact: HalfSpace,
    /// k with α atanh(k)/k = 1.
    k: f64,
    /// Mean of 1 − kμ of light that comes from afar.
    mean_exit: f64,
    state: u64,
}

impl Photons {
    fn new(alpha: f64) -> Self {
        let (mut low, mut high) = (0.0, 1.0);
        while high - low > 1e-15 {
            let k: f64 = 0.5 * (low + high);
            if alpha * k.atanh() < k { low = k } else { high = k }
        }
        let k = low;
        let gamma = (1.0 - alpha).sqrt();
        let nodes = (0..64).map(|i| (f64::from(i) + 0.5) / 64.0);
        let (flux, weighted) = nodes.fold((0.0, 0.0), |(flux, weighted), mu| {
            let h = mu * (1.0 + 2.0 * mu) / (1.0 + 2.0 * mu * gamma);
            (flux + h / (1.0 - k * mu), weighted + h)
        });
        let exact = HalfSpace::new(alpha, translucid_reference::Incidence::NORMAL).unwrap();
        Self { alpha, exact, k, mean_exit: weighted / flux, state: 1 }
    }

    /// Uniform in (0, 1): G. L. Steele, D. Lea and C. H. Flood 2014, *Fast splittable pseudorandom number
    /// generators* (SplitMix64).
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ (z >> 31)) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn run(&mut self, scheme: Scheme, photons: u32) -> Samples {
        let (mut collisions, mut sums) = (0.0, [0.0; 4]);
        for _ in 0..photons {
            let (total, ring, more) = match scheme {
                Scheme::Mcml => self.unguided(true),
                Scheme::Analog => self.unguided(false),
                Scheme::Guided(guided) => self.guided(guided),
            };
            collisions += more;
            sums = [sums[0] + total, sums[1] + total * total, sums[2] + ring, sums[3] + ring * ring];
        }
        let n = f64::from(photons);
        let enclosed = RING.map(|r| self.exact.enclosed(r).value);
        let relative = |sum: f64, squares: f64, exact: f64| (squares / n - (sum / n).powi(2)) / exact.powi(2);
        Samples {
            collisions: collisions / n,
            total: relative(sums[0], sums[1], self.exact.total().value),
            ring: relative(sums[2], sums[3], enclosed[1] - enclosed[0]),
        }
    }

    /// Absorption by weight (MCML's scheme) or by chance.
    fn unguided(&mut self, weighted: bool) -> Scored {
        let (mut x, mut y, mut z) = (0.0, 0.0, -self.uniform().ln());
        let (mut weight, mut collisions) = (1.0, 1.0);
        loop {
            if !weighted && self.uniform() > self.alpha {
                return (0.0, 0.0, collisions);
            }
            if weighted {
                weight *= self.alpha;
                if weight < 1e-4 {
                    if self.uniform() > 0.1 {
                        return (0.0, 0.0, collisions);
                    }
                    weight *= 10.0;
                }
            }
            let mu = 2.0 * self.uniform() - 1.0;
            let length = -self.uniform().ln();
            let (sin, cos) = (std::f64::consts::TAU * self.uniform()).sin_cos();
            let aside = (1.0 - mu * mu).sqrt() * length.min(if mu > 0.0 { z / mu } else { f64::INFINITY });
            (x, y) = (x + aside * cos, y + aside * sin);
            z -= mu * length;
            if z < 0.0 {
                let inside = (RING[0]..RING[1]).contains(&f64::hypot(x, y));
                return (weight, if inside { weight } else { 0.0 }, collisions);
            }
            collisions += 1.0;
        }
    }

    fn guided(&mut self, parts: Guided) -> Scored {
        let k = self.k;
        let ln_ratio = ((1.0 - k) / (1.0 + k)).ln();
        let (mut x, mut y) = (0.0, 0.0);
        let (mut z, start, mut collisions);
        if parts.twice {
            let (up, down) = (0.5 * std::f64::consts::LN_2, k.ln_1p() / (2.0 * k));
            let length = -self.uniform().ln();
            let first = -self.uniform().ln() / (1.0 + k);
            if self.uniform() * (up + down) < up {
                let mu = self.uniform().exp2() - 1.0;
                x = length / (1.0 + mu) * (1.0 - mu * mu).sqrt();
                z = first;
            } else {
                let mu = ((self.uniform() * k.ln_1p()).exp() - 1.0) / k;
                x = length / (1.0 + k * mu) * (1.0 - mu * mu).sqrt();
                z = first + mu * length / (1.0 + k * mu);
            }
            (start, collisions) = (self.alpha * (up + down) / (1.0 + k), 2.0);
        } else {
            z = -self.uniform().ln() / (1.0 + k);
            (start, collisions) = (1.0 / (1.0 + k), 1.0);
        }
        let (mut weight, mut correction, mut flights) = (start, 0.0, 0);
        loop {
            if parts.roulette && flights % 4 == 3 {
                let wanted = ((x * x + y * y + z * z).sqrt() / (RING[1] + 1.0)).powf(1.5);
                if wanted * start >= 2.0 * weight {
                    if self.uniform() < 0.5 {
                        return (correction + self.mean_exit * weight, 0.0, collisions);
                    }
                    correction -= self.mean_exit * weight;
                    weight *= 2.0;
                }
            }
            flights += 1;
            let sigma = (1.0 + k) * (ln_ratio * self.uniform()).exp();
            let mu = (1.0 - sigma) / k;
            let length = -self.uniform().ln() / sigma;
            let (sin, cos) = (std::f64::consts::TAU * self.uniform()).sin_cos();
            let sine = (1.0 - mu * mu).max(0.0).sqrt();
            if z < mu * length {
                let (score, aside) = (weight * sigma, z / mu * sine);
                let ring = if parts.azimuths {
                    let rho = f64::hypot(x, y);
                    let part = RING.map(|r| {
                        let c = (rho * rho + aside * aside - r * r) / (2.0 * rho * aside).max(1e-300);
                        c.clamp(-1.0, 1.0).acos() / std::f64::consts::PI
                    });
                    part[1] - part[0]
                } else {
                    let r = f64::hypot(x + aside * cos, y + aside * sin);
                    f64::from(u8::from((RING[0]..RING[1]).contains(&r)))
                };
                return (correction + score, score * ring, collisions);
            }
            (x, y, z) = (x + sine * length * cos, y + sine * length * sin, z - mu * length);
            collisions += 1.0;
        }
    }
}
