//! The formulas, written once, in WGSL: functions that a text takes together with all that these call.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{LN_2, PI};

use translucid_fit::ScalingPolynomial;
use translucid_profile::{Configuration, Parameterization, coefficients};

use crate::number::{about_one, horner, literal};
use crate::token::{Token, tokens};

/// Four exponentials, refined diffusion's, which under another name are those of any fit.
const REFINED: &str = include_str!("formulas/refined.wgsl");

/// All formulas, from those that others call to those that call them.
const FORMULAS: [&str; 8] = [
    include_str!("formulas/elementary.wgsl"),
    include_str!("formulas/burley.wgsl"),
    REFINED,
    include_str!("formulas/oblique.wgsl"),
    include_str!("formulas/directional_dipole.wgsl"),
    include_str!("formulas/gaussians.wgsl"),
    include_str!("formulas/fresnel.wgsl"),
    include_str!("formulas/probe.wgsl"),
];

/// Functions of given names with all that they call, in WGSL, with the coefficients of a configuration; some of them
/// made for the occasion.
pub(crate) fn formulas(roots: &[&str], configuration: Configuration, made: &str) -> String {
    with_called(roots, &constants(configuration), made)
}

/// The directional dipole and the terms of oblique light in WGSL for a path tracer, which knows boundary and configuration when it
/// runs: it sets `oblique_means`, the means of the energy's functions over diffuse light that was refracted, and
/// `oblique_is_searchlight`.
pub fn directional_formulas() -> String {
    let mut constants = constants(Configuration::Diffuse);
    let [log, first, second] = coefficients::OBLIQUE_ENERGY.map(|row| horner(&row, "diffuse"));
    let searchlight = horner(&coefficients::OBLIQUE_DIFFUSE_ALBEDO, "albedo");
    let albedos = format!(
        "    let of_searchlight: f32 = min(albedo * (1.0 + (1.0 - albedo) * ({searchlight})), 1.0);
    let diffuse: f32 = select(albedo, of_searchlight, oblique_is_searchlight);
    let along_normal: f32 = 1.0 - oblique_deviation(diffuse, 1.0);
    let means: f32 = ({log}) * oblique_means.x + ({first}) * oblique_means.y + ({second}) * oblique_means.z;
    let of_diffuse: f32 = 1.0 - (1.0 - diffuse) * means;
    let energy: f32 = albedo / select(of_diffuse, along_normal, oblique_is_searchlight);
    let a: f32 = select(min(max(diffuse * along_normal, 0.0), 1.0), albedo, oblique_is_searchlight);"
    );
    constants.insert(String::from("oblique.albedos"), albedos);
    let [diffuse, searchlight] = [Configuration::Diffuse, Configuration::Searchlight]
        .map(|configuration| horner(&coefficients::mfp_per_dmfp(configuration), "a"));
    let mfp_per_dmfp = format!("select({diffuse}, {searchlight}, oblique_is_searchlight)");
    constants.insert(String::from("mfp_per_dmfp"), mfp_per_dmfp);
    let variables = "var<private> oblique_means: vec3f;\nvar<private> oblique_is_searchlight: bool;\n\n";
    let roots = ["oblique_terms", "refined_mfp_from_dmfp", "directional_dipole", "directional_dipole_eval"];
    variables.to_owned() + &with_called(&roots, &constants, "")
}

/// Functions of given names with all that they call, and constants in their places.
fn with_called(roots: &[&str], constants: &BTreeMap<String, String>, made: &str) -> String {
    let exponentials = REFINED.replace("refined_", "exponentials_").replace("Refined", "Exponentials");
    let source = FORMULAS.join("\n") + "\n" + &exponentials.replace("${exponentials_", "${refined_");
    let source = with_constants(&source, constants) + "\n" + made;
    let items: Vec<Item<'_>> = items(&source);
    let by_name: BTreeMap<&str, usize> = items.iter().enumerate().map(|(i, item)| (item.name, i)).collect();
    let mut wanted = BTreeSet::new();
    let mut open: Vec<usize> = roots.iter().filter_map(|root| by_name.get(root).copied()).collect();
    debug_assert_eq!(open.len(), roots.len(), "{roots:?}");
    while let Some(i) = open.pop() {
        if wanted.insert(i) {
            let called = tokens(items[i].text).into_iter().filter_map(|token| match token {
                Token::Word(word) => by_name.get(word).copied(),
                _ => None,
            });
            open.extend(called);
        }
    }
    let texts: Vec<&str> = wanted.into_iter().map(|i| items[i].text.trim_end()).collect();
    texts.join("\n\n") + "\n"
}

/// A function or struct with its comment.
struct Item<'a> {
    name: &'a str,
    text: &'a str,
}

/// Items of a source: paragraphs, apart from those inside a body.
fn items(source: &str) -> Vec<Item<'_>> {
    let mut items = Vec::new();
    let mut rest = source;
    while let Some(end) = rest.find("\n}\n") {
        let (text, after) = rest.split_at(end + 3);
        let pieces = tokens(text);
        let name = pieces.windows(3).find_map(|window| match window {
            [Token::Word("fn" | "struct"), _, Token::Word(name)] => Some(*name),
            _ => None,
        });
        items.extend(name.map(|name| Item { name, text: text.trim_start() }));
        rest = after;
    }
    items
}

