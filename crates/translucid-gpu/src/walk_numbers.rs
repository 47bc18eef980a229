//! A walk as numbers in single precision, as the shaders take them.

use translucid_reference::Incidence;
use translucid_reference::walk::{DeviceWalk, PhaseFunction};

/// Kinds of phase functions and of incidence, as the shaders number them.
pub(crate) const ISOTROPIC: u32 = 0;
pub(crate) const HENYEY_GREENSTEIN: u32 = 1;
pub(crate) const RAYLEIGH: u32 = 2;
pub(crate) const PENCIL: u32 = 0;
pub(crate) const UNIFORM_COSINE: u32 = 1;
pub(crate) const COSINE_MATCHED: u32 = 2;
pub(crate) const COSINE_RARER: u32 = 3;
pub(crate) const COSINE_DENSER: u32 = 4;

/// Thinnest slab with a reflecting boundary: a photon crosses it some hundred times between two collisions at most.
const THINNEST: f64 = 0.01;
/// Most forward and most backward scattering whose deflections have their digits.
const MOST_ANISOTROPIC: f64 = 0.9999;
/// Least distance of two radii over the greater one: ten units in the last place.
const LEAST_GAP: f64 = 1e-6;

/// A smooth boundary from one of its sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interface {
    pub(crate) eta: f32,
    pub(crate) eta_squared: f32,
    pub(crate) one_minus_eta_squared: f32,
}

impl Interface {
    pub(crate) fn new(eta: f64) -> Self {
        let one_minus_eta_squared = (1.0 - eta) * (1.0 + eta);
        Self {
            eta: eta as f32,
            eta_squared: (eta * eta) as f32,
            one_minus_eta_squared: one_minus_eta_squared as f32,
        }
    }
}

/// All that the walk of a photon depends on, but its index.
#[derive(Clone, Debug)]
pub(crate) struct WalkNumbers {
    pub(crate) key: [u32; 4],
    pub(crate) phase_function: u32,
    pub(crate) incidence: u32,
    pub(crate) matched: bool,
    /// The faces from inside.
    pub(crate) face: Interface,
    /// They from the side of the lower index.
    pub(crate) rarer: Interface,
    pub(crate) collisions_per_unit: f32,
    pub(crate) thickness: f32,
    pub(crate) spot_radius: f32,
    /// |g|
    pub(crate) g: f32,
    pub(crate) one_minus_g: f32,
    pub(crate) backwards: bool,
    /// Direction of a pencil inside.
    pub(crate) sine: f32,
    pub(crate) cosine: f32,
    pub(crate) inverse_eta: f32,
    pub(crate) bins: Bins,
}

/// Bounds of the bins, as words.
#[derive(Clone, Debug)]
pub(crate) struct Bins {
    /// Squared radii rounded, cosine and sine of the angles between sectors, first orders of all bins but the first, and
    /// what the rounding of squared radii left out.
    pub(crate) bounds: Vec<u32>,
    pub(crate) radii: u32,
    pub(crate) sectors: u32,
    pub(crate) order_bins: u32,
    pub(crate) faces: u32,
}

impl Bins {
    /// Number of cells.
    pub(crate) fn cells(&self) -> usize {
        (self.faces * (self.radii + 1) * self.sectors * self.order_bins) as usize
    }
}

