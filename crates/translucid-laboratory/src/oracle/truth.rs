//! Media whose light is known, exactly or by photons.

use translucid_profile::{AlbedoInversion, Configuration, ParameterError};
use translucid_reference::exact::{HalfSpace, single_scattering_albedo};
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_reference::walk::{
    AtAlbedo, Control, Layout, Parameters, PhaseFunction, Problem, Region, Side, WhiteTable,
};
use translucid_reference::{Estimate, Incidence, specular_reflectance};

use super::lit_shape::LitShape;
use crate::comparison::Watch;

/// A kind of half space: everything but its absorption.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kind {
    pub(super) configuration: Configuration,
    pub(super) g: f64,
    pub(super) eta: f64,
}

/// Light of one half space by radius, in mean free paths.
pub(super) enum Truth<'a> {
    /// With the factor that its errors take.
    Exact(Box<HalfSpace>, f64),
    Walk(AtAlbedo<'a>, &'a WhiteTable),
}

/// Kinds with a phase function or a boundary of their own.
const KINDS: [(f64, f64); 6] = [(0.0, 1.4), (-0.5, 1.0), (0.5, 1.0), (0.8, 1.0), (0.9, 1.0), (0.8, 1.4)];
/// Surface albedos of the plain kinds, and of all others.
const ALBEDOS: [f64; 13] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.98];
const FEW_ALBEDOS: [f64; 5] = [0.2, 0.5, 0.8, 0.9, 0.95];
/// Radii of a decade of the profiles, preferred numbers of ISO 3 (R10), and the decades, by the length of [`Kind::reach`].
const DECADE: [f64; 10] = [1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0];
const DECADES: [f64; 4] = [0.01, 0.1, 1.0, 10.0];
/// Rings of a walk in a decade, and the exponents at which they begin and end.
const RINGS: i32 = 60;
const EXPONENTS: [i32; 2] = [-3, 3];
/// Greatest width of the rings around those radii, by the radius and by the length of [`Kind::reach`].
const WIDTH: [f64; 2] = [0.02, 0.05];

impl Kind {
    /// All kinds that have profiles.
    pub(super) fn all() -> Vec<Self> {
        let kinds = [(0.0, 1.0)].into_iter().chain(KINDS);
        let both = |(g, eta)| CONFIGURATIONS.map(|configuration| Self { configuration, g, eta });
        kinds.flat_map(both).collect()
    }

