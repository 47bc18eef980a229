//! A material that was measured in a photograph, with everything that shows how well.

use crate::alternative_model::AlternativeModel;
use crate::fit::{ChannelFit, Fit, Interval, Scale};
use crate::linear_photo::Photo;
use crate::options::Options;
use crate::remark::Remark;
use crate::samples::Samples;
use crate::trace::Trace;

/// A quantity that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// Its channel; none where it belongs to all.
    pub channel: Option<usize>,
    /// Its name: `mfp`, `surface_albedo`, `g`, `radiance_scale`.
    pub name: &'static str,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// Its value and confidence intervals.
    pub interval: Interval,
}

/// A measurement in a photograph of an edge of light or of a spot.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Options that describe the photograph.
    pub options: Options,
    /// Width of a pixel \[mm\].
    pub mm_per_pixel: f64,
    /// The photograph in the numbers that were fitted.
    pub photo: Photo,
    /// The part of it that was measured.
    pub region: [usize; 4],
    /// Place of the light's shape in the region.
    pub trace: Trace,
    /// The light that was fitted.
    pub samples: Samples,
    /// The fit; mean free paths are those of the medium that was asked for.
    pub fit: Fit,
    /// Scale of the values of the photograph.
    pub scale: Scale,
    /// The best of the models that solve no equation of transfer.
    pub alternative: AlternativeModel,
    /// Notes and warnings of what limits the measurement.
    pub limits: Vec<Remark>,
}

impl Measurement {
    /// The mean free paths that are seen, and the surface albedos that are measured.
    pub fn quantities(&self) -> Vec<Quantity> {
        let of_channel = |(c, channel): (usize, &ChannelFit)| {
            let quantity = |name, unit, interval| Quantity { channel: Some(c), name, unit, interval };
            let mfp = channel.is_seen.then(|| quantity("mfp", "mm", channel.mfp));
            let albedo = channel.surface_albedo.map(|albedo| quantity("surface_albedo", "", albedo));
            mfp.into_iter().chain(albedo)
        };
        self.fit.channels.iter().enumerate().flat_map(of_channel).collect()
    }

    /// Mean free paths of the material \[mm\]: 0, that of a Lambertian surface, where no scattering is seen.
    pub fn mfps(&self) -> [f64; 3] {
        self.fit.channels.map(|channel| if channel.is_seen { channel.mfp.value } else { 0.0 })
    }

    /// Surface albedos of the material, measured or given.
    pub fn surface_albedos(&self) -> [f64; 3] {
        let measured =
            |channel: &ChannelFit| channel.surface_albedo.map_or(0.0, |albedo| albedo.value.clamp(0.0, 1.0));
        std::array::from_fn(|c| self.scale.albedo(c).unwrap_or_else(|| measured(&self.fit.channels[c])))
    }
}
