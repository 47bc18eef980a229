//! The comment at the head of a text: formula, source, units, ranges, errors, how it was made, and the licence.

use std::fmt::Write as _;

use translucid_profile::{
    AlbedoInversion, Configuration, Model, ParameterError, Parameterization, fresnel_moment_1_from_inside,
    fresnel_moment_1_from_outside, fresnel_moment_2_from_inside, fresnel_moment_2_from_outside, scaling,
};

use crate::Subject;
use crate::function::Function;
use crate::language::Language;
use crate::material::Material;
use crate::number::literal;
use crate::sum::Terms;

/// Licence of what is exported; translucid's own is another.
pub(crate) const LICENSE: &str = "MIT-0";

/// The light of a configuration in words.
pub(crate) fn light(configuration: Configuration) -> &'static str {
    match configuration {
        Configuration::Searchlight => "a pencil beam that enters perpendicularly",
        Configuration::Diffuse => "light that enters with a cosine distribution",
    }
}

/// Description of a model: its formula, as a sum if it is written as one, and its source.
pub(crate) fn of_model(model: Model, configuration: Configuration, is_summed: bool) -> String {
    let light = light(configuration);
    match model {
        Model::NormalizedDiffusionRefined => format!(
            "Normalized diffusion refined: the reflectance profile of a translucent surface, by four exponentials.

  R(r) = A/(2 pi r) sum_k w_k rate_k e^(-rate_k r)

w_k and mfp rate_k are polynomials of the surface albedo A, fitted by translucid to the exact half space of isotropic
scatterers (G. B. Rybicki 1971) for {light}; mean error 0.30 % (pencil beam) or 0.19 %
(cosine distribution). After P. H. Christensen and B. Burley, Approximate Reflectance Profiles for Efficient Subsurface
Scattering, Pixar Technical Memo 15-04, 2015.

A is in [0, 1], mean free paths in [1e-18, 1e18]."
        ),
        Model::NormalizedDiffusionOblique => format!(
            "Normalized diffusion of an oblique beam: the reflectance profile over radius and azimuth.

  R(r, phi) = E/(2 pi r) sum_k w_k rate_k e^(-rate_k r) cos_k / (1 - sin_k cos phi)

phi = 0 is where the beam is tilted to. w_k, mfp rate_k and the angle k are polynomials of the surface albedo A and of
1 - sqrt(cos theta), fitted by translucid to the exact half space of isotropic scatterers (G. B. Rybicki 1971) up to
85 degrees inside the medium: mean error 4.9 %, worst 14.7 %. A is the surface albedo for
{light}.

A and cos theta are in [0, 1], mean free paths in [1e-18, 1e18]."
        ),
        _ if is_summed => {
            let (terms, formula) = match Terms::of(model) {
                Terms::Exponentials => {
                    ("four exponentials", "A/(2 pi r) sum_k w_k rate_k e^(-rate_k r)")
                }
                Terms::Gaussians => ("six Gaussians", "A/(2 pi) sum_k w_k e^(-r^2/2v_k) / v_k"),
            };
            let source = match model {
                Model::Gaussians => format!(
                    "They are translucid's fit to the exact half space of isotropic scatterers (G. B. Rybicki 1971) for
{light}; mean error 4.6 % (pencil beam) or 4.2 % (cosine distribution)."
                ),
                _ => String::from(
                    "They are fitted to the model's profile by least squares; how far they are from it stands at their function.",
                ),
            };
            let zero = match Terms::of(model) {
                Terms::Exponentials => "",
                Terms::Gaussians => "\ngaussians_pdf counts as 0 below 4e-37 of sum_k w_k/sqrt(v_k).",
            };
            format!(
                "{}: the reflectance profile of a material, by {terms} a channel.

  R(r) = {formula}

{source}
Errors below are those of a material of the tests.{zero}",
                model.description()
            )
        }
        Model::NormalizedDiffusion => String::from(
            "Normalized diffusion: the reflectance profile of a translucent surface.

  R(r) = A (e^(-r/d) + e^(-r/3d)) / (8 pi d r),    d = length / s(A)

B. Burley, Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering, SIGGRAPH 2015 course notes;
P. H. Christensen and B. Burley, Approximate Reflectance Profiles for Efficient Subsurface Scattering, Pixar Technical
Memo 15-04, 2015, equations 3, 5, 6, 8. US patent 9,659,404 B2 is about it.

The surface albedo A is in [0, 1], the width d in [1e-18, 1e18].",
        ),
        _ => format!("{}, for {light}.", model.description()),
    }
}

