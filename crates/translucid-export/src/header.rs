//! The comment at the head of a text: formula, source, units, ranges, errors, how it was made, and the licence.

use std::fmt::Write as _;

use translucid_profile::{Configuration, Model};

use crate::function::Function;
use crate::language::Language;

/// Licence of what is exported; translucid's own is another.
pub(crate) const LICENSE: &str = "MIT-0";

/// What a model is: its formula and where it comes from.
pub(crate) fn of_model(model: Model, configuration: Configuration) -> String {
    let light = match configuration {
        Configuration::Searchlight => "a pencil beam that enters perpendicularly",
        Configuration::Diffuse => "light that enters with a cosine distribution",
    };
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
        _ => String::from(
            "Normalized diffusion: the reflectance profile of a translucent surface.

  R(r) = A (e^(-r/d) + e^(-r/3d)) / (8 pi d r),    d = length / s(A)

B. Burley, Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering, SIGGRAPH 2015 course notes;
P. H. Christensen and B. Burley, Approximate Reflectance Profiles for Efficient Subsurface Scattering, Pixar Technical
Memo 15-04, 2015, equations 3, 5, 6, 8. US patent 9,659,404 B2 is about it.

The surface albedo A is in [0, 1], the width d in [1e-18, 1e18].",
        ),
    }
}

/// Units and arguments of all profiles.
pub(crate) const UNITS: &str = "\
Lengths are in one unit that you keep to; R and densities per area are in its inverse square, densities per length in
its inverse. r is any number; a negative one counts as 0. Random numbers are in [0, 1).";

/// How far functions are from double precision.
pub(crate) fn errors(functions: &[Function], language: Language) -> String {
    let mut text = String::from(
        "Largest relative errors against double precision, asserted on 100,000 points over these ranges and their ends
(values below 2.4e-38 of that at r = 0 count as 0; a sampler may choose another term where a random number is within
a millionth of its end). Devices may add what their exp and log are off: these are for exact ones, OSL's its own.\n",
    );
    let names: Vec<String> = functions.iter().map(|function| language.function_name(function.name)).collect();
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
