//! The functions that texts offer: what they are called with, and how far they are from double precision.

use translucid_profile::Model;

use crate::language::Language;
use crate::subject::Subject;
use crate::sum::Terms;
use crate::token::{Token, tokens};

/// A function of a text, as those who test it or feed it from buffers call it: numbers in, numbers out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Function {
    /// Name in WGSL.
    pub name: &'static str,
    /// Names of the numbers that a call takes.
    pub arguments: &'static [&'static str],
    /// The call in WGSL, in which the arguments stand by their names.
    pub call: &'static str,
    /// Fields of the result; one that is empty where it is a number itself.
    pub outputs: &'static [&'static str],
    /// Largest relative error against double precision that tests allow, on 100,000 points over all parameters; OSL's is
    /// [`error_in`](Self::error_in).
    ///
    /// Differences below 2.4e-38 of the value at r = 0 do not count, nor do those that a millionth of a random number makes
    /// where it chooses a term. The error of a coordinate is one of the radius.
    pub error: f64,
}

/// Largest relative error of OSL's own exponential, with some room.
const ERROR_OF_OSL: f64 = 3e-5;

impl Function {
    /// Largest relative error in a language: OSL approximates the exponential by a polynomial.
    pub fn error_in(&self, language: Language) -> f64 {
        if language == Language::Osl { self.error.max(ERROR_OF_OSL) } else { self.error }
    }

    /// Its call in a language, in which its arguments stand by their names.
    pub fn call_in(&self, language: Language) -> String {
        let pieces = tokens(self.call);
        let is_called = |i: usize| pieces.get(i + 1) == Some(&Token::Sign("("));
        let text = pieces.iter().enumerate().map(|(i, piece)| match piece {
            Token::Word(name) if is_called(i) => language.function_name(name),
            Token::Number(number) => language.number(number),
            piece => piece.text().to_owned(),
        });
        text.collect()
    }

    /// Names of the functions in the call.
    pub(crate) fn called(&self) -> impl Iterator<Item = &'static str> {
        let pieces = tokens(self.call);
        let called = pieces.windows(2).filter_map(|window| match window {
            [Token::Word(name), Token::Sign("(")] => Some(*name),
            _ => None,
        });
        called.collect::<Vec<_>>().into_iter()
    }
}

const fn function(
    name: &'static str,
    arguments: &'static [&'static str],
    call: &'static str,
    error: f64,
) -> Function {
    Function { name, arguments, call, outputs: &[""], error }
}

const BURLEY_SCALES: [Function; 4] = [
    function(
        "burley_scale_mfp_searchlight",
        &["surface_albedo"],
        "burley_scale_mfp_searchlight(surface_albedo)",
        1e-6,
    ),
    function(
        "burley_scale_mfp_diffuse",
        &["surface_albedo"],
        "burley_scale_mfp_diffuse(surface_albedo)",
        1e-6,
    ),
    function(
        "burley_scale_dmfp_searchlight",
        &["surface_albedo"],
        "burley_scale_dmfp_searchlight(surface_albedo)",
        1e-6,
    ),
    function("burley_width", &["length", "scale"], "burley_width(length, scale)", 1e-6),
];

const BURLEY_DENSITIES: [Function; 2] = [
    function("burley_pdf", &["r", "d"], "burley_pdf(r, d)", 1e-5),
    function("burley_pdf_area", &["r", "d"], "burley_pdf_area(r, d)", 1e-5),
];

const BURLEY_QUANTILE: Function = function("burley_quantile", &["u", "d"], "burley_quantile(u, d)", 1e-6);

const BURLEY_PROFILE: [Function; 4] = [
    function("burley_eval", &["surface_albedo", "r", "d"], "burley_eval(surface_albedo, r, d)", 1e-5),
    function(
        "burley_eval_times_r",
        &["surface_albedo", "r", "d"],
        "burley_eval_times_r(surface_albedo, r, d)",
        1e-5,
    ),
    function("burley_cdf", &["r", "d"], "burley_cdf(r, d)", 1e-6),
    function("burley_complementary_cdf", &["r", "d"], "burley_complementary_cdf(r, d)", 1e-5),
];

const BURLEY_SAMPLE: Function = function("burley_sample", &["u", "d"], "burley_sample(u, d)", 1e-6);

const REFINED_ARGUMENTS: &[&str] = &["surface_albedo", "length", "r"];

const REFINED_DENSITIES: [Function; 2] = [
    function("refined_pdf", REFINED_ARGUMENTS, "refined_pdf(refined_terms(surface_albedo, length), r)", 2e-5),
    function(
        "refined_pdf_area",
        REFINED_ARGUMENTS,
        "refined_pdf_area(refined_terms(surface_albedo, length), r)",
        2e-5,
    ),
];