/// Description of a subject that a model's description does not cover.
pub(crate) fn of_subject(subject: Subject) -> Option<&'static str> {
    match subject {
        Subject::Probe => Some(
            "Entry points of light that leaves at a point of any shape: segments along three axes, each hit weighted by the
density of all axes and channels (A. King, C. Kulla, A. Conty and M. Fajardo, BSSRDF Importance Sampling, SIGGRAPH 2013
talks; here as it has to be where surfaces are curved or thin). Read it from step 1 to step 3. The error of a segment
below is one of most_radius; tests also bring light through a plane and a slab, as theory says.",
        ),
        Subject::Fresnel => Some(
            "Reflectance of a smooth dielectric boundary for unpolarized light.

A.-J. Fresnel 1823, as in M. Born and E. Wolf, Principles of Optics, section 1.5.2; C. Schlick, An Inexpensive BRDF Model
for Physically-based Rendering, 1994, equation 15. eta = n_inside / n_outside is in [0.05, 20], whichever side the light
comes from.",
        ),
        Subject::Inversion => Some(
            "From surface albedo to single-scattering albedo: what a random walk through the volume needs.

S. Chandrasekhar, Radiative Transfer, 1950, for isotropic scattering; discrete ordinates by translucid where there is a
phase function of L. G. Henyey and J. L. Greenstein or a boundary. The surface albedo is the share of the light that
entered which leaves again. Errors below come on top of that of the fit, which stands at its function.",
        ),
        Subject::Material => Some(
            "A material with the subsurface scattering of OpenPBR Surface: subsurface_color is the surface albedo, and
subsurface_radius times subsurface_radius_scale the mean free path, in the unit of the scene. A host that shades
MaterialX's subsurface_bsdf by the shaders that MaterialX generates takes the latter for the width of a profile.",
        ),
        Subject::Transmittance => Some(
            "Light through thin parts of a material: the transmittance of plane slabs by their thickness, between air.

Discrete directions (S. Chandrasekhar, Radiative Transfer, 1950) to 1e-6, for isotropic scattering or a phase function of
L. G. Henyey and J. L. Greenstein, with the faces of an index of refraction other than 1.",
        ),
        Subject::Profile | Subject::Sampler | Subject::Disk | Subject::Lut | Subject::Kernel => None,
    }
}

/// Constants in WGSL: the angular moments of a boundary's reflectance.
pub(crate) fn moments(eta: f64) -> String {
    let line = |name: &str, value: f64| format!("const FRESNEL_{name}: f32 = {};\n", literal(value));
    String::from(
        "\n// Moments: integrals of F(mu) mu and F(mu) mu^2 over mu in [0, 1]. Twice the first is the reflectance of diffuse light.\n",
    ) + &line("ETA", eta)
        + &line("MOMENT_1_FROM_OUTSIDE", fresnel_moment_1_from_outside(eta))
        + &line("MOMENT_2_FROM_OUTSIDE", fresnel_moment_2_from_outside(eta))
        + &line("MOMENT_1_FROM_INSIDE", fresnel_moment_1_from_inside(eta))
        + &line("MOMENT_2_FROM_INSIDE", fresnel_moment_2_from_inside(eta))
}

/// Units and arguments of all profiles.
pub(crate) const UNITS: &str = "\
Lengths are in one unit that you keep to; R and densities per area are in its inverse square, densities per length in
its inverse. r is any number; a negative one counts as 0. Random numbers are in [0, 1).";

/// How long the diffuse mean free paths of a material are, which depends on how light enters.
pub(crate) fn of_diffuse_lengths(
    material: &Material,
    configuration: Configuration,
    [g, eta]: [f64; 2],
) -> Result<String, ParameterError> {
    let Material { surface_albedo, length, .. } = *material;
    let listed = |mfp: &dyn Fn(usize) -> f64| [0, 1, 2].map(|c| format!("{:.4}", mfp(c))).join(", ");
    let exact = |configuration| {
        let inversion = AlbedoInversion::new(g, eta, configuration)?;
        Ok::<_, ParameterError>(listed(&|c| {
            inversion.mfp(surface_albedo[c], length[c], Parameterization::Dmfp)
        }))
    };
    let fitted = |c: usize| {
        let scale = |parameterization| scaling(surface_albedo[c], parameterization, configuration);
        length[c] * scale(Parameterization::Mfp) / scale(Parameterization::Dmfp)
    };
    Ok(format!(
        "The material's lengths are diffuse mean free paths. The mean free paths behind them depend on how light enters:

  {}  a perpendicular pencil beam, exactly{}
  {}  light from all directions, exactly{}
  {}  by the fits of normalized diffusion, which it takes here and translucid convert everywhere

translucid judge and diffuse rows of the oracle's tables mean light from all directions.",
        exact(Configuration::Searchlight)?,
        if configuration == Configuration::Searchlight { " (meant here)" } else { "" },
        exact(Configuration::Diffuse)?,
        if configuration == Configuration::Diffuse { " (meant here)" } else { "" },
        listed(&fitted)
    ))
}

/// Errors of functions against double precision, in a language, with names of another.
pub(crate) fn errors(functions: &[Function], language: Language, names: Language) -> String {
    let mut text = String::from(
        "Largest relative errors against double precision, asserted on 100,000 points over these ranges and their ends
(values below 2.4e-38 of that at r = 0 count as 0; a sampler may choose another term where a random number is within
a millionth of its end). Devices may add what their exp and log are off: these are for exact ones, OSL's its own.\n",
    );
    let names: Vec<String> = functions.iter().map(|function| names.function_name(function.name)).collect();
    let width = names.iter().map(String::len).max().unwrap_or(0);
    for (name, function) in names.iter().zip(functions) {
        // Writing to a string cannot fail
        let _ = write!(text, "\n  {name:<width$}  {:e}", function.error_in(language));
    }
    text
}

/// Who made the text, and what others may do with it.
pub(crate) fn origin(command: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!(
        "Made by translucid {version}: {command}
SPDX-License-Identifier: {LICENSE}: paste it anywhere, no notice needed; there is no warranty."
    )
}

/// Paragraphs as a comment.
pub(crate) fn comment(paragraphs: &[String]) -> String {
    let lines = paragraphs.join("\n\n");
    lines.lines().map(|line| format!("// {line}").trim_end().to_owned() + "\n").collect()
}
