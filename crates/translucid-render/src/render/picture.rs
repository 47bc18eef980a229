//! Pictures of a film: all its layers for a float image, its colors for a display.

use translucid_image::{Denoised, Denoiser, MetadataValue, OutputError, Picture, PictureChannel, PixelRect};

use super::film::{FilmSums, mean_depth, radiance};
use crate::world::layer;

/// Metadata of a rendered picture, and the picture denoised.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageInfo {
    /// Where the scene came from.
    pub scene: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Samples per pixel: the fewest that any pixel has.
    pub samples: u32,
    /// Time spent rendering, in seconds, over all runs that added to the picture.
    pub seconds: f64,
    /// The command line that made it.
    pub command: String,
    /// Where the picture lies in a larger one, and that one's width and height; `None` where it is all there is.
    pub place: Option<(PixelRect, [u32; 2])>,
    /// The picture denoised, if it was; pixels that it does not have are 0.
    pub denoised: Option<Denoised>,
}

/// Program and version, as all pictures state it.
const SOFTWARE: &str = concat!("translucid ", env!("CARGO_PKG_VERSION"));

impl ImageInfo {
    /// A picture in its place with notes, and one on its denoiser.
    ///
    /// `fill` is given the column and row of a pixel in the film, and the place for its values.
    fn picture<'a>(
        &self,
        film: &FilmSums,
        channels: Vec<PictureChannel>,
        fill: impl Fn(u32, u32, &mut [f64]) + Sync + 'a,
        notes: Vec<(&str, MetadataValue)>,
        denoiser: &str,
    ) -> Picture<'a> {
        let by = self.denoised.iter().map(|denoised| (denoiser, MetadataValue::Text(denoised.by.clone())));
        let notes = notes.into_iter().chain(by).map(|(name, value)| (name.to_owned(), value)).collect();
        let (count, top) = (channels.len(), self.place.map_or(0, |(region, _)| region.top));
        let fill_row = move |y: u32, values: &mut [f64]| {
            for (x, pixel) in (0..).zip(values.chunks_exact_mut(count)) {
                fill(x, y - top, pixel);
            }
        };
        let picture = Picture::new([film.width, film.height], channels, fill_row);
        let picture = match self.place {
            Some((region, whole)) => picture.within(region, whole),
            None => picture,
        };
        picture.with_metadata(SOFTWARE, notes)
    }
}

/// Channels of 32 bits in a picture of all layers, before those of 16.
const SINGLE_CHANNELS: [&str; 5] = ["R", "G", "B", "A", "depth.Z"];

/// Channels of a denoised picture beside the noisy ones.
const DENOISED_CHANNELS: [&str; 3] = ["denoised.R", "denoised.G", "denoised.B"];

impl FilmSums {
    /// All layers as a picture.
    ///
    /// | channels | content | type |
    /// |---|---|---|
    /// | `R G B A` | radiance and coverage | 32-bit |
    /// | `diffuse.RGB`, `specular.RGB`, `subsurface.RGB`, `emission.RGB` | light by its last event before the camera; they sum to `RGB` | 16-bit |
    /// | `albedo.RGB` | albedo of the first surface | 16-bit |
    /// | `normal.XYZ` | shading normal of the first surface, world space | 16-bit |
    /// | `depth.Z` | mean distance to the first surface \[L\], 0 where there is none | 32-bit |
    /// | `denoised.RGB` | radiance denoised, if it was | 32-bit |
    ///
    /// Colors are linear Rec. 709 and multiplied by coverage; so are albedo and normal.
    pub fn layers_picture<'a>(&'a self, info: &'a ImageInfo) -> Picture<'a> {
        let halves = half_channels();
        let mut channels: Vec<_> = SINGLE_CHANNELS.into_iter().map(PictureChannel::single).collect();
        channels.extend(halves.iter().map(|(name, _)| PictureChannel::half(name)));
        if info.denoised.is_some() {
            channels.extend(DENOISED_CHANNELS.into_iter().map(PictureChannel::single));
        }
        let fill = move |x, y, pixel: &mut [f64]| {
            let mean = self.mean(x, y);
            let [r, g, b] = radiance(&mean);
            let singles = [r, g, b, mean[layer::ALPHA], mean_depth(&mean)];
            let halves = halves.iter().map(|(_, index)| mean[*index]);
            let color = info.denoised.iter().flat_map(|denoised| self.denoised_pixel(denoised, x, y));
            let all = singles.into_iter().chain(halves).chain(color);
            pixel.iter_mut().zip(all).for_each(|(place, value)| *place = value);
        };
        let text = |text: &str| MetadataValue::Text(text.to_owned());
        let notes = vec![
            ("translucidScene", text(&info.scene)),
            ("translucidCommand", text(&info.command)),
            ("translucidVersion", text(env!("CARGO_PKG_VERSION"))),
            // OpenEXR has no 64-bit integer.
            ("translucidSeed", MetadataValue::Text(info.seed.to_string())),
            ("translucidSamples", MetadataValue::Integer(i32::try_from(info.samples).unwrap_or(i32::MAX))),
            ("translucidSeconds", MetadataValue::Real(info.seconds)),
        ];
        info.picture(self, channels, fill, notes, "translucidDenoiser")
    }

