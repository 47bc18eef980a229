//! The tables: their columns, how their numbers were obtained, and by what else they are tested.

use translucid_profile::{AlbedoInversion, Medium};
use translucid_reference::Estimate;
use translucid_reference::body::{Body, Interior, Lighting, SPHERE_RINGS, Shape};
use translucid_reference::layers::{Ground, Layer, Layers};

use super::Steps;
use super::lit_shape::LitShape;
use super::table::{Rows, Source, Table};
use super::text::{error, number};
use super::truth::{CONFIGURATIONS, Fault, Kind, SEED, Truth};
use translucid_words::{Cell, Column};

use crate::data_table::row;

/// Columns by name, unit and meaning.
fn columns(list: &[(&'static str, &'static str, &'static str)]) -> Vec<Column> {
    list.iter().map(|&(name, unit, meaning)| Column::new(name, unit, meaning)).collect()
}

const CONFIGURATION: (&str, &str, &str) = (
    "configuration",
    "1",
    "searchlight: a perpendicular pencil of light enters; diffuse: light enters from all directions",
);
const G: (&str, &str, &str) = ("g", "1", "mean cosine of the phase function (Henyey and Greenstein)");
const ETA: (&str, &str, &str) =
    ("eta", "1", "relative index of refraction, inside over outside, of the smooth boundary");
const A: (&str, &str, &str) =
    ("surface_albedo", "1", "share of the light that has entered which leaves again");
const ALPHA: (&str, &str, &str) = (
    "single_scattering_albedo",
    "1",
    "scattering over extinction in the volume: that of the medium, to rounding",
);
const ERROR: (&str, &str, &str) =
    ("error", "1", "greatest numerical error of the exact solution; one standard error of a walk");
const METHOD: (&str, &str, &str) = (
    "method",
    "1",
    "exact: half space solved by quadratures; layers: discrete directions; walk: photons at random",
);

/// Surface albedo of a medium that was chosen for it.
const A_OF_MEDIUM: (&str, &str, &str) = (
    "surface_albedo",
    "1",
    "share of the light that has entered which leaves again: that of the medium to 1e-8 for g = 0, and to 2e-6 otherwise",
);

/// Columns of a table of half spaces around its own.
fn of_half_spaces(own: &[(&'static str, &'static str, &'static str)]) -> Vec<Column> {
    columns(&[&[CONFIGURATION, G, ETA, A_OF_MEDIUM, ALPHA], own, &[METHOD]].concat())
}

const METHOD_OF_PROFILE: &str = "g = 0: the half space solved exactly, errors: estimates of the greatest numerical error, under a boundary 50 times the solution's own estimate. Other g: a walk of photons (seed 1), errors: one standard error, or one photon of the greatest weight where none has left; R is then the mean over two rings that are 2 % of the radius wide or less.";
const METHOD_OF_SHAPES: &str = "The lit part of each circle around the place, times the light that leaves at its radius. g = 0: by the half space solved exactly, error: an estimate of the greatest numerical error, under a boundary 50 times the solution's own estimate. Other g: by rings of a walk of photons (seed 1), error: one standard error, or one photon of the greatest weight where none has left.";

/// All tables.
pub(super) fn all() -> Vec<Table> {
    vec![
        Table {
            name: "profile",
            content: "Light R(r) that leaves a half space at the distance r from where one unit of light has entered, and the light within r",
            method: METHOD_OF_PROFILE,
            check: "exact rows against a photon walk, ring by ring; rows of a walk against layers by wave number, which share no code with it",
            columns: of_half_spaces(&[
                ("r", "mfp", "distance from the point of entry"),
                ("reflectance", "mfp^-2", "R(r), light that leaves per area"),
                ("reflectance_error", "mfp^-2", "its error"),
                ("enclosed", "1", "light that leaves within r"),
                ("enclosed_error", "1", "its error"),
            ]),
            source: Source::HalfSpaces(profile),
        },
        Table {
            name: "edge",
            content: "Step edge: half of a plane is lit evenly; the light that leaves at a distance from the edge, as a part of the light that leaves far from the edge on the lit side",
            method: METHOD_OF_SHAPES,
            check: "a sum over rings of the plane, and photons one by one, counted by where they leave",
            columns: of_half_spaces(&[
                ("distance", "mfp", "distance from the edge"),
                ("dark", "1", "light at that distance on the dark side"),
                ("lit", "1", "light at that distance on the lit side, 1 - dark"),
                ERROR,
            ]),
            source: Source::HalfSpaces(edge),
        },
        Table {
            name: "disk",
            content: "Small feature: a disk of a plane is lit evenly; the light that leaves at a distance from its center, as a part of that in the middle of a very large disk",
            method: METHOD_OF_SHAPES,
            check: "a sum over rings of the plane; photons one by one; the walk from a disk of light",
            columns: of_half_spaces(&[
                ("radius", "mfp", "radius of the disk"),
                ("offset", "mfp", "distance of the place from the center"),
                ("response", "1", "light that leaves at the place"),
                ERROR,
            ]),
            source: Source::HalfSpaces(disk),
        },
        Table {
            name: "line",
            content: "Thin line: a band of a plane is lit evenly; the light that leaves at a distance from its middle, as a part of that in the middle of a very wide band",
            method: METHOD_OF_SHAPES,
            check: "a sum over rings of the plane, and photons one by one, counted by where they leave",
            columns: of_half_spaces(&[
                ("width", "mfp", "width of the band"),
                ("offset", "mfp", "distance of the place from the line in its middle"),
                ("response", "1", "light that leaves at the place"),
                ERROR,
            ]),
            source: Source::HalfSpaces(line),
        },
        Table {
            name: "totals",
            content: "Surface albedo of half spaces by their single-scattering albedo",
            method: "g = 0 and eta = 1: exact; others: discrete directions, error: twice the difference between two rules of them.",
            check: "the exact solution with a boundary for g = 0, a photon walk for other g",
            columns: columns(&[
                CONFIGURATION,
                G,
                ETA,
                ALPHA,
                A,
                ERROR,
                (
                    "specular_reflectance",
                    "1",
                    "share of the arriving light that the boundary reflects, no part of the surface albedo",
                ),
                METHOD,
            ]),
            source: Source::Own(totals),
        },
        Table {
            name: "inversion",
            content: "Albedo inversion: the medium whose half space has a surface albedo, and its diffuse mean free path",
            method: "The root of the totals. dmfp = sqrt(D / sigma_a) of the similar isotropic medium with Grosjean's D = (2 sigma_a + sigma_s') / (3 (sigma_a + sigma_s')^2).",
            check: "the exact inversion with a boundary for g = 0, a photon walk for other g",
            columns: columns(&[
                CONFIGURATION,
                G,
                ETA,
                A,
                ALPHA,
                ("surface_albedo_error", "1", "greatest error of the surface albedo that this medium has"),
                ("reduced_albedo", "1", "sigma_s' / (sigma_a + sigma_s')"),
                ("dmfp", "mfp", "diffuse mean free path; the mean free path is 1 / dmfp in its unit"),
                (
                    "single_scattering_albedo_error",
                    "1",
                    "greatest error of the single-scattering albedo of the surface albedo, from surface_albedo_error",
                ),
                ("reduced_albedo_error", "1", "that of the reduced albedo"),
                ("dmfp_error", "mfp", "that of the diffuse mean free path"),
                METHOD,
            ]),
            source: Source::Own(inversion),
        },
        Table {
            name: "slabs",
            content: "Light that arrives at a slab in air, by where it goes",
            method: "Discrete directions; error: twice the difference between two rules of them.",
            check: "photons in a slab, without code in common; all parts add up to 1",
            columns: columns(&[
                CONFIGURATION,
                G,
                ETA,
                ALPHA,
                ("thickness", "mfp", "thickness of the slab"),
                ("specular_reflectance", "1", "share that returns without having been scattered"),
                ("diffuse_reflectance", "1", "share that returns scattered"),
                ("collimated_transmittance", "1", "share that passes without having been scattered"),
                ("diffuse_transmittance", "1", "share that passes scattered"),
                ("absorbed", "1", "share that is absorbed"),
                ERROR,
            ]),
            source: Source::Own(slabs),
        },
        Table {
            name: "spheres",
            content: "Light that has entered a sphere, by where it leaves",
            method: "Photons at random (seed 1), one by one, absorbed or not; errors: one standard error. Where no photon was counted or every one was, the error is 3 / photons: the share is off by less with a confidence of 95 % (rule of three). Without absorption every photon leaves, and leaving is exact.",
            check: "without absorption all light leaves; what passes straight through is elementary; a large sphere returns the surface albedo of a plane",
            columns: columns(&[
                (
                    "light",
                    "1",
                    "uniform: equal radiance from everywhere; distant: parallel light from one side",
                ),
                G,
                ETA,
                ALPHA,
                ("radius", "mfp", "radius of the sphere"),
                ("leaving", "1", "share of the light that leaves"),
                ("leaving_error", "1", "its error"),
                ("straight", "1", "share that leaves without having been scattered"),
                ("straight_error", "1", "its error"),
                ("front", "1", "share that leaves scattered through the half that faces distant light"),
                ("front_error", "1", "its error"),
                ("back", "1", "share that leaves scattered through the other half"),
                ("back_error", "1", "its error"),
            ]),
            source: Source::Own(spheres),
        },
    ]
}

fn profile(kind: &Kind, truth: &Truth<'_>) -> Rows {
    let row = |r: f64| {
        let [reflectance, enclosed] = truth.at_radius(r);
        let [r, value, within] = [r, reflectance.value, enclosed.value].map(number);
        vec![r, value, error(reflectance.error), within, error(enclosed.error)]
    };
    kind.radii().into_iter().map(row).collect()
}

/// A response as a part of that of an endless lit plane.
fn part(truth: &Truth<'_>, shape: LitShape) -> [f64; 2] {
    let (response, total) = (truth.response(&shape), truth.total());
    let value = response.value / total.value;
    [
        value,
        (response.error + value * if matches!(truth, Truth::Exact(..)) { total.error } else { 0.0 })
            / total.value,
    ]
}

fn edge(kind: &Kind, truth: &Truth<'_>) -> Rows {
    let row = |distance: f64| {
        let [dark, off] = part(truth, LitShape::Edge { distance });
        vec![number(distance), number(dark), number(1.0 - dark), error(off)]
    };
    kind.radii().into_iter().map(row).collect()
}

/// Sizes of features by the length of [`Kind::reach`], and places in them by half of the size.
const SIZES: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
const OFFSETS: [f64; 6] = [0.0, 0.5, 1.0, 1.5, 2.0, 4.0];

/// Rows of features of each size at each place: half of the size, the place, and the cell of the size.
fn features(kind: &Kind, truth: &Truth<'_>, shape: impl Fn(f64, f64) -> (LitShape, f64)) -> Rows {
    let mut rows = Rows::new();
    for half in SIZES.map(|size| 0.5 * size * kind.reach()) {
        for offset in OFFSETS.map(|offset| offset * half) {
            let (shape, size) = shape(half, offset);
            let [value, off] = part(truth, shape);
            rows.push(vec![number(size), number(offset), number(value), error(off)]);
        }
    }
    rows
}

fn disk(kind: &Kind, truth: &Truth<'_>) -> Rows {
    features(kind, truth, |half, offset| (LitShape::Disk { radius: half, offset }, half))
}

fn line(kind: &Kind, truth: &Truth<'_>) -> Rows {
    features(kind, truth, |half, offset| (LitShape::Line { width: 2.0 * half, offset }, 2.0 * half))
}

/// Kinds of the tables without radii.
fn kinds() -> Vec<Kind> {
    let pairs =
        [-0.5, 0.0, 0.5, 0.8, 0.9].into_iter().flat_map(|g| [1.0, 1.33, 1.4, 1.5].map(|eta| (g, eta)));
    pairs.flat_map(|(g, eta)| CONFIGURATIONS.map(|configuration| Kind { configuration, g, eta })).collect()
}

fn method(kind: &Kind) -> &'static str {
    if kind.g == 0.0 && kind.eta == 1.0 { "exact" } else { "layers" }
}

fn totals(_photons: u64, steps: &Steps<'_>) -> Result<Rows, Fault> {
    const ALPHAS: [f64; 10] = [0.2, 0.4, 0.5, 0.6, 0.8, 0.9, 0.95, 0.99, 0.999, 0.9999];
    let rows = steps.each(&kinds(), |kind: &Kind| {
        let specular = translucid_reference::specular_reflectance(kind.incidence(), kind.eta);
        let row = |alpha: f64| {
            let Estimate { value, error: off } = kind.surface_albedo(alpha)?;
            let name = kind.configuration.name();
            Ok(row![name, kind.g, kind.eta, alpha, number(value), error(off), number(specular), method(kind)])
        };
        ALPHAS.map(row).into_iter().collect::<Result<Rows, Fault>>()
    })?;
    Ok(rows.concat())
}

fn inversion(_photons: u64, steps: &Steps<'_>) -> Result<Rows, Fault> {
    const ALBEDOS: [f64; 14] = [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99];
    let rows = steps.each(&kinds(), |kind: &Kind| {
        let alphas = kind.single_scattering_albedos(&ALBEDOS)?;
        let inversion = AlbedoInversion::new(kind.g, kind.eta, kind.configuration)?;
        let row = |(a, [alpha, off]): (&f64, &[f64; 2])| {
            let medium = Medium::from_mfp(*alpha, 1.0, kind.g)?;
            let name = kind.configuration.name();
            // The medium of a surface albedo that is off by its error; digits of 1 - alpha end at rounding
            let step = 1e-3 * (1.0 - a);
            let slope = [a + step, a - step].map(|a| inversion.single_scattering_albedo(a));
            let alpha_off = (slope[0] - slope[1]) / (2.0 * step) * off + f64::EPSILON;
            let other = Medium::from_mfp((alpha - alpha_off).max(0.0), 1.0, kind.g)?;
            let [reduced_off, dmfp_off] =
                [medium.alpha_prime() - other.alpha_prime(), medium.dmfp() - other.dmfp()]
                    .map(|x| error(x.abs()));
            let [alpha, reduced, dmfp] = [*alpha, medium.alpha_prime(), medium.dmfp()].map(number);
            let (off, alpha_off) = (error(*off), error(alpha_off));
            let mut row = row![name, kind.g, kind.eta, *a, alpha, off, reduced, dmfp, alpha_off];
            row.extend([reduced_off, dmfp_off, Cell::from(method(kind))]);
            Ok(row)
        };
        ALBEDOS.iter().zip(&alphas).map(row).collect::<Result<Rows, Fault>>()
    })?;
    Ok(rows.concat())
}

fn slabs(_photons: u64, steps: &Steps<'_>) -> Result<Rows, Fault> {
    const ALPHAS: [f64; 5] = [0.5, 0.9, 0.99, 0.999, 1.0];
    const THICKNESSES: [f64; 7] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
    let kinds: Vec<Kind> = kinds()
        .into_iter()
        .filter(|kind| [0.0, 0.8].contains(&kind.g) && [1.0, 1.4].contains(&kind.eta))
        .collect();
    let rows = steps.each(&kinds, |kind: &Kind| {
        let mut rows = Rows::new();
        for (alpha, thickness) in ALPHAS.into_iter().flat_map(|alpha| THICKNESSES.map(|t| (alpha, t))) {
            let layer = Layer::new(alpha, 1.0 - alpha, thickness).with_g(kind.g).with_eta(kind.eta);
            let layers = Layers::new(1.0, vec![layer], Ground::AIR).map_err(|error| error.error)?;
            let totals = layers.totals(kind.incidence())?;
            let parts = [
                totals.specular_reflectance,
                totals.diffuse_reflectance,
                totals.collimated_transmittance,
                totals.diffuse_transmittance,
                totals.absorbed.iter().sum(),
            ];
            let mut row = row![kind.configuration.name(), kind.g, kind.eta, alpha, thickness];
            row.extend(parts.map(number));
            row.push(error(totals.error));
            rows.push(row);
        }
        Ok(rows)
    })?;
    Ok(rows.concat())
}

fn spheres(photons: u64, steps: &Steps<'_>) -> Result<Rows, Fault> {
    const KINDS: [(f64, f64); 3] = [(0.0, 1.0), (0.0, 1.4), (0.8, 1.0)];
    const ALPHAS: [f64; 4] = [0.5, 0.9, 0.99, 1.0];
    const RADII: [f64; 5] = [0.5, 1.0, 2.0, 5.0, 10.0];
    let mut cases = Vec::new();
    for light in [Lighting::Uniform, Lighting::Distant] {
        for (kind, alpha) in KINDS.into_iter().flat_map(|kind| ALPHAS.map(|alpha| (kind, alpha))) {
            cases.extend(RADII.map(|radius| (light, kind, alpha, radius)));
        }
    }
    steps.each(&cases, |&(light, (g, eta), alpha, radius)| {
        let interior = Interior { single_scattering_albedo: alpha, g, eta };
        let tally = Body::new(Shape::Sphere { radius }, interior, light)?.walk(photons, SEED);
        let half = |rings: std::ops::Range<usize>| -> f64 {
            rings.map(|ring| tally.scattered_through(ring).value).sum()
        };
        let middle = SPHERE_RINGS / 2;
        let halves = [half(0..middle), half(middle..SPHERE_RINGS)];
        let off = |value: f64| error(error_of_share(value, photons as f64));
        let is_distant = light == Lighting::Distant;
        let mut row = row![if is_distant { "distant" } else { "uniform" }, g, eta, alpha, radius];
        let [leaving, straight] = [tally.leaving().value, tally.straight().value];
        row.extend([number(leaving), if alpha == 1.0 { error(0.0) } else { off(leaving) }]);
        row.extend([number(straight), off(straight)]);
        for value in halves {
            // Uniform light has no front
            let known = |cell: Cell| if is_distant { cell } else { Cell::Number(f64::NAN) };
            row.extend([known(number(value)), known(off(value))]);
        }
        Ok(row)
    })
}

/// Standard error of a share of photons; where none or all were counted, the share that is exceeded with a probability of 5 %
/// if that is what is counted: (1 − p)^n = 0.05.
fn error_of_share(value: f64, photons: f64) -> f64 {
    let error = (value * (1.0 - value) / photons).max(0.0).sqrt();
    if error * photons < 0.5 { 3.0 / photons } else { error }
}
