//! The BSDF of a surface point with its tables, and decisions as the renderer takes them.

use glam::Vec3;
use translucid_law::bsdf::{self as law, BELOW, BsdfDraw, DIFFUSE, DIRECTION, GLOSSY, MIRROR};
use translucid_law::{SurfaceParameters, mirrored, refract};

use super::layers::{AskedTables, MaterialTables};

pub use law::BsdfValue;

/// Kind of the lobe that a direction was drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Over the whole hemisphere.
    Diffuse,
    /// By rough facets.
    Glossy,
    /// By a mirror: no other technique can find this direction.
    Delta,
}

/// A decision of [`Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BsdfSample {
    /// Light comes from a direction.
    Direction {
        /// Where it comes from.
        wi: Vec3,
        /// f|cosθi| / pdf over all lobes that share the direction.
        weight: Vec3,
        /// Part of `weight` that is matte reflection, per channel in [0, 1].
        diffuse_share: Vec3,
        /// Density [1/sr], 0 for a mirror.
        pdf: f32,
        /// Which lobe made it.
        lobe: Lobe,
        /// Light crosses the surface.
        transmitted: bool,
    },
    /// Light comes from under the surface: go on with the profile and [`super::EntryBsdf`].
    Subsurface {
        /// T(ωo), tint of one pass through the coat and mixture weights, over the probability of this
        /// choice; 0 in the channels that are not active. Does not include A.
        weight: Vec3,
    },
}

impl BsdfSample {
    /// What a law has drawn, if it is something.
    fn of(draw: BsdfDraw) -> Option<Self> {
        let BsdfDraw { wi, weight, diffuse_share, pdf, is_transmitted: transmitted, .. } = draw;
        let lobe = match draw.lobe {
            DIFFUSE => Lobe::Diffuse,
            GLOSSY => Lobe::Glossy,
            _ => Lobe::Delta,
        };
        match draw.kind {
            DIRECTION => Some(Self::Direction { wi, weight, diffuse_share, pdf, lobe, transmitted }),
            BELOW => Some(Self::Subsurface { weight }),
            _ => None,
        }
    }

    /// f|cosθi| / pdf.
    pub(crate) fn weight(&self) -> Vec3 {
        match *self {
            Self::Direction { weight, .. } | Self::Subsurface { weight } => weight,
        }
    }
}

/// Light from under a surface beside what the surface itself scatters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightBelow {
    /// Probability with which it is to be followed: twice that of drawing it, up to 1.
    pub(crate) probability: f32,
    /// Its weight then, as in [`BsdfSample::Subsurface`].
    pub(crate) weight: Vec3,
}

/// The BSDF of a surface point seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<'a> {
    law: law::Bsdf,
    tables: AskedTables<'a>,
}

impl<'a> Bsdf<'a> {
    /// The BSDF seen from `wo`; `wo.z` < 0 is from inside.
    ///
    /// `tables` hold the indices of refraction. An opaque surface seen from inside looks as from outside;
    /// of one that is partly clear, the opaque part is bare from inside, and the coat only tints. A thin-walled one has no
    /// inside.
    pub fn new(p: &SurfaceParameters, tables: &'a MaterialTables, wo: Vec3) -> Self {
        let tables = AskedTables::new(tables, p.coat_weight);
        Self { law: law::Bsdf::new(&tables, p, wo), tables }
    }

    /// Returns `true` if light sampling finds nothing: only mirror lobes, subsurface scattering or black.
    pub fn is_smooth_only(&self) -> bool {
        self.law.is_smooth_only()
    }

    /// The share of light that comes from below, of a sample on average; 0 in the channels that are not active. Does not
    /// include A.
    pub(crate) fn below(&self) -> Vec3 {
        self.law.below()
    }

    /// About the hemispherical–directional reflectance, transmission and subsurface color included.
    pub fn albedo(&self) -> Vec3 {
        self.law.albedo
    }

    /// The share of light that goes straight through a thin wall.
    pub fn straight_through_wall(&self) -> Vec3 {
        self.law.straight_through_wall()
    }

    /// Value and density for light from `wi`.
    pub fn eval(&self, wi: Vec3) -> BsdfValue {
        self.law.eval(&self.tables, wi)
    }

    /// Chooses where light comes from; `None` where it would come from nowhere.
    ///
    /// `u` and `v` are uniform in [0, 1).
    pub fn sample(&self, u: f32, v: [f32; 2]) -> Option<BsdfSample> {
        let draw = self.law.draw(&self.tables, u, v);
        let is_complete = draw.kind != DIRECTION || draw.lobe == MIRROR;
        BsdfSample::of(if is_complete { draw } else { draw.weighed(&self.eval(draw.wi)) })
    }

    /// Returns `true` if the surface is clear and smooth: mirrors alone scatter light.
    pub(crate) fn is_clear(&self) -> bool {
        let s = &self.law.strategies;
        let is_opaque = s.subsurface + s.diffuse + s.coat > 0.0;
        let has_rough_facets = s.facets > 0.0 && !self.law.base_facets().is_smooth();
        !is_opaque && self.law.glass.weight > 0.0 && !self.law.is_thin && !has_rough_facets
    }

    /// Reflection and refraction by a [clear](Self::is_clear) surface, each with its share of the light, the smaller one first;
    /// `None` where there is only one.
    pub(crate) fn mirrors(&self) -> Option<[BsdfSample; 2]> {
        let law::Bsdf { wo, glass, coat_transmittance, .. } = self.law;
        let split = self.law.split_at_facet(&self.tables, wo.z);
        let mirror = |wi: Vec3, part: Vec3| BsdfSample::of(self.law.mirror(wi, part * coat_transmittance));
        let reflected = mirror(mirrored(wo, Vec3::Z), split.reflected)?;
        let refracted = mirror(refract(wo, Vec3::Z, glass.eta)?, split.transmitted)?;
        let is_split = split.reflect_probability > 0.0 && split.reflect_probability < 1.0;
        let both =
            if split.reflect_probability < 0.5 { [reflected, refracted] } else { [refracted, reflected] };
        is_split.then_some(both)
    }

    /// Leaves light from under the surface out of the choice of [`sample`](Self::sample), which then always draws a reflection
    /// if there is one, so that light from below can be followed beside it.
    ///
    /// `None`, and nothing changes, where no light comes from below.
    pub(crate) fn split_below(&mut self) -> Option<LightBelow> {
        let law = &mut self.law;
        let subsurface = law.strategies.subsurface;
        if subsurface == 0.0 {
            return None;
        }
        law.strategies = law::Strategies { subsurface: 0.0, ..law.strategies }.normalized();
        let probability = (2.0 * subsurface).min(1.0);
        Some(LightBelow { probability, weight: law.subsurface / probability })
    }
}
