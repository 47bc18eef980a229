//! Settings of the film and of the light transport.

use translucid_display::ToneMapping;

use crate::SceneError;
use crate::interval::{Interval, WholeInterval};

/// Reconstruction filter of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilterKind {
    /// Constant over the square of the filter's radius.
    Box,
    /// Truncated Gaussian, standard deviation radius / 3.
    Gaussian,
    /// Blackman–Harris window, four terms.
    BlackmanHarris,
}

/// Image size, filter and display transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Width in pixels, in [1, 16384].
    pub width: u32,
    /// Height in pixels, in [1, 16384].
    pub height: u32,
    /// Filter kind.
    pub filter: FilterKind,
    /// Half the filter's extent in pixels, in (0, 8]; 0.5 is one pixel for the box.
    pub filter_radius: f32,
    /// Exposure of the PNG in stops, in [−32, 32]; the EXR is untouched.
    pub exposure: f32,
    /// Display transform of the PNG.
    pub tone_mapping: ToneMapping,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            width: 960,
            height: 540,
            filter: FilterKind::BlackmanHarris,
            filter_radius: 1.5,
            exposure: 0.0,
            tone_mapping: ToneMapping::Neutral,
        }
    }
}

impl Film {
    /// Most pixels along an edge; the fewest is one.
    pub const LONGEST_EDGE: u32 = 16_384;
    /// Range of `width` and `height`.
    pub const EDGE: WholeInterval = WholeInterval::new(1, Self::LONGEST_EDGE as u64);
    /// Range of `filter_radius`.
    pub const FILTER_RADIUS: Interval = Interval::above(0.0, 8.0);
    /// Range of `exposure`.
    pub const EXPOSURE: Interval = Interval::closed(-32.0, 32.0);

    /// Checks every field.
    ///
    /// # Errors
    /// A number is out of its range.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.check().map_err(|error| error.within("film"))
    }

    fn check(&self) -> Result<(), SceneError> {
        Self::EDGE.check("width", self.width)?;
        Self::EDGE.check("height", self.height)?;
        Self::FILTER_RADIUS.check("filter_radius", self.filter_radius)?;
        Self::EXPOSURE.check("exposure", self.exposure)
    }
}

/// How light under a surface is found where a profile describes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SubsurfaceMethod {
    /// Each path looks for a point where light enters, by probes.
    RayTraced,
    /// Light that enters is computed at points all over the surface beforehand; a path sums over them.
    PointBased,
    /// Ray-traced as Blender Cycles does it for Christensen-Burley: hits of probes weigh what they weigh there, and surfaces that
    /// a path meets after a diffuse event are Lambertian.
    CyclesDisk,
}

impl SubsurfaceMethod {
    /// Every method by its name, in the order of the variants.
    pub const WORDS: [(&str, Self); 3] = [
        ("ray-traced", Self::RayTraced),
        ("point-based", Self::PointBased),
        ("cycles-disk", Self::CyclesDisk),
    ];

    /// The method's name as scene files and the command line write it.
    pub const fn name(self) -> &'static str {
        Self::WORDS[self as usize].0
    }

    /// The method that scene files and the command line call `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(word, _)| *word == name).map(|&(_, method)| method)
    }
}

/// Samples and path limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrator {
    /// Samples per pixel, in [1, 2^24].
    pub samples_per_pixel: u32,
    /// Largest number of scattering events on a path, in [1, 1024]; 1 is direct light only.
    /// A subsurface event (exit to entry) counts as one.
    pub max_depth: u32,
    /// Largest number of these events that are diffuse or subsurface, in [0, 1024].
    pub max_diffuse_depth: u32,
    /// Whether a glossy or transmissive event after a diffuse one may meet light (caustics).
    pub caustics: bool,
    /// Energy of a subsurface profile beyond the longest probe, in (0, 0.1]; the profile is renormalized to what is left,
    /// so a plane loses none. What comes through a thick body does: of light from beyond a distance the share tail / E is
    /// missing, E being the profile's energy beyond that distance.
    pub subsurface_tail: f32,
    /// How light under surfaces is found.
    pub subsurface_method: SubsurfaceMethod,
    /// Whether light that has entered below one pixel serves the pixels around it. The mean of a picture is the same
    /// with less noise; what is left of it varies less from pixel to pixel.
    pub subsurface_sharing: bool,
    /// Relative error that the point-based method may make, in [0.001, 1]: it decides how close the points lie, how
    /// exact their light is, and how far sums over distant points are refined.
    pub point_tolerance: f32,
    /// Most memory for points, in MiB, in [1, 2^20].
    pub point_memory: u32,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for Integrator {
    fn default() -> Self {
        Self {
            samples_per_pixel: 64,
            max_depth: 32,
            max_diffuse_depth: 16,
            caustics: false,
            subsurface_tail: 1e-3,
            subsurface_method: SubsurfaceMethod::RayTraced,
            subsurface_sharing: true,
            point_tolerance: 0.05,
            point_memory: 2048,
            seed: 0,
        }
    }
}

impl Integrator {
    /// Range of `samples_per_pixel`.
    pub const SAMPLES: WholeInterval = WholeInterval::new(1, 1 << 24);
    /// Range of `max_depth`.
    pub const DEPTH: WholeInterval = WholeInterval::new(1, 1024);
    /// Range of `max_diffuse_depth`.
    pub const DIFFUSE_DEPTH: WholeInterval = WholeInterval::new(0, 1024);
    /// Range of `subsurface_tail`.
    pub const TAIL: Interval = Interval::above(0.0, 0.1);
    /// Range of `point_tolerance`.
    pub const TOLERANCE: Interval = Interval::closed(0.001, 1.0);
    /// Range of `point_memory`.
    pub const MEMORY: WholeInterval = WholeInterval::new(1, 1 << 20);

    /// Checks every field.
    ///
    /// # Errors
    /// A number is out of its range.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.check().map_err(|error| error.within("integrator"))
    }

    fn check(&self) -> Result<(), SceneError> {
        Self::SAMPLES.check("samples_per_pixel", self.samples_per_pixel)?;
        Self::DEPTH.check("max_depth", self.max_depth)?;
        Self::DIFFUSE_DEPTH.check("max_diffuse_depth", self.max_diffuse_depth)?;
        Self::TAIL.check("subsurface_tail", self.subsurface_tail)?;
        Self::TOLERANCE.check("point_tolerance", self.point_tolerance)?;
        Self::MEMORY.check("point_memory", self.point_memory)
    }
}
