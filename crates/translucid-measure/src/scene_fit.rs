//! The material of a scene whose picture is the photograph: a [`KnownShape`] whose pictures this renderer makes.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_render::{Edit, Event, FilmLayer, Outcome, Plan, PreparedScene, Session, View, content_hash};
use translucid_scene::{ColorInput, Material, ScalarInput, Scene, SubsurfaceMethod};

use crate::error::MeasureError;
use crate::known_shape::{Estimate, KnownShape, Progress, Request, SEEDS};
use crate::limitations::MISFIT;
use crate::linear_photo::{NamedPhoto, Photo};
use crate::measurement::Quantity;
use crate::options::check_rectangle;
use crate::remark::{CHANNELS, Remark, three_digits};
use crate::scene_material::{has_texture_of_mfp, material_named, start};
use crate::unknown::{Guess, Unknown};

/// Most pixels: a step keeps twenty pictures of them.
const MOST_PIXELS: usize = 1 << 22;

/// Steps that a fit usually takes, for the time that is left.
const USUAL_STEPS: u64 = 6;

/// Standard error of ln ℓ, ln A/(1 − A) or artanh g from which on the picture does not determine a parameter.
const UNDETERMINED: f64 = 0.5;

/// What is fitted in a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneOptions {
    /// Parameters to find.
    pub unknowns: Vec<Unknown>,
    /// Name of the material that they belong to; by default the only translucent one.
    pub material: Option<String>,
    /// Part of the photograph that is fitted, from (x0, y0) to before (x1, y1); by default all of it.
    pub region: Option<[usize; 4]>,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// A fit of a scene's material to a photograph.
pub struct SceneFit {
    fit: KnownShape,
    session: Session,
    views: [View; SEEDS],
    material: usize,
    samples: u32,
    /// A text that differs where scene, photograph or parameters do.
    fingerprint: String,
}

/// The way that a step of a fit has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepEnd {
    /// There is another guess to try.
    Moved,
    /// The parameters are found.
    Found,
    /// It was stopped, and its pictures are lost.
    Stopped,
}

impl SceneFit {
    /// A fit that starts at the numbers of the scene. Values of exactly 1 in the photograph are taken as clipped.
    ///
    /// # Errors
    /// The photograph has another size than the scene's film or a black channel, the scene has no such material, or one whose
    /// parameters are images.
    pub fn new(photo: &NamedPhoto, scene: Scene, options: &SceneOptions) -> Result<Self, MeasureError> {
        let SceneOptions { unknowns, seed, .. } = options;
        if scene.integrator.subsurface_method == SubsurfaceMethod::PointBased {
            let message = "the scene's subsurface_method is point-based, which measuring does not do";
            return Err(MeasureError::new(message).with_help("use ray-traced"));
        }
        let material = material_named(&scene, options.material.as_deref())?;
        let start = start(&scene.materials[material], unknowns)?;
        let (photo, region) = checked(photo, &scene, options.region)?;
        let samples = scene.integrator.samples_per_pixel;
        // Others than those that a photograph of `render` has
        let mixed = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let view = |number: u64| -> Result<View, MeasureError> {
            let view = View::new(scene.camera, scene.film, mixed.wrapping_add(number))?;
            Ok(view.with_region(region.map(|edge| edge as u32))?)
        };
        let views = [view(0)?, view(1)?];
        let prepared = PreparedScene::new(scene)?;

        let of_scene = prepared.fingerprint(&views[0]);
        let text = format!("{of_scene:?} {:?} {unknowns:?} {samples} {material}", views[0].region());
        let values = photo.pixels.iter().flatten().flat_map(|value| value.to_le_bytes());
        let fingerprint = content_hash(&text.into_bytes().into_iter().chain(values).collect::<Vec<u8>>());
        let fit = KnownShape::new(photo, unknowns, start);
        let session = Session::new(prepared, views[0].clone());
        Ok(Self { fit, session, views, material, samples, fingerprint })
    }

    /// Renders the pictures of a guess, and moves on to the next one.
    ///
    /// `progress` is called now and then with the camera paths that are traced, and with those that a usual fit takes.
    ///
    /// # Errors
    /// A picture cannot be rendered.
    pub fn step(
        &mut self,
        progress: &(dyn Fn(u64, u64) + Sync),
        stop: &AtomicBool,
    ) -> Result<StepEnd, MeasureError> {
        while let Some(request) = self.fit.next() {
            let done = self.paths_traced();
            let expected = self.paths_expected();
            let Some(picture) = self.picture(&request, &|count| progress(done + count, expected), stop)?
            else {
                return Ok(StepEnd::Stopped);
            };
            self.fit.take(picture);
            if self.fit.pictures() == 0 {
                return Ok(StepEnd::Moved);
            }
        }
        Ok(StepEnd::Found)
    }

    fn pictures_taken(&self) -> u64 {
        let of_step = self.fit.pictures_of_a_step() as u64;
        u64::from(self.fit.progress().steps) * of_step + self.fit.pictures() as u64
    }

    /// Camera paths of the pictures so far.
    pub fn paths_traced(&self) -> u64 {
        self.pictures_taken() * u64::from(self.samples) * self.views[0].region().area()
    }

