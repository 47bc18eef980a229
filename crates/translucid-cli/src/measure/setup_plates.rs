//! The photograph beside a rendering of the same setup with the material that was measured.

use std::path::Path;

use translucid_image::{CodedPicture, ToneMapping, display_from_linear};
use translucid_laboratory::Plate;
use translucid_load::{LoadOptions, SceneFile};
use translucid_measure::{Resynthesis, ResynthesizedPictures};
use translucid_render::{FilmLayer, Outcome, Plan, PreparedScene, Session, View};

use crate::failure::Failure;
use crate::interrupt;

/// Name of the scene's file.
pub(super) const SCENE: &str = "setup.toml";

/// The region of the photograph, and the picture of its scene; none where it was interrupted.
pub(super) fn plates(resynthesis: &Resynthesis<'_>) -> Result<Option<[Plate; 2]>, Failure> {
    let mut scene = SceneFile::parse(&resynthesis.scene(), Path::new(SCENE))
        .and_then(|file| file.load(&LoadOptions::default(), &mut Vec::new()))?;
    scene.integrator.seed = 1;
    let samples = scene.integrator.samples_per_pixel;
    let view = View::new(scene.camera, scene.film, 1)?;
    let mut session = Session::new(PreparedScene::new(scene)?, view);
    if session.run(&Plan::samples(samples), &|_: &_| (), &interrupt::STOP)? != Outcome::Finished {
        return Ok(None);
    }
    let pictures = resynthesis.pictures(&session.film().layer(FilmLayer::Radiance));
    Ok(Some([
        plate(
            "region.png",
            "The region of the photograph",
            "The photograph.",
            &pictures,
            &pictures.photographed,
        )?,
        plate(
            "setup.png",
            "A rendering of the setup with the material that was measured",
            "The same setup with the measured material, rendered (setup.toml): without the camera's blur, and in even light.",
            &pictures,
            &pictures.rendered,
        )?,
    ]))
}

fn plate(
    file: &str,
    alternative: &str,
    caption: &str,
    pictures: &ResynthesizedPictures,
    pixels: &[[f32; 3]],
) -> Result<Plate, Failure> {
    let brightest = pictures.brightest as f32;
    // Darker than white by a stop, or noise would be clipped
    let display = |pixel: &[f32; 3]| {
        display_from_linear(ToneMapping::Srgb, pixel.map(|v| 0.5 * v.max(0.0) / brightest))
            .map(|v| (255.0 * v).round() as u8)
    };
    let codes: Vec<u8> = pixels.iter().flat_map(display).collect();
    let size = pictures.size;
    let png = CodedPicture::rgb(size, &codes).encode();
    let png = png.map_err(|error| Failure::work(format!("cannot draw a picture: {error}")))?;
    let [file, alternative, caption] = [file, alternative, caption].map(String::from);
    Ok(Plate { file, alternative, caption, size, png })
}
