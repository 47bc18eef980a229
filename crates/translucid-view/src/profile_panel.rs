//! The profile of a material beside the truth.

use serde_json::{Value, json};
use translucid_profile::{Appearance, Configuration, Model, Parameterization, require};
use translucid_reference::Incidence;
use translucid_reference::exact::{HalfSpace, single_scattering_albedo};
use translucid_scene::{Material, ProfileTable, SubsurfaceModel, Unit};

/// Radii of a curve.
const POINTS: usize = 160;
/// Share of the light that leaves beyond the last radius.
const TAIL: f64 = 1e-3;
/// Least surface albedo whose profile is drawn.
const DARKEST: f64 = 1e-4;
/// Names of the channels.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Surface albedo and mean free path of a channel, and the medium around them.
#[derive(Clone, Copy)]
struct Channel {
    surface_albedo: f64,
    /// In millimeters, of the parameterization's kind.
    length: f64,
    parameterization: Parameterization,
    configuration: Configuration,
    g: f64,
    eta: f64,
}

/// The curves of a material: R(r) per mm² over r in mm, or why there are none.
pub(crate) fn profile(material: &Material, tables: &[ProfileTable], unit: Unit) -> Value {
    let channels = channels(material, unit);
    let mut notes = Vec::new();
    let textured = &material.subsurface_color;
    if textured.texture.is_some() || textured.vertex_color {
        notes.push(
            "the surface albedo has an image or vertex colors: this is the profile of its factor".to_owned(),
        );
    }
    let models: Vec<Option<Curve>> = channels
        .iter()
        .map(|channel| match model_curve(material, tables, channel) {
            Ok(curve) => Some(curve),
            Err(message) => {
                notes.push(message);
                None
            }
        })
        .collect();
    let farthest = models.iter().flatten().map(|curve| curve.farthest).fold(0.0, f64::max);
    let nearest = channels.iter().map(|channel| 0.01 * channel.length).fold(f64::MAX, f64::min);
    let nearest = nearest.min(0.01 * farthest).max(1e-6 * farthest);
    let is_drawn = farthest > 0.0 && farthest.is_finite() && nearest > 0.0;
    let step = (farthest / nearest).ln() / (POINTS - 1) as f64;
    let radii: Vec<f64> =
        if is_drawn { (0..POINTS).map(|i| nearest * (step * i as f64).exp()).collect() } else { Vec::new() };
    let (truth, truths) = truth(&channels, &radii, &mut notes);
    let curves: Vec<Value> = (0..3)
        .filter_map(|c| {
            let curve = models[c].as_ref()?;
            let values: Vec<f64> = radii.iter().map(|&r| (curve.eval)(r)).collect();
            Some(json!({
                "name": CHANNELS[c],
                "model": values,
                "exact": truths[c],
                "error_percent": truths[c].as_ref().map(|exact| 100.0 * error(&radii, &values, exact)),
            }))
        })
        .collect();
    notes.dedup();
    json!({
        "type": "profile",
        "model": material.subsurface_model.name(),
        "unit": "mm",
        "truth": truth,
        "r": radii,
        "channels": curves,
        "note": (!notes.is_empty()).then(|| notes.join("; ")),
    })
}

fn channels(material: &Material, unit: Unit) -> [Channel; 3] {
    let albedo = material.subsurface_color.factor;
    let length = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
    [0, 1, 2].map(|c| Channel {
        surface_albedo: f64::from(albedo[c]),
        length: f64::from(length[c]) * unit.in_millimeters(),
        parameterization: material.subsurface_parameter,
        configuration: material.subsurface_configuration,
        g: f64::from(material.subsurface_scatter_anisotropy),
        eta: f64::from(material.subsurface_eta),
    })
}

/// R(r) of a model.
struct Curve {
    eval: Box<dyn Fn(f64) -> f64>,
    /// Radius beyond which little is left.
    farthest: f64,
}

/// The curve of the material's model for a channel, or why it has none.
fn model_curve(material: &Material, tables: &[ProfileTable], channel: &Channel) -> Result<Curve, String> {
    let Channel { surface_albedo, length, parameterization, configuration, .. } = *channel;
    if material.subsurface_weight.factor == 0.0 && material.subsurface_weight.texture.is_none() {
        return Err("no light goes below this surface: its subsurface_weight is 0".to_owned());
    }
    let allowed = require(length > 0.0, "the mean free path", length, "more than 0").and_then(|_| {
        require(surface_albedo >= DARKEST, "the surface albedo", surface_albedo, "at least 1e-4")
    });
    allowed.map_err(|error| format!("no profile is drawn of a channel: {error}"))?;
    let model = match material.subsurface_model {
        SubsurfaceModel::Profile(model) => model,
        SubsurfaceModel::RandomWalk => {
            return Err("a random walk has no profile: on a half space it returns the exact one".to_owned());
        }
        SubsurfaceModel::None => return Err("a Lambertian color has no profile".to_owned()),
        SubsurfaceModel::Tabulated(index) => {
            let table = tables.get(index).ok_or("the table is not there")?;
            let table = table.table().map_err(|error| error.to_string())?;
            let farthest = table.at(surface_albedo, length).quantile(1.0 - TAIL);
            return Ok(Curve { eval: Box::new(move |r| table.at(surface_albedo, length).eval(r)), farthest });
        }
    };
    let [g, eta] = model.nearest_known(channel.g, channel.eta);
    let appearance = Appearance { surface_albedo, length, parameterization, g };
    let profile = model.profile(&appearance, configuration, eta);
    let profile = profile.map_err(|error| format!("{} has no profile: {error}", model.name()))?;
    let farthest = profile.quantile(1.0 - TAIL);
    Ok(Curve { eval: Box::new(move |r| profile.eval(r)), farthest })
}