    /// Camera paths of all pictures, if it takes as many steps as usual.
    fn paths_expected(&self) -> u64 {
        let of_step = self.fit.pictures_of_a_step() as u64;
        let pictures = (USUAL_STEPS * of_step).max(self.pictures_taken().next_multiple_of(of_step));
        pictures * u64::from(self.samples) * self.views[0].region().area()
    }

    /// Renders a picture; none where it was stopped.
    fn picture(
        &mut self,
        request: &Request,
        done: &(dyn Fn(u64) + Sync),
        stop: &AtomicBool,
    ) -> Result<Option<Photo>, MeasureError> {
        let material = guessed(self.material(), &request.guess);
        self.session.edit(Edit::Material(self.material, Box::new(material)))?;
        self.session.set_view(self.views[request.seed].clone());
        let observer = |event: &Event<'_>| {
            if let Event::Samples(progress) = event {
                done(progress.samples_done);
            }
        };
        if self.session.run(&Plan::samples(self.samples), &observer, stop)? != Outcome::Finished {
            return Ok(None);
        }
        let region = self.session.view().region();
        let values = self.session.film().layer(FilmLayer::Radiance);
        let pixels = values.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Ok(Some(Photo { width: region.width as usize, height: region.height as usize, pixels }))
    }

    /// The scene, with the material of the picture that was rendered last.
    pub fn scene(&self) -> &PreparedScene {
        self.session.prepared()
    }

    /// The material.
    pub fn material(&self) -> &Material {
        &self.scene().scene().materials[self.material]
    }

    /// The guess where the fit is.
    pub fn guess(&self) -> Guess {
        self.fit.progress().guess
    }

    /// Progress of the fit, for a later run.
    pub fn progress(&self) -> Progress {
        self.fit.progress()
    }

    /// Goes on from where an earlier fit with the same [fingerprint](Self::fingerprint) was.
    pub fn resume(&mut self, progress: Progress) {
        self.fit.resume(progress);
    }

    /// A text that differs where scene, photograph or parameters do.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// The parameters where the fit is, with intervals once a step has been taken.
    pub fn quantities(&self) -> Vec<Quantity> {
        let quantity = |estimate: &Estimate| {
            let [name, unit] = estimate.unknown.quantity();
            Quantity { channel: estimate.channel, name, unit, interval: estimate.interval }
        };
        self.fit.estimates().iter().map(quantity).collect()
    }

    /// Limits of the measurement.
    pub fn limitations(&self) -> Vec<Remark> {
        let mut all = Vec::new();
        for estimate in self.fit.estimates() {
            if estimate.standard_error.is_nan() || estimate.standard_error > UNDETERMINED {
                let [low, high] = estimate.interval.sure.map(three_digits);
                let channel = estimate.channel.map_or("all", |channel| CHANNELS[channel]);
                let [name, _] = estimate.unknown.quantity();
                let message =
                    format!("the picture does not tell {channel} {name}: it may be {low} to {high}");
                all.push(Remark::Note(message));
            }
        }
        if !self.fit.has_converged() {
            all.push(Remark::Warning(format!(
                "the fit did not settle in {} steps: the intervals do not hold; more `spp`, or fewer parameters, may help",
                self.progress().steps
            )));
        }
        let misfit = self.fit.misfit();
        if misfit > MISFIT {
            all.push(Remark::Warning(format!(
                "the picture is not that of the scene: neighboring pixels are off together, by {:.1} times what noise \
                 would (another shape, camera or light, a surface that is not smooth, a camera's curve?)",
                misfit.sqrt()
            )));
        }
        all
    }
}

/// The region of a photograph that a fit can take, and where it is.
fn checked(
    photo: &NamedPhoto,
    scene: &Scene,
    region: Option<[usize; 4]>,
) -> Result<(Photo, [usize; 4]), MeasureError> {
    let refuse = |message: String| MeasureError::of_photo(&photo.name, message);
    let Photo { width, height, .. } = photo.photo;
    let [w, h] = [scene.film.width, scene.film.height];
    if [width, height] != [w, h].map(|edge| edge as usize) {
        let message = format!("is {width}×{height} pixels, but the scene's film has {w}×{h}");
        return Err(refuse(message).with_help("state the photograph's size in [film]"));
    }
    check_rectangle("region", region)?;
    let region = region.unwrap_or([0, 0, width, height]);
    let part = photo.part("region", region)?;
    let pixels = part.pixels.len();
    if pixels > MOST_PIXELS {
        let message = format!("has {pixels} pixels to fit, but at most {MOST_PIXELS} are");
        return Err(refuse(message).with_help("scale it and [film] down, or choose a `region`"));
    }
    if part.mean().iter().any(|mean| mean.is_nan() || *mean <= 0.0) {
        return Err(refuse(String::from("a channel is black")));
    }
    Ok((part, region))
}

/// A material with the numbers of a guess in place of its own, but for its images.
fn guessed(material: &Material, guess: &Guess) -> Material {
    let color = |values: [f64; 3]| ColorInput::constant(Vec3::from_array(values.map(|v| v as f32)));
    let mut new = Material { subsurface_scatter_anisotropy: guess.g as f32, ..material.clone() };
    if new.subsurface_color.texture.is_none() && !new.subsurface_color.vertex_color {
        new.subsurface_color = color(guess.surface_albedo);
    }
    if !has_texture_of_mfp(&new) {
        new.subsurface_radius = ScalarInput::constant(1.0);
        new.subsurface_radius_scale = color(guess.mfp);
    }
    new
}