    /// Surface albedos of the profiles of this kind.
    pub(super) fn surface_albedos(&self) -> &'static [f64] {
        if self.g == 0.0 && self.eta == 1.0 { &ALBEDOS } else { &FEW_ALBEDOS }
    }

    /// Whether the light of this kind is known exactly by radius.
    pub(super) fn is_exact(&self) -> bool {
        self.g == 0.0
    }

    pub(super) fn incidence(&self) -> Incidence {
        self.configuration.into()
    }

    /// Length by which light of this kind forgets its direction, in mean free paths, where nothing is absorbed; at least 1.
    pub(super) fn reach(&self) -> f64 {
        1.0 / (1.0 - self.g.max(0.0))
    }

    /// Radii of its profiles, in mean free paths.
    pub(super) fn radii(&self) -> Vec<f64> {
        let radii = DECADES.iter().flat_map(|decade| DECADE.map(|r| decade * r)).chain([100.0]);
        radii.map(|r| self.reach() * r).collect()
    }

    /// Surface albedo of a medium, and the error of that.
    pub(super) fn surface_albedo(&self, alpha: f64) -> Result<Estimate, ParameterError> {
        if self.is_exact() && self.eta == 1.0 {
            return Ok(HalfSpace::new(alpha, self.incidence())?.total());
        }
        let layer = Layer::new(alpha, 1.0 - alpha, f64::INFINITY).with_g(self.g).with_eta(self.eta);
        let layers = Layers::new(1.0, vec![layer], Ground::None).map_err(|error| error.error)?;
        let totals = layers.totals(self.incidence())?;
        let entered = 1.0 - specular_reflectance(self.incidence(), self.eta);
        Ok(Estimate { value: totals.diffuse_reflectance / entered, error: totals.error / entered })
    }

    /// Single-scattering albedos of the half spaces whose light by radius is wanted: by the exact solution where it is that
    /// which the light is taken from.
    pub(super) fn media(&self, surface_albedos: &[f64]) -> Result<Vec<f64>, ParameterError> {
        if self.is_exact() {
            let exact = |a: &f64| single_scattering_albedo(*a, self.eta, self.incidence());
            return surface_albedos.iter().map(exact).collect();
        }
        Ok(self.single_scattering_albedos(surface_albedos)?.into_iter().map(|[alpha, _]| alpha).collect())
    }

    /// Single-scattering albedos of the half spaces of some surface albedos, and the errors of the surface albedos that
    /// those have.
    pub(super) fn single_scattering_albedos(
        &self,
        surface_albedos: &[f64],
    ) -> Result<Vec<[f64; 2]>, ParameterError> {
        if self.is_exact() && self.eta == 1.0 {
            let exact = |a: &f64| {
                let alpha = single_scattering_albedo(*a, 1.0, self.incidence())?;
                Ok([alpha, 1e-12])
            };
            return surface_albedos.iter().map(exact).collect();
        }
        let inversion = AlbedoInversion::new(self.g, self.eta, self.configuration)?;
        let solve = |a: &f64| {
            // The tabulated inversion is off by 2e-5 to 2e-4 of A, by which it is asked again
            let mut asked = *a;
            let mut best = [0.0, f64::INFINITY];
            for _ in 0..2 {
                let alpha = inversion.single_scattering_albedo(asked);
                let found = self.surface_albedo(alpha)?;
                let off = found.value - a;
                if off.abs() + found.error < best[1] {
                    best = [alpha, off.abs() + found.error];
                }
                if off.abs() < 1e-6 {
                    break;
                }
                asked = (asked - off).clamp(0.0, 1.0);
            }
            Ok(best)
        };
        surface_albedos.iter().map(solve).collect()
    }

    /// Photons that walk for all albedos up to the greatest one.
    pub(super) fn walk(
        &self,
        greatest_alpha: f64,
        photons: u64,
        watch: &Watch<'_>,
    ) -> Result<WhiteTable, Fault> {
        let width = |r: f64| f64::min(WIDTH[0] * r, WIDTH[1] * self.reach());
        let exponent = |i: i32| f64::from(i) / f64::from(RINGS);
        let rings = (EXPONENTS[0] * RINGS..=EXPONENTS[1] * RINGS)
            .map(|i| self.reach() * libm::pow(10.0, exponent(i)));
        // The narrow rings of the profiles stay whole
        let is_free = |edge: &f64| self.radii().iter().all(|r| (edge - r).abs() > 1.01 * width(*r));
        let mut radii: Vec<f64> = rings.filter(is_free).collect();
        radii.extend(self.radii().into_iter().flat_map(|r| [r - width(r), r, r + width(r)]));
        radii.sort_by(f64::total_cmp);
        let problem = Problem::new(Parameters {
            phase_function: PhaseFunction::HenyeyGreenstein { g: self.g },
            eta: self.eta,
            incidence: self.incidence(),
            ..Parameters::default()
        })?;
        let mut table = WhiteTable::new(problem, Layout::new(&radii, 1)?, greatest_alpha)?;
        let progress = |done: u64| (watch.progress)(done as f64 / photons as f64);
        let control = Control { stop: watch.stop, progress: &progress, ..Control::default() };
        match table.run(SEED, photons, &control) {
            Ok(done) if done == photons => Ok(table),
            _ => Err(Fault::Stopped),
        }
    }
}

/// Both configurations.
pub(super) const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];
/// Seed of all photons.
pub(super) const SEED: u64 = 1;