/// Puts the text of each constant in the place of its `${name}`.
fn with_constants(source: &str, constants: &BTreeMap<String, String>) -> String {
    let mut text = String::new();
    let mut parts = source.split("${");
    text += parts.next().unwrap_or_default();
    for part in parts {
        let (name, rest) = part.split_once('}').unwrap_or((part, ""));
        debug_assert!(constants.contains_key(name), "{name}");
        text += constants.get(name).map_or("", String::as_str);
        text += rest;
    }
    text
}

/// Text of each constant, made of the profile crate's numbers.
fn constants(configuration: Configuration) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    let mut add = |name: &str, text: String| all.insert(String::from(name), text);
    add("pi", literal(PI));
    add("inverse_two_pi", literal(0.5 / PI));

    let scales = [
        ("mfp_searchlight", Parameterization::Mfp, Configuration::Searchlight),
        ("mfp_diffuse", Parameterization::Mfp, Configuration::Diffuse),
        ("dmfp_searchlight", Parameterization::Dmfp, Configuration::Searchlight),
    ];
    for (name, parameterization, configuration) in scales {
        let scale = ScalingPolynomial::talk(parameterization, configuration);
        for (part, value) in
            [("constant", scale.constant), ("factor", scale.factor), ("center", scale.center)]
        {
            add(&format!("{name}.{part}"), literal(value));
        }
    }
    add("start_below", horner(&coefficients::QUANTILE_START_BELOW, "v"));
    add("start_above", horner(&coefficients::QUANTILE_START_ABOVE, "v"));

    // Weights of three terms, and what they leave to the fourth
    let with_last = |weights: Vec<Vec<f64>>| {
        let mut last: Vec<f64> = weights[0].iter().map(|_| 0.0).collect();
        weights.iter().for_each(|row| row.iter().zip(&mut last).for_each(|(c, last)| *last -= c));
        last[0] += 1.0;
        [weights, vec![last]].concat()
    };
    let of_terms = ["a", "b", "c", "d"];
    for (name, configuration) in [("refined", configuration), ("searchlight", Configuration::Searchlight)] {
        let weights =
            with_last(coefficients::refined_weights(configuration).map(|row| row.to_vec()).to_vec());
        for (term, weights) in of_terms.iter().zip(weights) {
            add(&format!("{name}.weight_{term}"), horner(&about_one(&weights), "k"));
        }
        for (term, rates) in of_terms.iter().zip(coefficients::refined_rates(configuration)) {
            add(&format!("{name}.rate_{term}"), horner(&about_one(&rates), "k"));
        }
    }
    add("mfp_per_dmfp", horner(&coefficients::mfp_per_dmfp(configuration), "a"));

    // σ_tr over √(1 − α'), and Davison's extrapolation length as the paper of the directional dipole rounds it
    add("dipole.root_3", literal(3_f64.sqrt()));
    add("dipole.extrapolation", literal(2.131 / 3.0));
    add("oblique.mean_log", literal((4.0 * LN_2 - 1.0) / 3.0));
    add("oblique.least_cos_theta", literal(coefficients::OBLIQUE_LEAST_COS_THETA));
    add("oblique.albedos", oblique_albedos(configuration));
    for (part, row) in of_terms.iter().zip(coefficients::OBLIQUE_ENERGY) {
        add(&format!("oblique.energy_{part}"), horner(&row, "a"));
    }
    let weights = with_last(coefficients::OBLIQUE_GRAZING_WEIGHTS.map(|row| row.to_vec()).to_vec());
    for (term, weights) in of_terms.iter().zip(weights) {
        add(&format!("oblique.weight_{term}"), horner(&weights, "a"));
    }
    for (term, change) in of_terms[1..].iter().zip(coefficients::OBLIQUE_RATE_CHANGES) {
        add(&format!("oblique.change_{term}"), horner(&change, "a"));
    }
    for (term, [normal, change]) in of_terms.iter().zip(coefficients::OBLIQUE_TILTS) {
        add(&format!("oblique.tilt_{term}"), horner(&normal, "a"));
        add(&format!("oblique.tilt_change_{term}"), horner(&change, "a"));
    }
    all
}

/// Lines that find the albedo of diffuse light, that of light along the normal, and the energy's scale.
fn oblique_albedos(configuration: Configuration) -> String {
    match configuration {
        Configuration::Searchlight => format!(
            "    // A is the albedo of light along the normal
    let a: f32 = albedo;
    let diffuse: f32 = min(a * (1.0 + (1.0 - a) * ({})), 1.0);
    let energy: f32 = albedo / (1.0 - oblique_deviation(diffuse, 1.0));",
            horner(&coefficients::OBLIQUE_DIFFUSE_ALBEDO, "a")
        ),
        Configuration::Diffuse => String::from(
            "    // A is the albedo of diffuse light
    let diffuse: f32 = albedo;
    let energy: f32 = albedo;
    let a: f32 = min(max(albedo * (1.0 - oblique_deviation(diffuse, 1.0)), 0.0), 1.0);",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_come_with_what_they_call() {
        let text = formulas(&["burley_cdf"], Configuration::Diffuse, "");
        for name in ["fn one_minus_exp", "fn burley_depth", "fn burley_cdf"] {
            assert!(text.contains(name), "{text}");
        }
        assert!(!text.contains("fn burley_sample") && !text.contains("${"), "{text}");
    }

    #[test]
    fn constants_are_the_profiles() {
        let text = formulas(&["burley_scale_mfp_searchlight"], Configuration::Diffuse, "");
        assert!(text.contains("return 1.85 - a + 7.0 * x * x * x;"), "{text}");
    }
}
