//! What an OpenEXR file states of its colors.

use exr::meta::attribute::{AttributeValue, Chromaticities};
use exr::meta::header::Header;

use super::super::Stated;
use super::super::encoding::{Curve, Encoding};
use super::names::text;
use crate::primaries::{ADOBE_RGB, AP0, AP1, DISPLAY_P3, Primaries, REC_709, REC_2020};

/// CIE X, Y, Z under D65.
const XYZ: Primaries = Primaries([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]]);

/// What the first of `colorInteropID`, `acesImageContainerFlag` and `chromaticities` states, Rec. 709 if there is none.
///
/// <https://github.com/AcademySoftwareFoundation/ColorInterop>; SMPTE ST 2065-4; OpenEXR, Standard Attributes.
pub(super) fn stated(header: &Header) -> Option<Stated> {
    let named = |wanted: &str| {
        let shared = header.shared_attributes.other.iter();
        let mut all = shared.chain(header.own_attributes.other.iter());
        all.find(|(name, _)| name.as_slice() == wanted.as_bytes()).map(|(_, value)| value)
    };
    let chromaticities = header.shared_attributes.chromaticities;
    if let Some(AttributeValue::Text(id)) = named("colorInteropID") {
        let id = text(id);
        match interop(&id) {
            Some(encoding) => return Some(Stated::encoding(encoding)),
            None if matches!(id.as_str(), "" | "data" | "unknown") => {}
            None if chromaticities.is_none() => {
                return Some(Stated::Unknown(format!("its colorInteropID \"{id}\" is not known")));
            }
            None => {}
        }
    }
    if let Some(AttributeValue::I32(1)) = named("acesImageContainerFlag") {
        return Some(Stated::encoding(Encoding::new("ACES2065-1", Curve::Linear, AP0)));
    }
    let Chromaticities { red, green, blue, white } = chromaticities?;
    let primaries = Primaries([red, green, blue, white].map(|at| [at.0, at.1].map(f64::from)));
    if primaries.0.as_flattened().iter().zip(XYZ.0.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-4) {
        return Some(xyz("chromaticities of CIE XYZ"));
    }
    if !primaries.to_rec_709().is_finite() {
        return Some(Stated::Unknown("its chromaticities are no primaries".into()));
    }
    Some(Stated::encoding(Encoding::new("chromaticities", Curve::Linear, primaries)))
}

/// CIE X, Y, Z as they are: light is not adapted from their white, which is no color that anything is lit with.
pub(super) fn xyz(name: &str) -> Stated {
    let curves = [(); 3].map(|()| Curve::Linear);
    Stated::encoding(Encoding { name: name.to_owned(), curves, to_rec_709: XYZ.to_rec_709_unadapted() })
}

/// A space of the Color Interop Forum, by names such as "lin_ap1_scene", with or without a namespace.
fn interop(id: &str) -> Option<Encoding> {
    let name = id.rsplit(':').next().unwrap_or(id);
    let (curve, rest) = name.split_once('_')?;
    let primaries = rest.trim_end_matches("_scene").trim_end_matches("_display");
    let curve = match curve {
        "lin" => Curve::Linear,
        "srgb" => Curve::Srgb,
        "g18" => Curve::Power(1.8),
        "g22" => Curve::Power(2.2),
        "g24" => Curve::Power(2.4),
        "g26" => Curve::Power(2.6),
        _ => return None,
    };
    let primaries = match primaries {
        "rec709" => REC_709,
        "rec2020" => REC_2020,
        "p3d65" => DISPLAY_P3,
        "adobergb" => ADOBE_RGB,
        "ap0" => AP0,
        "ap1" => AP1,
        "ciexyzd65" | "xyzd65" => {
            let curves = [(); 3].map(|()| curve.clone());
            return Some(Encoding { name: id.to_owned(), curves, to_rec_709: XYZ.to_rec_709_unadapted() });
        }
        _ => return None,
    };
    Some(Encoding::new(id, curve, primaries))
}
