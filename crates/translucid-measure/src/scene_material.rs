//! The material of a scene that is fitted, and its own numbers, where the fit starts.

use glam::Vec3;
use translucid_scene::{Material, Scene, SubsurfaceParameter};

use crate::error::MeasureError;
use crate::unknown::{Guess, Unknown};

/// The material of a name, or the only one that light goes under.
pub(crate) fn material_named(scene: &Scene, name: Option<&str>) -> Result<usize, MeasureError> {
    let is_translucent = Material::has_subsurface;
    let is_wanted = |material: &Material| match name {
        Some(name) => material.name == name,
        None => is_translucent(material),
    };
    let found: Vec<usize> = (0..scene.materials.len()).filter(|&i| is_wanted(&scene.materials[i])).collect();
    let names = || {
        let names: Vec<&str> =
            scene.materials.iter().filter(|m| is_translucent(m)).map(|m| m.name.as_str()).collect();
        if names.is_empty() { String::from("none") } else { names.join(", ") }
    };
    match (name, &found[..]) {
        (_, &[one]) if is_translucent(&scene.materials[one]) => Ok(one),
        (Some(name), &[_]) => {
            Err(MeasureError::new(format!("`material` is {name}, but no light goes below it"))
                .with_help(format!("translucent materials: {}", names())))
        }
        (Some(name), _) => {
            let message = format!("`material` is {name}, but the scene has {} of that name", found.len());
            Err(MeasureError::new(message).with_help(format!("translucent materials: {}", names())))
        }
        (None, &[]) => Err(MeasureError::new("light goes below no material of the scene")),
        (None, _) => Err(MeasureError::new(format!("the scene has {} translucent materials", found.len()))
            .with_help(format!("say which one by `material`: {}", names()))),
    }
}

/// Whether the mean free path is an image.
pub(crate) fn has_texture_of_mfp(material: &Material) -> bool {
    let scale = &material.subsurface_radius_scale;
    material.subsurface_radius.texture.is_some() || scale.texture.is_some() || scale.vertex_color
}

/// The material's own numbers; refuses images where numbers are to be found.
pub(crate) fn start(material: &Material, unknowns: &[Unknown]) -> Result<Guess, MeasureError> {
    let albedo = &material.subsurface_color;
    let mfp = material.subsurface_radius_scale.factor * material.subsurface_radius.factor;
    let [finds_albedo, finds_mfp] =
        [Unknown::SurfaceAlbedo, Unknown::Mfp].map(|unknown| unknowns.contains(&unknown));
    let faults = [
        (!material.layers.is_empty(), "it has layers, but one medium is to be found"),
        (
            finds_albedo && (albedo.texture.is_some() || albedo.vertex_color),
            "subsurface_color is an image, of which no single number can be found",
        ),
        (
            finds_mfp && has_texture_of_mfp(material),
            "subsurface_radius is an image, of which no single number can be found",
        ),
        (
            finds_mfp && material.subsurface_parameter != SubsurfaceParameter::Mfp,
            "subsurface_parameter is dmfp, but material.mfp needs mfp",
        ),
        (
            finds_mfp && mfp.min_element() <= 0.0,
            "the fit starts at its mean free path, which must be above 0",
        ),
    ];
    if let Some((_, fault)) = faults.iter().find(|(is_wrong, _)| *is_wrong) {
        return Err(MeasureError::new(format!("material {}: {fault}", material.name)));
    }
    let clamped = |color: Vec3, low: f64, high: f64| color.to_array().map(|v| f64::from(v).clamp(low, high));
    Ok(Guess {
        surface_albedo: clamped(albedo.factor, 1e-3, 0.999),
        mfp: clamped(mfp, 1e-12, 1e12),
        g: f64::from(material.subsurface_scatter_anisotropy).clamp(-0.95, 0.95),
        radiance: [1.0; 3],
    })
}
