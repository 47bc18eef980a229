//! Meshes of a size that no one means.

use translucid_scene::{Material, Object, Place, Unit, Warning};

use super::orientation::bounds;

/// Longest edge of a mesh's box up to which its unit is doubted, where the mean free path is longer [mm]: clear liquids
/// have one that is longer than what they are in.
const SMALLEST: f64 = 10.0;

/// Longest edge of a mesh's box beyond which its unit is doubted [mm].
const LARGEST: f64 = 1e5;

/// Mean free paths across a surface beyond which none of the light under it is seen: of a picture of the whole, 1500 pixels
/// wide, ten lie in a pixel.
const DULLEST: f64 = 1.5e4;

/// Typical size of rendered objects [mm].
const USUAL: f64 = 150.0;

/// Warns of a mesh that is smaller than the mean free path of its own material, or larger than a street.
///
/// The lengths of objects and materials are in `unit`, those of the file in `file_unit`; `advice` says how to change that.
pub(super) fn warn_of_extent(
    (objects, materials): (&[Object], &[Material]),
    [unit, file_unit]: [Unit; 2],
    advice: impl Fn(Unit) -> String,
    place: &Place,
    warnings: &mut Vec<Warning>,
) {
    let (low, high) = bounds(objects);
    let extent = f64::from((high - low).max_element()) * unit.in_millimeters();
    let mean_free_path =
        shortest_mean_free_path(objects, materials).map(|length| length * unit.in_millimeters());
    let suspicion = match mean_free_path {
        Some(length) if extent < length.min(SMALLEST) => {
            format!(", smaller than its mean free path of {}", shown(length))
        }
        _ if extent > LARGEST => String::new(),
        _ => return,
    };
    let others = Unit::WORDS.into_iter().map(|(_, other)| other);
    let others = others.filter(|&other| {
        (other.in_millimeters() > file_unit.in_millimeters()) != suspicion.is_empty() && other != file_unit
    });
    let in_unit = |other: &Unit| extent * other.in_millimeters() / file_unit.in_millimeters();
    let doubt = |other: &Unit| libm::log(in_unit(other) / USUAL).abs();
    let question = match others.min_by(|a, b| doubt(a).total_cmp(&doubt(b))) {
        Some(best) => format!("is it in {}? {}", best.plural(), advice(best)),
        None => String::from("is that what it should be?"),
    };
    let message = format!("the mesh is {} across{suspicion}: {question}", shown(extent));
    warnings.push(Warning { message, place: Some(place.clone()) });
}

/// Warns of meshes in meters, as glTF's are, that are so large beside their mean free paths that millimeters are meant: CAD
/// programs write them so.
///
/// A large scene in which one thing is translucent is none of them.
pub(super) fn warn_of_meters(
    (objects, materials): (&[Object], &[Material]),
    place: &Place,
    warnings: &mut Vec<Warning>,
) {
    let extent = |objects: &[Object]| {
        let (low, high) = bounds(objects);
        f64::from((high - low).max_element())
    };
    let whole = extent(objects);
    let is_dull = |object: &Object| {
        let length = shortest_mean_free_path(std::slice::from_ref(object), materials);
        length.is_none_or(|length| extent(std::slice::from_ref(object)) > DULLEST * length)
    };
    let Some(length) = shortest_mean_free_path(objects, materials) else { return };
    if whole * Unit::Meter.in_millimeters() <= LARGEST && objects.iter().all(is_dull) {
        let [whole, length] = [whole, length].map(|length| shown(length * Unit::Meter.in_millimeters()));
        let message = format!(
            "the mesh is {whole} across, too large beside its mean free path of {length} for light under its surface to be \
             seen: is it in millimeters? --unit mm (--unit m keeps it)"
        );
        warnings.push(Warning { message, place: Some(place.clone()) });
    }
}

/// The least, over the objects that light goes under, of their materials' longest mean free path in any channel.
fn shortest_mean_free_path(objects: &[Object], materials: &[Material]) -> Option<f64> {
    let of_objects = objects.iter().filter_map(|object| materials.get(object.material));
    let translucent = of_objects.filter(|material| material.has_subsurface());
    let longest = translucent.map(|material| {
        f64::from(material.subsurface_radius.factor * material.subsurface_radius_scale.factor.max_element())
    });
    longest.reduce(f64::min)
}