const REFINED_PROFILE: [Function; 4] = [
    function(
        "refined_mfp_from_dmfp",
        &["surface_albedo", "length"],
        "refined_mfp_from_dmfp(surface_albedo, length)",
        1e-6,
    ),
    function(
        "refined_eval",
        REFINED_ARGUMENTS,
        "refined_eval(refined_terms(surface_albedo, length), r)",
        2e-5,
    ),
    function("refined_cdf", REFINED_ARGUMENTS, "refined_cdf(refined_terms(surface_albedo, length), r)", 1e-6),
    function(
        "refined_complementary_cdf",
        REFINED_ARGUMENTS,
        "refined_complementary_cdf(refined_terms(surface_albedo, length), r)",
        2e-5,
    ),
];

const REFINED_SAMPLE: Function = function(
    "refined_sample",
    &["surface_albedo", "length", "u"],
    "refined_sample(refined_terms(surface_albedo, length), u)",
    5e-6,
);

const OBLIQUE_ARGUMENTS: &[&str] = &["surface_albedo", "length", "cos_theta", "x", "y"];

const OBLIQUE_PDF_AREA: Function = function(
    "oblique_pdf_area",
    OBLIQUE_ARGUMENTS,
    "oblique_pdf_area(oblique_terms(surface_albedo, length, cos_theta), x, y)",
    3e-5,
);

const OBLIQUE_EVAL: Function = function(
    "oblique_eval",
    OBLIQUE_ARGUMENTS,
    "oblique_eval(oblique_terms(surface_albedo, length, cos_theta), x, y)",
    3e-5,
);

const OBLIQUE_SAMPLE: Function = Function {
    name: "oblique_sample",
    arguments: &["surface_albedo", "length", "cos_theta", "u", "turn"],
    call: "oblique_sample(oblique_terms(surface_albedo, length, cos_theta), u, turn)",
    outputs: &["x", "y"],
    error: 3e-5,
};

const CHANNEL_ARGUMENTS: &[&str] = &["channel", "r"];

const EXPONENTIALS_DENSITIES: [Function; 2] = [
    function(
        "exponentials_pdf",
        CHANNEL_ARGUMENTS,
        "exponentials_pdf(exponentials_of_channel(channel), r)",
        1e-5,
    ),
    function(
        "exponentials_pdf_area",
        CHANNEL_ARGUMENTS,
        "exponentials_pdf_area(exponentials_of_channel(channel), r)",
        1e-5,
    ),
];

const EXPONENTIALS_PROFILE: [Function; 3] = [
    function(
        "exponentials_eval",
        CHANNEL_ARGUMENTS,
        "exponentials_eval(exponentials_of_channel(channel), r)",
        1e-5,
    ),
    function(
        "exponentials_cdf",
        CHANNEL_ARGUMENTS,
        "exponentials_cdf(exponentials_of_channel(channel), r)",
        1e-6,
    ),
    function(
        "exponentials_complementary_cdf",
        CHANNEL_ARGUMENTS,
        "exponentials_complementary_cdf(exponentials_of_channel(channel), r)",
        1e-5,
    ),
];

const EXPONENTIALS_SAMPLE: Function = function(
    "exponentials_sample",
    &["channel", "u"],
    "exponentials_sample(exponentials_of_channel(channel), u)",
    5e-6,
);

const GAUSSIANS_DENSITIES: [Function; 2] = [
    function("gaussians_pdf", CHANNEL_ARGUMENTS, "gaussians_pdf(gaussians_of_channel(channel), r)", 2e-5),
    function(
        "gaussians_pdf_area",
        CHANNEL_ARGUMENTS,
        "gaussians_pdf_area(gaussians_of_channel(channel), r)",
        2e-5,
    ),
];

const GAUSSIANS_PROFILE: [Function; 3] = [
    function("gaussians_eval", CHANNEL_ARGUMENTS, "gaussians_eval(gaussians_of_channel(channel), r)", 2e-5),
    function("gaussians_cdf", CHANNEL_ARGUMENTS, "gaussians_cdf(gaussians_of_channel(channel), r)", 1e-6),
    function(
        "gaussians_complementary_cdf",
        CHANNEL_ARGUMENTS,
        "gaussians_complementary_cdf(gaussians_of_channel(channel), r)",
        2e-5,
    ),
];

const GAUSSIANS_SAMPLE: Function = function(
    "gaussians_sample",
    &["channel", "u"],
    "gaussians_sample(gaussians_of_channel(channel), u)",
    5e-6,
);