/// Why there is no table.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Fault {
    Stopped,
    Parameter(ParameterError),
}

impl From<ParameterError> for Fault {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

/// Errors under a boundary by the estimates of the solution, which compare two rules over directions that are much alike.
const BOUNDARY_MARGIN: f64 = 50.0;

fn widened(Estimate { value, error }: Estimate, margin: f64) -> Estimate {
    Estimate { value, error: margin * error }
}

impl<'a> Truth<'a> {
    /// The light of the medium of a kind, by the walk of that kind if it has one.
    pub(super) fn of(kind: &Kind, alpha: f64, walk: Option<&'a WhiteTable>) -> Result<Self, ParameterError> {
        match walk {
            Some(table) => Ok(Self::Walk(table.at_albedo(alpha)?, table)),
            None => {
                let half_space = HalfSpace::with_boundary(alpha, kind.eta, kind.incidence())?;
                Ok(Self::Exact(Box::new(half_space), if kind.eta == 1.0 { 1.0 } else { BOUNDARY_MARGIN }))
            }
        }
    }

    /// How it is known, in a word.
    pub(super) fn method(&self) -> &'static str {
        match self {
            Self::Exact(..) => "exact",
            Self::Walk(..) => "walk",
        }
    }

    /// Surface albedo A.
    pub(super) fn total(&self) -> Estimate {
        match self {
            Self::Exact(half_space, margin) => widened(half_space.total(), *margin),
            Self::Walk(at, _) => at.total(Side::Reflected),
        }
    }

    /// R at one of the kind's radii, and the light within it; of a walk R is the mean over narrow rings on both sides.
    pub(super) fn at_radius(&self, r: f64) -> [Estimate; 2] {
        match self {
            Self::Exact(half_space, margin) => {
                [half_space.eval(r), half_space.enclosed(r)].map(|found| widened(found, *margin))
            }
            Self::Walk(at, table) => {
                let edge = table.layout().radii().partition_point(|edge| *edge < r * (1.0 - 1e-9));
                // The two rings on both sides: their mean is R(r) but for its curvature
                let energy = [edge, edge + 1].map(|ring| at.ring(Side::Reflected, ring));
                let area =
                    [edge, edge + 1].map(|ring| table.layout().area(Region::Ring(ring))).iter().sum::<f64>();
                let reflectance = Estimate {
                    value: (energy[0].value + energy[1].value) / area,
                    error: energy[0].error.hypot(energy[1].error) / area,
                };
                [reflectance, at.enclosed(Side::Reflected, edge)]
            }
        }
    }

    /// Light beside a lit shape, as [`LitShape::response`].
    pub(super) fn response(&self, shape: &LitShape) -> Estimate {
        match self {
            Self::Exact(half_space, margin) => widened(shape.response(&**half_space), *margin),
            Self::Walk(at, table) => {
                let photons = table.photons() as f64;
                let radii = table.layout().radii();
                let (mut first, mut second) = (0.0, 0.0);
                for ring in 0..table.layout().rings() {
                    let inner = ring.checked_sub(1).map_or(0.0, |i| radii[i]);
                    let outer = radii.get(ring).copied().unwrap_or(2.0 * inner);
                    // Of a narrow ring each width has the same light
                    let part = |i: i32| {
                        shape.lit_part_of_circle(inner + (f64::from(i) + 0.5) / 8.0 * (outer - inner))
                    };
                    let lit = (0..8).map(part).sum::<f64>() / 8.0;
                    let Estimate { value, error } = at.ring(Side::Reflected, ring);
                    first += lit * value;
                    // A photon leaves through one ring: second moments add up
                    second += lit * lit * (error * error * (photons - 1.0) + value * value);
                }
                let variance = (second - first * first).max(0.0) / (photons - 1.0);
                Estimate { value: first, error: variance.sqrt() }
            }
        }
    }
}