/// A length in the unit in which it reads best, with up to three digits.
fn shown(millimeters: f64) -> String {
    let (factor, unit) = match millimeters {
        x if x >= 1e6 => (1e-6, "km"),
        x if x >= 1e3 => (1e-3, "m"),
        _ => (1.0, "mm"),
    };
    let value = millimeters * factor;
    let step = libm::pow(10_f64, libm::log10(value.max(1e-9)).floor() - 2.0);
    let rounded = (value / step).round() * step;
    // The sum of a division and a product may have a tail.
    let digits = (-libm::log10(step).round()).max(0.0) as usize;
    let text = format!("{rounded:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} {unit}")
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use translucid_scene::{Mesh, ScalarInput};

    use super::*;

    /// What is said of a mesh of this extent in this unit, with a mean free path [mm].
    fn said(extent: f32, unit: Unit, mean_free_path: f32) -> Option<String> {
        let positions = vec![Vec3::ZERO, Vec3::new(extent, 0.0, 0.0), Vec3::new(0.0, 0.5 * extent, 0.0)];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let material = Material {
            subsurface_weight: ScalarInput::constant(1.0),
            subsurface_radius: ScalarInput::constant(mean_free_path / unit.in_millimeters() as f32),
            subsurface_radius_scale: translucid_scene::ColorInput::constant(Vec3::new(1.0, 0.5, 0.25)),
            ..Material::default()
        };
        let object = Object { mesh: mesh.into(), ..Object::default() };
        let mut warnings = Vec::new();
        let advice = |unit: Unit| format!("--unit {}", unit.name());
        let place = Place::part(std::path::Path::new(""), "a");
        warn_of_extent((&[object], &[material]), [unit; 2], advice, &place, &mut warnings);
        assert!(warnings.len() < 2);
        warnings.pop().map(|warning| warning.message)
    }

    #[test]
    fn meshes_of_the_wrong_unit_are_doubted() {
        for (extent, unit, mean_free_path, message) in [
            (
                0.1,
                Unit::Millimeter,
                0.46,
                "the mesh is 0.1 mm across, smaller than its mean free path of 0.46 mm: is it in meters? --unit m",
            ),
            (
                0.3,
                Unit::Centimeter,
                5.0,
                "the mesh is 3 mm across, smaller than its mean free path of 5 mm: is it in meters? --unit m",
            ),
            (
                1e-4,
                Unit::Meter,
                0.46,
                "the mesh is 0.1 mm across, smaller than its mean free path of 0.46 mm: is that what it should be?",
            ),
            (2000.0, Unit::Meter, 0.46, "the mesh is 2 km across: is it in millimeters? --unit mm"),
            (25.4e3, Unit::Centimeter, 0.46, "the mesh is 254 m across: is it in millimeters? --unit mm"),
            (2e6, Unit::Millimeter, 0.46, "the mesh is 2 km across: is that what it should be?"),
        ] {
            assert_eq!(said(extent, unit, mean_free_path).as_deref(), Some(message));
        }
    }

    #[test]
    fn meshes_of_usual_sizes_are_not_doubted() {
        assert_eq!(said(200.0, Unit::Millimeter, 544.0), None, "a bottle of lemonade");
        for (extent, unit) in [
            (1.0, Unit::Millimeter),
            (300.0, Unit::Millimeter),
            (0.3, Unit::Meter),
            (90.0, Unit::Meter),
            (25.0, Unit::Centimeter),
        ] {
            assert_eq!(said(extent, unit, 0.46), None, "{extent} {unit:?}");
        }
    }

    /// A box of 10 mm of CadQuery, whose GLB is 10 m wide; statues, and a room with a candle, are as large as they are.
    #[test]
    fn meshes_whose_millimeters_are_called_meters_are_doubted() {
        let said = |sizes: &[(f32, f32)]| {
            let object = |(material, &(extent, _)): (usize, &(f32, f32))| {
                let positions = vec![Vec3::ZERO, Vec3::new(extent, 0.0, 0.0), Vec3::new(0.0, extent, 0.0)];
                let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
                Object { mesh: mesh.into(), material, ..Object::default() }
            };
            let material = |&(_, length): &(f32, f32)| Material {
                subsurface_weight: ScalarInput::constant(if length > 0.0 { 1.0 } else { 0.0 }),
                subsurface_radius: ScalarInput::constant(length),
                subsurface_radius_scale: translucid_scene::ColorInput::constant(Vec3::ONE),
                ..Material::default()
            };
            let objects: Vec<Object> = sizes.iter().enumerate().map(object).collect();
            let materials: Vec<Material> = sizes.iter().map(material).collect();
            let mut warnings = Vec::new();
            let place = Place::part(std::path::Path::new(""), "a");
            warn_of_meters((&objects, &materials), &place, &mut warnings);
            warnings.pop().map(|warning| warning.message)
        };
        let message = said(&[(10.0, 4.6e-4)]).unwrap();
        assert!(
            message.starts_with(
                "the mesh is 10 m across, too large beside its mean free path of 0.46 mm for light"
            ) && message.contains("is it in millimeters? --unit mm"),
            "{message}"
        );
        assert!(said(&[(10.0, 4.6e-4), (9.0, 0.0)]).is_some());
        for sizes in [
            &[(5.17, 4.6e-4)][..],
            &[(10.0, 0.0)],
            &[(30.0, 4.6e-4), (0.2, 4.6e-4)],
            &[(12.0, 1.3e-3)],
            &[(200.0, 1e-3)],
        ] {
            assert_eq!(said(sizes), None, "{sizes:?}");
        }
    }

    #[test]
    fn lengths_are_shown_with_three_digits() {
        for (length, text) in [
            (0.1, "0.1 mm"),
            (0.455_8, "0.456 mm"),
            (1.0, "1 mm"),
            (999.0, "999 mm"),
            (1234.5, "1.23 m"),
            (1e6, "1 km"),
            (2.5e7, "25 km"),
            (1e-5, "0.00001 mm"),
            (0.0, "0 mm"),
        ] {
            assert_eq!(shown(length), text);
        }
    }
}