/// The truth of each channel at these radii, where it is known, and its name.
fn truth(
    channels: &[Channel; 3],
    radii: &[f64],
    notes: &mut Vec<String>,
) -> (&'static str, [Option<Vec<f64>>; 3]) {
    let Channel { g, eta, .. } = channels[0];
    if g != 0.0 {
        notes.push("the exact solution is known for isotropic scattering (g = 0) only: compare with the random walk in the picture".to_owned());
        return ("", [None, None, None]);
    }
    let exact = channels.map(|channel| {
        let is_drawn = channel.length > 0.0 && channel.surface_albedo >= DARKEST;
        if !is_drawn {
            return None;
        }
        if eta == 1.0 { matched(&channel, radii) } else { below_boundary(&channel, radii) }
    });
    if exact.iter().all(Option::is_none) {
        return ("", exact);
    }
    (if eta == 1.0 { "exact half space" } else { "exact half space under a dielectric boundary" }, exact)
}

fn matched(channel: &Channel, radii: &[f64]) -> Option<Vec<f64>> {
    let Channel { surface_albedo, length, parameterization, configuration, .. } = *channel;
    let appearance = Appearance { surface_albedo, length, parameterization, g: 0.0 };
    let exact = Model::Exact.profile(&appearance, configuration, 1.0).ok()?;
    Some(radii.iter().map(|&r| exact.eval(r)).collect())
}

/// The exact half space under a boundary, for a length that is a mean free path.
fn below_boundary(channel: &Channel, radii: &[f64]) -> Option<Vec<f64>> {
    let Channel { surface_albedo, length, parameterization, configuration, eta, .. } = *channel;
    if parameterization != Parameterization::Mfp {
        return None;
    }
    let incidence = Incidence::from(configuration);
    let alpha = single_scattering_albedo(surface_albedo, eta, incidence).ok()?;
    let exact = HalfSpace::with_boundary(alpha, eta, incidence).ok()?;
    Some(radii.iter().map(|&r| exact.eval(r / length).value / (length * length)).collect())
}

/// The area-weighted L¹ distance of a curve from the exact one, as a part of the latter's energy.
fn error(radii: &[f64], values: &[f64], exact: &[f64]) -> f64 {
    // By r² d ln r: the radii rise by a factor
    let weighted =
        |f: &dyn Fn(usize) -> f64| (0..radii.len()).map(|i| radii[i] * radii[i] * f(i)).sum::<f64>();
    let energy = weighted(&|i| exact[i]);
    if energy > 0.0 { weighted(&|i| (values[i] - exact[i]).abs()) / energy } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use translucid_scene::{ColorInput, ScalarInput};

    use super::*;

    fn material(model: Model) -> Material {
        Material {
            subsurface_weight: ScalarInput::constant(1.0),
            subsurface_color: ColorInput::constant(Vec3::new(0.8, 0.5, 0.2)),
            subsurface_radius: ScalarInput::constant(0.2),
            subsurface_radius_scale: ColorInput::constant(Vec3::ONE),
            subsurface_model: SubsurfaceModel::Profile(model),
            subsurface_configuration: Configuration::Searchlight,
            ..Material::default()
        }
    }

    fn errors(value: &Value) -> Vec<f64> {
        let channels = value["channels"].as_array().unwrap();
        channels.iter().filter_map(|channel| channel["error_percent"].as_f64()).collect()
    }

    /// The errors that docs/accuracy and the README state for A = 0.8, 0.5, 0.2.
    #[test]
    fn errors_are_those_of_the_readme() {
        for (model, expected) in [
            (Model::NormalizedDiffusion, [8.86, 3.20, 4.57]),
            (Model::NormalizedDiffusionRefined, [0.32, 0.20, 0.21]),
        ] {
            let found = errors(&profile(&material(model), &[], Unit::Centimeter));
            for (found, expected) in found.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 0.1, "{}: {found} {expected}", model.name());
            }
        }
    }

    #[test]
    fn boundary_has_its_own_truth() {
        let glassy = Material { subsurface_eta: 1.4, ..material(Model::NormalizedDiffusionRefined) };
        let value = profile(&glassy, &[], Unit::Millimeter);
        assert_eq!(value["truth"], "exact half space under a dielectric boundary");
        assert!(errors(&value).iter().all(|&error| error < 5.0), "{:?}", errors(&value));
    }

    #[test]
    fn what_has_no_profile_says_so() {
        for (material, words) in [
            (
                Material { subsurface_model: SubsurfaceModel::RandomWalk, ..material(Model::Exact) },
                "random walk",
            ),
            (
                Material { subsurface_weight: ScalarInput::constant(0.0), ..material(Model::Exact) },
                "subsurface_weight",
            ),
            (
                Material { subsurface_radius: ScalarInput::constant(0.0), ..material(Model::Exact) },
                "mean free path",
            ),
            (
                Material { subsurface_color: ColorInput::constant(Vec3::ZERO), ..material(Model::Exact) },
                "albedo",
            ),
        ] {
            let value = profile(&material, &[], Unit::Millimeter);
            assert_eq!(value["channels"], json!([]));
            assert!(value["note"].as_str().unwrap().contains(words), "{value}");
        }
    }
}