impl WalkNumbers {
    /// The numbers of a walk.
    ///
    /// # Errors
    /// Single precision does not do for it.
    pub(crate) fn new(walk: &DeviceWalk) -> Result<Self, String> {
        let parameters = walk.problem.parameters();
        let (eta, thickness) = (parameters.eta, parameters.thickness);
        let matched = eta == 1.0;
        if !matched && thickness < THINNEST {
            return Err(format!(
                "the thickness of the slab is {thickness} mean free paths, but with a reflecting boundary a device walks through \
                 {THINNEST} at least"
            ));
        }
        let (phase_function, g) = match &parameters.phase_function {
            PhaseFunction::HenyeyGreenstein { g: 0.0 } => (ISOTROPIC, 0.0),
            PhaseFunction::HenyeyGreenstein { g } => (HENYEY_GREENSTEIN, *g),
            PhaseFunction::Rayleigh => (RAYLEIGH, 0.0),
            other => {
                return Err(format!(
                    "the phase function is {}, but a device walks with henyey-greenstein and rayleigh only",
                    other.name()
                ));
            }
        };
        if g.abs() > MOST_ANISOTROPIC {
            return Err(format!(
                "g is {g}, but a device walks with g in [-{MOST_ANISOTROPIC}, {MOST_ANISOTROPIC}]"
            ));
        }
        let (mut sine, mut cosine) = (0.0, 1.0);
        let incidence = match parameters.incidence {
            Incidence::Pencil { cos_theta } => {
                sine = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt() / eta;
                // In a form that keeps its digits near grazing
                cosine = ((eta - 1.0) * (eta + 1.0) + cos_theta * cos_theta).max(0.0).sqrt() / eta;
                PENCIL
            }
            Incidence::UniformCosine => UNIFORM_COSINE,
            Incidence::Cosine if matched => COSINE_MATCHED,
            Incidence::Cosine if eta < 1.0 => COSINE_RARER,
            Incidence::Cosine => COSINE_DENSER,
        };
        Ok(Self {
            key: key(walk.seed),
            phase_function,
            incidence,
            matched,
            face: Interface::new(eta),
            rarer: Interface::new(eta.min(1.0 / eta)),
            collisions_per_unit: (-1.0 / libm::log(walk.reference_albedo)) as f32,
            // Nothing is deeper than the greatest number
            thickness: thickness.min(f64::from(f32::MAX)) as f32,
            spot_radius: parameters.spot_radius as f32,
            g: g.abs() as f32,
            one_minus_g: (1.0 - g.abs()) as f32,
            backwards: g < 0.0,
            sine: sine as f32,
            cosine: cosine as f32,
            inverse_eta: (1.0 / eta) as f32,
            bins: bins(walk)?,
        })
    }
}

#[cfg(feature = "device")]
impl WalkNumbers {
    /// The words of `Settings` in `walk.wgsl`.
    pub(crate) fn settings(&self, first: u64, photons: u32, slots: u32, steps: u32) -> Vec<u32> {
        let side = |side: &Interface| {
            [side.eta, side.eta_squared, side.one_minus_eta_squared, 0.0].map(f32::to_bits)
        };
        let (bins, zero) = (&self.bins, 0);
        let mut words = self.key.to_vec();
        words.extend([side(&self.face), side(&self.rarer)].concat());
        words.extend([first as u32, (first >> 32) as u32, photons, slots, steps, zero]);
        words.extend([bins.radii, bins.sectors, bins.order_bins]);
        words.extend([self.collisions_per_unit, self.thickness, self.spot_radius].map(f32::to_bits));
        words.extend([self.g.to_bits(), self.one_minus_g.to_bits(), self.backwards.into()]);
        words.extend([self.sine, self.cosine, self.inverse_eta].map(f32::to_bits));
        // A structure ends at a multiple of its greatest member
        words.resize(words.len().next_multiple_of(4), 0);
        words
    }
}

fn bins(walk: &DeviceWalk) -> Result<Bins, String> {
    let (layout, radii) = (walk.layout, walk.layout.radii());
    if let Some([inner, outer]) = radii.windows(2).find(|pair| pair[1] - pair[0] < LEAST_GAP * pair[1]) {
        return Err(format!(
            "the radii {inner} and {outer} of rings are too close for single precision: on a device they are to differ by \
             {LEAST_GAP} of themselves at least"
        ));
    }
    let squares = radii.iter().map(|r| ((r * r) as f32).to_bits());
    let rests = radii.iter().map(|r| ((r * r - f64::from((r * r) as f32)) as f32).to_bits());
    let angle = |bound: usize| std::f64::consts::PI * bound as f64 / layout.sectors() as f64;
    let between = (1..layout.sectors()).flat_map(|bound| {
        let (sine, cosine) = libm::sincos(angle(bound));
        [(cosine as f32).to_bits(), (sine as f32).to_bits()]
    });
    let orders = layout.order_bins();
    let first_orders = (1..orders.len()).map(|bin| orders.orders(bin).0);
    Ok(Bins {
        bounds: squares.chain(between).chain(first_orders).chain(rests).collect(),
        radii: radii.len() as u32,
        sectors: layout.sectors() as u32,
        order_bins: orders.len() as u32,
        faces: if walk.problem.parameters().thickness.is_finite() { 2 } else { 1 },
    })
}

/// Four words that a seed stands for, by the finalizer of SplitMix64 (G. L. Steele, D. Lea and C. H. Flood 2014, *Fast
/// splittable pseudorandom number generators*), which is one to one.
pub(crate) fn key(seed: u64) -> [u32; 4] {
    let mixed = |x: u64| {
        let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    };
    let golden = 0x9e37_79b9_7f4a_7c15;
    let (a, b) = (mixed(seed.wrapping_add(golden)), mixed(seed.wrapping_add(golden.wrapping_mul(2))));
    [a as u32, (a >> 32) as u32, b as u32, (b >> 32) as u32]
}
