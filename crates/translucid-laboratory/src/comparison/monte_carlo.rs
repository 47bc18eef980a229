//! Photons that walk, as a witness that owes the exact solution nothing.

use translucid_profile::{Configuration, ParameterError, Profile};
use translucid_reference::walk::{Control, Layout, Parameters, Problem, Region, Side, WhiteTable};

use super::Reference;
use super::watch::{Progress, Stopped};

/// A walk whose one set of photons serves every surface albedo.
#[derive(Clone, Debug)]
pub struct Walk {
    table: WhiteTable,
    radii: Vec<f64>,
}

/// Light that leaves through a narrow ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingPoint {
    /// Radius of the ring's middle, in mean free paths.
    pub r: f64,
    /// Mean of R over the ring, as the walk has it.
    pub reflectance: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Mean of R over the same ring, by the exact solution.
    pub exact: f64,
    /// Photons of equal weight that would have the same relative error.
    pub photons: f64,
}

impl RingPoint {
    /// Distance of the walk above the exact solution, in standard errors.
    pub fn deviate(&self) -> f64 {
        (self.reflectance - self.exact) / self.standard_error
    }
}

impl Walk {
    /// Rings per figure.
    pub const RINGS: usize = 20;
    /// Highest single-scattering albedo at which photons walk: they collide a hundred times then, and above it do so
    /// for ever longer. A surface albedo of more than 0.972 or 0.977 (diffuse) has no points.
    pub const HIGHEST_ALBEDO: f64 = 0.9999;
    /// Photons that a ring must have seen to be shown: then its error is known to a tenth, and is normally distributed.
    pub const FEWEST_PHOTONS: f64 = 50.0;

    /// Sends photons into the half space, so many that serve all albedos of the references of one configuration.
    ///
    /// The radii are spread evenly in ln r up to 0.9 `max_radius`. The table's bits are a
    /// function of seed and number alone.
    ///
    /// # Errors
    /// The walk was stopped. Without an albedo in reach there is no walk.
    pub(super) fn new(
        references: &[&Reference],
        max_radius: f64,
        seed: u64,
        photons: u64,
        progress: &Progress<'_>,
    ) -> Result<Option<Self>, Stopped> {
        let albedos = references.iter().map(|reference| reference.single_scattering_albedo());
        let highest = albedos.filter(|alpha| *alpha <= Self::HIGHEST_ALBEDO).fold(0.0, f64::max);
        let (Some(reference), true) = (references.first(), highest > 0.0 && photons > 0) else {
            return Ok(None);
        };
        // Only a defect could be reported here, and a figure without points is less than none
        let Ok(mut table) = empty_table(reference.configuration, highest, max_radius) else {
            return Ok(None);
        };
        let before = std::sync::atomic::AtomicU64::new(0);
        let report = |done: u64| {
            let done = Self::work(done);
            let known = before.fetch_max(done, std::sync::atomic::Ordering::Relaxed);
            progress.add(done.saturating_sub(known));
        };
        let control = Control { stop: progress.stop(), progress: &report, ..Control::default() };
        let walked = table.run(seed, photons, &control);
        progress.check()?;
        Ok(walked.is_ok_and(|walked| walked == photons).then(|| Self { table, radii: radii(max_radius) }))
    }

    /// Cost of a walk, in the units of progress: milliseconds, at some 20 collisions a photon.
    pub(super) fn work(photons: u64) -> u64 {
        photons / 20_000
    }

    /// The rings at the albedo of a reference, but for those that too few photons have seen; none for an albedo above
    /// those of the walk.
    pub fn points(&self, reference: &Reference) -> Vec<RingPoint> {
        let Ok(at) = self.table.at_albedo(reference.single_scattering_albedo()) else { return Vec::new() };
        let side = Side::Reflected;
        let edges = self.table.layout().radii();
        let point = |(i, r): (usize, &f64)| {
            // Three edges around each radius, and a ring on either side of the middle one
            let [inner, outer] = [edges[3 * i], edges[3 * i + 2]];
            let photons: f64 = [3 * i + 1, 3 * i + 2]
                .map(|ring| at.effective_photons(side, Region::Ring(ring)))
                .iter()
                .sum();
            let found = at.at_radius(side, *r).ok().filter(|_| photons >= Self::FEWEST_PHOTONS)?.reflectance;
            let area = std::f64::consts::PI * (outer * outer - inner * inner);
            let exact = (reference.exact.enclosed(outer) - reference.exact.enclosed(inner)) / area;
            Some(RingPoint { r: *r, reflectance: found.value, standard_error: found.error, exact, photons })
        };
        self.radii.iter().enumerate().filter_map(point).collect()
    }
}

fn radii(max_radius: f64) -> Vec<f64> {
    let (least, last) = (0.04f64, (Walk::RINGS - 1) as f64);
    // The last one stays clear of the edge of a figure
    let ratio = (0.9 * max_radius.max(0.2) / least).powf(1.0 / last);
    (0..Walk::RINGS as i32).map(|i| least * ratio.powi(i)).collect()
}

fn empty_table(
    configuration: Configuration,
    albedo: f64,
    max_radius: f64,
) -> Result<WhiteTable, ParameterError> {
    let problem = Problem::new(Parameters { incidence: configuration.into(), ..Parameters::default() })?;
    WhiteTable::new(problem, Layout::around(&radii(max_radius))?, albedo)
}
