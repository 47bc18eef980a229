//! Models that are no half space, fitted beside it.

use crate::edge_fit::fit_edge_of;
use crate::fit::{Fit, Outline, Scale};
use crate::remark::Remark;
use crate::response::Response;
use crate::samples::Samples;
use crate::spot_fit::fit_spot;

/// Difference of χ² from which on one model is better than another: of Gaussian noise exp(−10) as likely.
const DECIDED: f64 = 20.0;

/// Mixtures of two exponentials, as the weight of the narrow one and the ratio of their widths: from one that is hardly two
/// to a narrow peak on a wide glow.
const MIXTURES: [(f64, f64); 4] = [(0.5, 3.0), (0.25, 8.0), (0.5, 8.0), (0.75, 8.0)];

/// The model that explains the light best among those that solve no equation of transfer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlternativeModel {
    /// Mean square of what is left over, over the noise.
    pub misfit: f64,
    /// Name of the model.
    pub name: &'static str,
}

impl AlternativeModel {
    /// The best of normalized diffusion and mixtures of two exponentials, for the light that a fit explains.
    pub(crate) fn best(fit: &Fit, samples: &Samples, scale: Scale) -> Self {
        let of = |name, response: &Response| {
            let alternative = match fit.outline {
                Outline::Edge { card, .. } => fit_edge_of(card, samples, response, scale),
                Outline::Spot { .. } => fit_spot(samples, response, scale),
            };
            Self { misfit: alternative.map_or(f64::INFINITY, |fit| fit.misfit), name }
        };
        let diffusion = of("normalized diffusion", &Response::normalized_diffusion());
        let mixtures = MIXTURES.map(|(weight, ratio)| {
            of("a mixture of two exponentials", &Response::exponentials(weight, ratio))
        });
        mixtures.into_iter().fold(diffusion, |best, next| if next.misfit < best.misfit { next } else { best })
    }

    /// A warning if the shape contradicts a half space.
    pub(crate) fn warning(&self, fit: &Fit, samples: &Samples) -> Option<Remark> {
        let decided = (fit.misfit - self.misfit) * 3.0 * samples.places.len() as f64;
        (decided > DECIDED * self.misfit.max(1.0)).then(|| {
            Remark::Warning(format!(
                "{}, no solution of the equation of transfer, explains the light better than a half space or slab of \
                 isotropic scatterers: the piece is not one, the light is not as `configuration` says, or it is bent by a close lamp \
                 or a lens with dark corners",
                self.name
            ))
        })
    }
}