    /// Radiance, denoised if it was, and coverage as a picture for a display.
    ///
    /// Its notes have no time, so that equal sums give equal files.
    pub fn display_picture<'a>(&'a self, info: &'a ImageInfo) -> Picture<'a> {
        let channels = ["R", "G", "B", "A"].map(PictureChannel::single);
        let fill = move |x, y, pixel: &mut [f64]| {
            let (mean, denoised) = (self.mean(x, y), info.denoised.as_ref());
            let color =
                denoised.map_or_else(|| radiance(&mean), |denoised| self.denoised_pixel(denoised, x, y));
            pixel[..3].copy_from_slice(&color);
            pixel[3] = mean[layer::ALPHA];
        };
        let notes = vec![
            ("Scene", MetadataValue::Text(info.scene.clone())),
            ("Seed", MetadataValue::Text(info.seed.to_string())),
            ("Samples", MetadataValue::Text(info.samples.to_string())),
        ];
        info.picture(self, channels.to_vec(), fill, notes, "Denoiser")
    }

    /// Denoises the radiance, on `threads` threads or, if that is 0, as many as there are.
    ///
    /// # Errors
    /// As [`Denoiser::denoise`].
    pub fn denoise(&self, denoiser: &Denoiser, threads: usize) -> Result<Denoised, OutputError> {
        denoiser.denoise(&self.layers_picture(&ImageInfo::default()), threads)
    }

    /// Denoised radiance of a pixel; 0 where there is none.
    fn denoised_pixel(&self, denoised: &Denoised, x: u32, y: u32) -> [f64; 3] {
        let index = y as usize * self.width as usize + x as usize;
        denoised.radiance.get(index).copied().unwrap_or_default().map(f64::from)
    }
}