const FRESNEL: [Function; 3] = [
    function("fresnel_from_outside", &["cos_theta", "eta"], "fresnel_from_outside(cos_theta, eta)", 1e-5),
    function("fresnel_from_inside", &["cos_theta", "eta"], "fresnel_from_inside(cos_theta, eta)", 1e-5),
    function("fresnel_schlick", &["cos_theta", "eta"], "fresnel_schlick(cos_theta, eta)", 1e-5),
];

const PROBE: [Function; 3] = [
    Function {
        name: "probe_segment",
        arguments: &[
            "d_red",
            "d_green",
            "d_blue",
            "chance_red",
            "chance_green",
            "most_radius",
            "u_axis",
            "u_channel",
            "u_radius",
            "u_turn",
        ],
        call: "probe_segment(channels(d_red, d_green, d_blue), \
               channels(chance_red, chance_green, 1.0 - chance_red - chance_green), most_radius, u_axis, u_channel, \
               u_radius, u_turn)",
        outputs: &["start_x", "start_y", "start_z", "end_x", "end_y", "end_z"],
        error: 1e-5,
    },
    function(
        "probe_density",
        &[
            "d_red",
            "d_green",
            "d_blue",
            "chance_red",
            "chance_green",
            "most_radius",
            "offset_x",
            "offset_y",
            "offset_z",
            "n_x",
            "n_y",
            "n_z",
        ],
        "probe_density(channels(d_red, d_green, d_blue), \
         channels(chance_red, chance_green, 1.0 - chance_red - chance_green), most_radius, offset_x, offset_y, offset_z, n_x, n_y, n_z)",
        1e-5,
    ),
    function(
        "probe_weight",
        &["surface_albedo", "d_red", "most_radius", "distance", "density"],
        "probe_weight(surface_albedo, d_red, most_radius, distance, density)",
        1e-5,
    ),
];

const INVERSION: [Function; 3] = [
    function("inversion_absorbed", &["surface_albedo"], "inversion_absorbed(surface_albedo)", 1e-5),
    function(
        "inversion_single_scattering_albedo",
        &["surface_albedo"],
        "inversion_single_scattering_albedo(surface_albedo)",
        1e-5,
    ),
    function("inversion_absorption", &["surface_albedo"], "inversion_absorption(surface_albedo)", 1e-5),
];

/// The functions of a subject for a model; none for tables and materials.
pub fn functions(subject: Subject, model: Model) -> Vec<Function> {
    match (subject, model) {
        (Subject::Profile, Model::NormalizedDiffusion) => {
            [&BURLEY_SCALES[..], &BURLEY_PROFILE, &BURLEY_DENSITIES, &[BURLEY_QUANTILE]].concat()
        }
        (Subject::Sampler, Model::NormalizedDiffusion) => {
            [&BURLEY_SCALES[..], &BURLEY_DENSITIES, &[BURLEY_QUANTILE, BURLEY_SAMPLE]].concat()
        }
        (Subject::Profile, Model::NormalizedDiffusionRefined) => {
            [&REFINED_PROFILE[..], &REFINED_DENSITIES].concat()
        }
        (Subject::Sampler, Model::NormalizedDiffusionRefined) => {
            [&REFINED_DENSITIES[..], &[REFINED_SAMPLE]].concat()
        }
        (Subject::Profile, Model::NormalizedDiffusionOblique) => vec![OBLIQUE_EVAL, OBLIQUE_PDF_AREA],
        (Subject::Sampler, Model::NormalizedDiffusionOblique) => vec![OBLIQUE_PDF_AREA, OBLIQUE_SAMPLE],
        (Subject::Fresnel, _) => FRESNEL.to_vec(),
        (Subject::Probe, _) => PROBE.to_vec(),
        (Subject::Inversion, _) => INVERSION.to_vec(),
        (Subject::Profile, _) => match Terms::of(model) {
            Terms::Exponentials => [&EXPONENTIALS_PROFILE[..], &EXPONENTIALS_DENSITIES].concat(),
            Terms::Gaussians => [&GAUSSIANS_PROFILE[..], &GAUSSIANS_DENSITIES].concat(),
        },
        (Subject::Sampler, _) => match Terms::of(model) {
            Terms::Exponentials => [&EXPONENTIALS_DENSITIES[..], &[EXPONENTIALS_SAMPLE]].concat(),
            Terms::Gaussians => [&GAUSSIANS_DENSITIES[..], &[GAUSSIANS_SAMPLE]].concat(),
        },
        (Subject::Disk | Subject::Lut | Subject::Kernel | Subject::Transmittance | Subject::Material, _) => {
            Vec::new()
        }
    }
}
