//! Models that are no half space, fitted beside it.

use translucid_measure::{Fit, Outline, Response, Samples, Scale, fit_edge_of, fit_spot};

/// Difference of χ² from which on one model is better than another: of Gaussian noise exp(-10) as likely.
const DECIDED: f64 = 20.0;

/// The model that explains the light best among those that are no half space.
pub(super) struct Rival {
    /// Mean square of what is left over, over the noise.
    pub(super) misfit: f64,
    /// Name of the model.
    pub(super) name: &'static str,
}

impl Rival {
    /// The best of normalized diffusion and mixtures of two exponentials.
    pub(super) fn best(fit: &Fit, samples: &Samples, scale: Scale) -> Self {
        let of = |name, response: &Response| {
            let rival = match fit.outline {
                Outline::Edge { card, .. } => fit_edge_of(card, samples, response, scale),
                Outline::Spot { .. } => fit_spot(samples, response, scale),
            };
            Self { misfit: rival.map_or(f64::INFINITY, |fit| fit.misfit), name }
        };
        let diffusion = of("normalized diffusion", &Response::normalized_diffusion());
        // Two exponentials from one that is hardly two to a narrow peak on a wide glow
        let mixtures = [(0.5, 3.0), (0.25, 8.0), (0.5, 8.0), (0.75, 8.0)];
        let mixtures = mixtures.map(|(weight, ratio)| {
            of("a mixture of two exponentials", &Response::exponentials(weight, ratio))
        });
        mixtures
            .into_iter()
            .fold(diffusion, |best, rival| if rival.misfit < best.misfit { rival } else { best })
    }

    /// A warning if the shape contradicts a half space.
    pub(super) fn warning(&self, fit: &Fit, samples: &Samples) -> Option<String> {
        let decided = (fit.misfit - self.misfit) * 3.0 * samples.places.len() as f64;
        (decided > DECIDED * self.misfit.max(1.0)).then(|| {
            format!(
                "{}, no solution of the equation of transfer, explains the light better than a half space or slab of \
                 isotropic scatterers: the piece is not one, or the light is not as --configuration says",
                self.name
            )
        })
    }
}