/// Channels of 16 bits: name and index among the sums.
fn half_channels() -> Vec<(String, usize)> {
    [
        ("diffuse", layer::DIFFUSE, "RGB"),
        ("specular", layer::SPECULAR, "RGB"),
        ("subsurface", layer::SUBSURFACE, "RGB"),
        ("emission", layer::EMISSION, "RGB"),
        ("albedo", layer::ALBEDO, "RGB"),
        ("normal", layer::NORMAL, "XYZ"),
    ]
    .into_iter()
    .flat_map(|(name, range, components)| {
        range.zip(components.chars()).map(move |(index, component)| (format!("{name}.{component}"), index))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};
    use translucid_profile::Model;
    use translucid_scene::{
        Camera, Film, Light, Material, Object, ScalarInput, Scene, SubsurfaceModel, Unit,
    };
    use translucid_shapes::{ShapeParameters, build_shape};

    use super::*;
    use crate::SampleRanges;
    use crate::render::film::tests::test_film;
    use crate::{PreparedScene, internals};

    /// The values of all pixels of a channel.
    fn values(picture: &Picture<'_>, name: &str) -> Vec<f64> {
        let [width, height] = picture.size();
        let index = picture.channels.iter().position(|channel| channel.name == name).unwrap();
        let mut row = vec![0.0; width * picture.channels.len()];
        let mut values = Vec::new();
        for y in 0..height as u32 {
            picture.read_row(y, &mut row);
            values.extend(row.chunks(picture.channels.len()).map(|pixel| pixel[index]));
        }
        values
    }

    fn pixels(film: &FilmSums) -> impl Iterator<Item = (u32, u32)> {
        PixelRect::whole([film.width, film.height]).pixels()
    }

    #[test]
    fn layers_picture_has_every_layer_and_the_metadata() {
        let film = test_film(37, 21);
        let info = ImageInfo {
            scene: String::from("scenes/apple.toml"),
            seed: u64::MAX,
            samples: 5,
            seconds: 1.25,
            command: String::from("translucid render scenes/apple.toml"),
            ..ImageInfo::default()
        };
        let picture = film.layers_picture(&info);
        assert_eq!(picture.channels.len(), 23);
        assert_eq!(picture.size(), [37, 21]);
        let layers = [
            ("A", layer::ALPHA),
            ("diffuse.G", layer::DIFFUSE.start + 1),
            ("subsurface.R", layer::SUBSURFACE.start),
            ("emission.B", layer::EMISSION.start + 2),
            ("albedo.B", layer::ALBEDO.start + 2),
            ("normal.Z", layer::NORMAL.start + 2),
        ];
        for (name, index) in layers {
            let expected: Vec<f64> = pixels(&film).map(|(x, y)| film.mean(x, y)[index]).collect();
            assert_eq!(values(&picture, name), expected, "{name}");
        }
        let green: Vec<f64> = pixels(&film).map(|(x, y)| film.radiance(x, y)[1]).collect();
        assert_eq!(values(&picture, "G"), green);
        assert_eq!(values(&film.display_picture(&info), "G"), green);
        for (name, value) in [
            ("translucidScene", MetadataValue::Text(info.scene.clone())),
            ("translucidSeed", MetadataValue::Text(u64::MAX.to_string())),
            ("translucidSamples", MetadataValue::Integer(5)),
            ("translucidSeconds", MetadataValue::Real(1.25)),
        ] {
            assert!(picture.metadata.contains(&(name.to_owned(), value)), "{name}");
        }
        // Equal sums give equal files for displays, however long they took.
        let later = ImageInfo { seconds: 2.0, command: String::new(), ..info.clone() };
        assert_eq!(film.display_picture(&info).metadata, film.display_picture(&later).metadata);
    }

    #[test]
    fn denoised_stands_beside_the_layers_and_in_place_of_the_colors() {
        let film = test_film(7, 5);
        let radiance = (0..34).map(|i| [i as f32, 2.0, 0.5]).collect();
        let denoised = Some(Denoised { radiance, by: String::from("a broom 1.0.0") });
        let infos = [None, denoised].map(|denoised| ImageInfo { denoised, ..ImageInfo::default() });
        let [plain, both] = infos.each_ref().map(|info| film.layers_picture(info));
        assert_eq!(both.channels[..plain.channels.len()], plain.channels);
        for channel in &plain.channels {
            assert_eq!(values(&both, &channel.name), values(&plain, &channel.name), "{}", channel.name);
        }
        let mut expected: Vec<f64> = (0..34).map(f64::from).collect();
        expected.push(0.0);
        assert_eq!(values(&both, "denoised.R"), expected);
        let display = film.display_picture(&infos[1]);
        assert_eq!(values(&display, "R"), expected);
        assert_eq!(values(&display, "A"), values(&plain, "A"));
        let by = |picture: &Picture<'_>| picture.metadata.iter().any(|(name, _)| name.ends_with("Denoiser"));
        assert!(by(&both) && by(&display) && !by(&plain));
    }

    #[test]
    fn depth_is_the_mean_over_samples_that_hit() {
        let mut film = FilmSums::new(2, 1);
        film.tiles[0].taken = SampleRanges::from(0..4);
        // One of four samples sees a surface 10 away, the others a visible sky.
        let sums = &mut film.tiles[0].pixels_mut()[0];
        (sums[layer::ALPHA], sums[layer::DEPTH], sums[layer::SURFACE]) = (4.0, 10.0, 1.0);
        assert_eq!(values(&film.layers_picture(&ImageInfo::default()), "depth.Z"), [10.0, 0.0]);
    }

    /// A ball of wax under a lamp.
    fn picture(samples: u32, seed: u64) -> FilmSums {
        let wax = Material {
            subsurface_weight: ScalarInput::constant(1.0),
            subsurface_radius: ScalarInput::constant(0.2),
            subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique),
            ..Material::default()
        };
        let shape = |name: &str, parameters: &ShapeParameters, material, z| Object {
            mesh: build_shape(name, parameters)
                .expect("a shape")
                .transformed(&Affine3A::from_translation(Vec3::Z * z))
                .into(),
            material,
            subsurface_group: material as u32,
            ..Object::default()
        };
        let wall = ShapeParameters::new().with("width", 20.0).with("height", 20.0);
        let mut scene = Scene {
            unit: Unit::Centimeter,
            camera: Camera { position: Vec3::new(0.0, 1.0, 5.0), ..Camera::default() },
            film: Film { width: 96, height: 64, ..Film::default() },
            objects: vec![
                shape("sphere", &ShapeParameters::new(), 0, 0.0),
                shape("rectangle", &wall, 1, -2.0),
            ],
            materials: vec![wax, Material::default()],
            lights: vec![Light::Rectangle {
                center: Vec3::new(-4.0, 4.0, 2.0),
                edge_x: Vec3::new(0.9, 0.0, 1.8),
                edge_y: Vec3::new(1.2, 1.5, -0.6),
                radiance: Vec3::splat(10.0),
                visible: true,
            }],
            ..Scene::default()
        };
        scene.integrator.seed = seed;
        let prepared = PreparedScene::new(scene).unwrap();
        let mut film = FilmSums::new(96, 64);
        internals::add_samples(&prepared, &mut film, samples).unwrap();
        film
    }

    /// Mean of (x − ref)² / (ref² + 0.01) over all channels.
    fn relative_mse(image: impl Fn(u32, u32) -> [f64; 3], reference: &FilmSums) -> f64 {
        let mut sum = 0.0;
        for (x, y) in pixels(reference) {
            for (value, truth) in image(x, y).into_iter().zip(reference.radiance(x, y)) {
                sum += (value - truth).powi(2) / (truth * truth + 0.01);
            }
        }
        sum / f64::from(3 * reference.width * reference.height)
    }

    /// Runs where the library is, else it says that it does not.
    #[test]
    #[allow(clippy::print_stderr, reason = "a test that does nothing must say so")]
    fn denoised_picture_is_closer_to_the_truth() {
        let denoiser = match Denoiser::load() {
            Ok(denoiser) => denoiser,
            Err(error) => return eprintln!("skipped: {error}"),
        };
        let mut noisy = picture(4, 1);
        let reference = picture(1024, 2);
        let denoised = noisy.denoise(&denoiser, 1).unwrap();
        assert!(denoised.by.starts_with("Open Image Denoise "), "{}", denoised.by);
        let before = relative_mse(|x, y| noisy.radiance(x, y), &reference);
        let at = |x: u32, y: u32| denoised.radiance[(y * noisy.width + x) as usize].map(f64::from);
        let after = relative_mse(at, &reference);
        assert!(after < 0.5 * before, "relMSE {before} before and {after} after");

        // NaN and infinity come out as finite numbers
        noisy.tiles[0].pixels_mut()[0] = [f64::NAN; layer::COUNT];
        noisy.tiles[0].pixels_mut()[1] = [f64::INFINITY; layer::COUNT];
        let denoised = noisy.denoise(&denoiser, 0).unwrap();
        assert!(denoised.radiance.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
    }
}
