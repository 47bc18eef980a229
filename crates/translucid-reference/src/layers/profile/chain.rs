//! One ray through all layers, with its reflections at all faces.
//!
//! Radiances are over η², so that a face transmits 1 − F of them.

use num_complex::Complex64;
use translucid_profile::fresnel_from_outside;

use super::super::{Ground, Layers};

/// What a ray does in one layer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pass {
    /// Share of light that passes from face to face.
    pub(super) through: Complex64,
    /// Light of the layer's sources that gets to its upper and to its lower face.
    pub(super) leaving: [Complex64; 2],
    /// Light that comes in: down through the upper face, and up through the lower one.
    pub(super) incoming: [Complex64; 2],
    /// Light that arrives from below at the upper face is `factors[0]` + `factors[1]` times what comes in above.
    pub(super) factors: [Complex64; 2],
}

/// Light that leaves all layers above, and light that gets to the face below.
pub(super) type Exits = [Complex64; 2];

/// Fills in what comes into each layer.
///
/// `faces` are reflectances from above the first layer to below the last, 1 where a side does not have the ray, which then
/// passes nothing; `arriving` comes from above and `returned` from a Lambertian ground.
pub(super) fn reflect(faces: &[f64], passes: &mut [Pass], arriving: Complex64, returned: Complex64) -> Exits {
    // From below: what comes up out of each lower face is a + b times what goes down there
    let (mut a, mut b) = (returned, Complex64::from(faces[passes.len()]));
    for (pass, face) in passes.iter_mut().zip(faces).rev() {
        let once = pass.through;
        let [up, down] = pass.leaving;
        pass.factors = [a, b];
        let alpha = up + once * (a + b * down);
        let beta = once * once * b;
        let between = 1.0 - beta * *face;
        // A ray that is caught in clear layers has no light
        let inverse = if between.norm_sqr() > 1e-24 { between.inv() } else { Complex64::ZERO };
        let passed = 1.0 - face;
        a = passed * alpha * inverse;
        b = face + passed * passed * beta * inverse;
        pass.incoming = [alpha * inverse * *face, passed * inverse];
    }
    let top = a + b * arriving;
    let mut down = arriving;
    for pass in passes {
        let [own, per_arriving] = pass.incoming;
        let entering = own + per_arriving * down;
        let arriving = pass.leaving[1] + pass.through * entering;
        pass.incoming = [entering, pass.factors[0] + pass.factors[1] * arriving];
        down = arriving;
    }
    [top, down]
}

/// Light of sources that leaves without having been reflected.
pub(super) fn straight(faces: &[f64], passes: &[Pass]) -> Exits {
    let mut exits = Exits::default();
    for (pass, face) in passes.iter().zip(faces).rev() {
        exits[0] = (1.0 - face) * (pass.leaving[0] + pass.through * exits[0]);
    }
    for (pass, face) in passes.iter().zip(faces) {
        exits[1] = pass.leaving[1] + pass.through * (1.0 - face) * exits[1];
    }
    exits
}

/// Fluxes of the normal beam in layers of these optical thicknesses: down at each upper face and up at each lower one, and what
/// arrives at the face below.
pub(super) fn beam(layers: &Layers, depths: impl Iterator<Item = f64>) -> (Vec<[f64; 2]>, f64) {
    let mut passes: Vec<Pass> =
        depths.map(|depth| Pass { through: libm::exp(-depth).into(), ..Pass::default() }).collect();
    let etas = etas(layers);
    let mut faces: Vec<f64> =
        etas.windows(2).map(|pair| fresnel_from_outside(1.0, pair[1] / pair[0])).collect();
    faces.resize(passes.len() + 1, 0.0);
    let [_, below] = reflect(&faces, &mut passes, Complex64::ONE, Complex64::ZERO);
    (passes.iter().map(|pass| pass.incoming.map(|flux| flux.re)).collect(), below.re)
}

/// Indices of refraction from above to below; a ground without one has none.
pub(super) fn etas(layers: &Layers) -> Vec<f64> {
    let below = match layers.ground() {
        Ground::Medium { eta } => Some(eta),
        _ => None,
    };
    let within = layers.layers().iter().map(|layer| layer.eta);
    std::iter::once(layers.eta_above()).chain(within).chain(below).collect()
}
