//! Settings of the film and of the light transport, as data and by their keys.

use translucid_display::ToneMapping;

use crate::SceneError;
use crate::description::{Counts, Fallback, Key, SceneSlot, Thing, Word, field};
use translucid_words::{Interval, WholeInterval};

use Fallback::{Plain, Words};

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

impl Word for FilterKind {
    const WORDS: &'static [(&'static str, Self)] =
        &[("box", Self::Box), ("gaussian", Self::Gaussian), ("blackman-harris", Self::BlackmanHarris)];
}

const SIZE: &[Key] = &[Key::new("size", "`[width, height]` in pixels, each {range}", Plain)];

impl Film {
    /// Most pixels along an edge; the fewest is one.
    pub const LONGEST_EDGE: u32 = 16_384;
    /// Range of `width` and `height`.
    pub const EDGE: WholeInterval = WholeInterval::new(1, Self::LONGEST_EDGE as u64);

    /// The film by its keys.
    pub const DESCRIPTION: Thing<Self> = Thing {
        name: "film",
        doc: "size and look of the picture",
        plain: Self::default,
        fields: &[
            field!(Film { width, height } => SceneSlot::Size([width, height], Self::EDGE); SIZE),
            field!(Film { filter } => SceneSlot::Word(filter), "{words}", Plain).when_given(|film| {
                if film.filter == FilterKind::Box {
                    film.filter_radius = 0.5; // One pixel; that of the bells is their usual extent.
                }
            }),
            field!(Film { filter_radius } => SceneSlot::Number(filter_radius, Interval::above(0.0, 8.0)),
                "half the filter's extent in pixels, {range}", Words("0.5 for the box, else 1.5")),
            field!(Film { exposure } => SceneSlot::Number(exposure, Interval::closed(-32.0, 32.0)),
                "stops, {range}; for PNG only", Plain),
            field!(Film { tone_mapping } => SceneSlot::Word(tone_mapping), "{words}, which is Sobotka's AgX of 2022 and not Blender's; for PNG only", Plain),
        ],
        rules: &[],
    };

    /// Checks every field.
    ///
    /// # Errors
    /// A number is out of its range.
    pub fn validate(&self) -> Result<(), SceneError> {
        Self::DESCRIPTION.check(self, &Counts::default()).map_err(|error| error.within("film"))
    }
}

/// Method that finds light under a surface described by a profile.
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

impl Word for SubsurfaceMethod {
    /// In the order of the variants.
    const WORDS: &'static [(&'static str, Self)] = &[
        ("ray-traced", Self::RayTraced),
        ("point-based", Self::PointBased),
        ("cycles-disk", Self::CyclesDisk),
    ];
}

impl SubsurfaceMethod {
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
    /// Method that finds light under surfaces.
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
    /// The settings of light transport by their keys.
    pub const DESCRIPTION: Thing<Self> = Thing {
        name: "integrator",
        doc: "how many paths are traced, and how far",
        plain: Self::default,
        fields: &[
            field!(Integrator { samples_per_pixel } => SceneSlot::Count(samples_per_pixel, WholeInterval::new(1, 1 << 24)),
                "{range}", Plain),
            field!(Integrator { max_depth } => SceneSlot::Count(max_depth, WholeInterval::new(1, 1024)),
                "most scattering events on a path, {range}; one under the surface counts as one", Plain),
            field!(Integrator { max_diffuse_depth } => SceneSlot::Count(max_diffuse_depth, WholeInterval::new(0, 1024)),
                "most diffuse or subsurface events among them, {range}; fewer make folds and bright things darker and save next to no time, as few paths get there", Plain),
            field!(Integrator { caustics } => SceneSlot::Flag(caustics),
                "whether a glossy event after a diffuse one may meet light", Plain),
            field!(Integrator { subsurface_tail } => SceneSlot::Number(subsurface_tail, Interval::above(0.0, 0.1)),
                "share of a profile beyond the longest probe, {range}; lower it where light travels far through something dark", Plain),
            field!(Integrator { subsurface_method } => SceneSlot::Word(subsurface_method),
                "`\"ray-traced\"`: every path looks for an entry point; `\"point-based\"`: the light that enters is computed at points beforehand and summed, see [Point-based](point-based.md); `\"cycles-disk\"`: ray-traced with the weights of Blender Cycles' Christensen-Burley, [for its look](blender.md#subsurface-scattering)", Plain),
            field!(Integrator { subsurface_sharing } => SceneSlot::Flag(subsurface_sharing),
                "whether light that has entered below one pixel serves the pixels around it, when rays are traced: less noise in the same time, and what is left varies less from pixel to pixel, where light travels a pixel and a half or more below the surface; random walks share where scattering is isotropic; see [How fast, and why](../speed/how-fast.md#light-shared-between-pixels)", Plain),
            field!(Integrator { point_tolerance } => SceneSlot::Number(point_tolerance, Interval::closed(0.001, 1.0)),
                "relative error that the point-based method may make, {range}", Plain),
            field!(Integrator { point_memory } => SceneSlot::Count(point_memory, WholeInterval::new(1, 1 << 20)),
                "most memory for its points, MiB, {range}", Plain),
            field!(Integrator { seed } => SceneSlot::Seed(seed), "whole number in [0, 2⁶⁴)", Plain),
        ],
        rules: &[],
    };

    /// Checks every field.
    ///
    /// # Errors
    /// A number is out of its range.
    pub fn validate(&self) -> Result<(), SceneError> {
        Self::DESCRIPTION.check(self, &Counts::default()).map_err(|error| error.within("integrator"))
    }
}
