//! Views of a film on the page, as the codes of a display.

use rayon::prelude::*;
use translucid_image::{
    Denoised, DisplayTransform, Picture, PictureChannel, ToneMapping, display_from_linear,
};
use translucid_laboratory::picture::{
    self as laboratory, FlipMap, PicturePixel, difference_color, flip_color,
};
use translucid_render::{FilmLayer, FilmSums, ImageInfo, TileSums, layer};
use translucid_scene::Film;

use crate::smooth::{Mean, SmoothLight};

/// About so many pixels tell the noise of a film.
const PIXELS_FOR_NOISE: f64 = 65536.0;

/// A way of looking at films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shown {
    Layer(FilmLayer),
    /// The relative difference of luminance of two films, with its sign.
    Difference,
    /// ꟻLIP of two films.
    Flip,
}

impl Shown {
    pub(crate) const ALL: [Self; 10] = [
        Self::Layer(FilmLayer::Radiance),
        Self::Layer(FilmLayer::Diffuse),
        Self::Layer(FilmLayer::Specular),
        Self::Layer(FilmLayer::Subsurface),
        Self::Layer(FilmLayer::Emission),
        Self::Layer(FilmLayer::Albedo),
        Self::Layer(FilmLayer::Normal),
        Self::Layer(FilmLayer::Depth),
        Self::Difference,
        Self::Flip,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Layer(layer) => layer.name(),
            Self::Difference => "difference",
            Self::Flip => "flip",
        }
    }

    pub(crate) fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shown| shown.name() == name)
    }

    /// Whether it is about two films.
    pub(crate) fn compares(self) -> bool {
        matches!(self, Self::Difference | Self::Flip)
    }
}

/// All light of a film, as it is shown.
pub(crate) enum Light {
    AsRendered,
    Denoised(Denoised),
    Smoothed(SmoothLight),
}

/// RGBA codes of a layer, row by row from the top: of all light as it was rendered, or denoised, those of the command's PNG.
pub(crate) fn layer_codes(film: &FilmSums, shown: FilmLayer, settings: &Film, all: Light) -> Vec<u8> {
    let display = DisplayTransform { exposure: settings.exposure, tone_mapping: settings.tone_mapping };
    let plain = DisplayTransform { exposure: 0.0, tone_mapping: ToneMapping::Srgb };
    let (denoised, smoothed) = match all {
        Light::AsRendered => (None, None),
        Light::Denoised(denoised) => (Some(denoised), None),
        Light::Smoothed(light) => (None, Some(light)),
    };
    let info = ImageInfo { denoised, ..ImageInfo::default() };
    let light = |range: std::ops::Range<usize>| {
        picture(film, move |_, mean| [mean[range.start], mean[range.start + 1], mean[range.start + 2]])
    };
    let (picture, display) = match shown {
        FilmLayer::Radiance | FilmLayer::Alpha => match smoothed {
            Some(light) => (picture(film, move |at, mean| light.radiance(at, mean)), display),
            None => (film.display_picture(&info), display),
        },
        FilmLayer::Diffuse => (light(layer::DIFFUSE), display),
        FilmLayer::Specular => (light(layer::SPECULAR), display),
        FilmLayer::Subsurface => (light(layer::SUBSURFACE), display),
        FilmLayer::Emission => (light(layer::EMISSION), display),
        FilmLayer::Albedo => (light(layer::ALBEDO), plain),
        FilmLayer::Normal => (picture(film, normal_color), plain),
        FilmLayer::Depth => {
            let (near, far) = depths(film);
            let shade = move |_, mean: &Mean| {
                let depth = mean[layer::DEPTH] / mean[layer::SURFACE].max(f64::MIN_POSITIVE);
                let share = 1.0 - 0.9 * (depth - near) / (far - near).max(f64::MIN_POSITIVE);
                [decoded(share) * mean[layer::SURFACE].min(1.0); 3]
            };
            (picture(film, shade), plain)
        }
    };
    // A film has pixels, and the picture the channels that codes are made of
    picture.display_codes(display).unwrap_or_default()
}

/// A picture of a color that a pixel has by its place and mean values, with its coverage.
fn picture<'a>(film: &'a FilmSums, color: impl Fn([u32; 2], &Mean) -> [f64; 3] + Sync + 'a) -> Picture<'a> {
    let channels = ["R", "G", "B", "A"].map(PictureChannel::single).to_vec();
    Picture::new([film.width, film.height], channels, move |y, row: &mut [f64]| {
        for (x, pixel) in (0..).zip(row.chunks_exact_mut(4)) {
            let mean = film.mean(x, y);
            pixel[..3].copy_from_slice(&color([x, y], &mean));
            pixel[3] = mean[layer::ALPHA];
        }
    })
}

/// A normal's components from −1 … 1 as codes from black to white, where there is one.
fn normal_color(_: [u32; 2], mean: &Mean) -> [f64; 3] {
    let normal = [0, 1, 2].map(|c| mean[layer::NORMAL.start + c]);
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length == 0.0 {
        return [0.0; 3];
    }
    normal.map(|x| decoded(0.5 + 0.5 * x / length) * mean[layer::ALPHA])
}

/// The linear value that the sRGB curve encodes as this [IEC 61966-2-1].
fn decoded(code: f64) -> f64 {
    if code <= 0.04045 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// Least and greatest mean distance of the pixels that are covered.
fn depths(film: &FilmSums) -> (f64, f64) {
    let pixels = film.tiles.iter().flat_map(TileSums::pixels);
    let depths = pixels.filter(|sums| sums[layer::SURFACE] > 0.0);
    depths
        .map(|sums| sums[layer::DEPTH] / sums[layer::SURFACE])
        .fold((f64::MAX, 0.0), |(near, far), depth| (depth.min(near), depth.max(far)))
}

/// A film for comparisons; its background is black.
pub fn comparable(film: &FilmSums, settings: &Film) -> laboratory::Picture {
    let exposure = settings.exposure.exp2();
    let rows: Vec<Vec<PicturePixel>> = (0..film.height)
        .into_par_iter()
        .map(|y| {
            let pixel = |x| {
                let radiance = film.radiance(x, y).map(|value| value as f32);
                PicturePixel {
                    radiance,
                    alpha: film.mean(x, y)[layer::ALPHA] as f32,
                    display: display_from_linear(settings.tone_mapping, radiance.map(|x| x * exposure)),
                }
            };
            (0..film.width).map(pixel).collect()
        })
        .collect();
    laboratory::Picture::new(film.width as usize, film.height as usize, rows.into_iter().flatten())
}

/// Some pixels of a film, enough for an estimate of its noise, without what a display shows of them.
pub(crate) fn thinned(film: &FilmSums) -> laboratory::Picture {
    let pixels = u64::from(film.width) * u64::from(film.height);
    let step = ((pixels as f64 / PIXELS_FOR_NOISE).sqrt().ceil() as usize).max(1);
    let places = |edge: u32| (0..edge).step_by(step);
    let pixel = |x, y| PicturePixel {
        radiance: film.radiance(x, y).map(|value| value as f32),
        alpha: film.mean(x, y)[layer::ALPHA] as f32,
        display: [0.0; 3],
    };
    let pixels = places(film.height).flat_map(|y| places(film.width).map(move |x| pixel(x, y)));
    laboratory::Picture::new(places(film.width).len(), places(film.height).len(), pixels)
}

/// A map of the comparison of A with B as RGBA codes, and the mean of ꟻLIP where it is that.
pub(crate) fn comparison_codes(
    shown: Shown,
    [a, b]: [&laboratory::Picture; 2],
) -> Option<(Vec<u8>, Option<f64>)> {
    let codes = |values: &[f32], color: fn(f32) -> [f32; 3]| {
        let code = |&value: &f32| {
            let [red, green, blue] = color(value).map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
            [red, green, blue, 255]
        };
        values.par_iter().map(code).collect::<Vec<_>>().into_flattened()
    };
    if shown == Shown::Flip {
        let map = FlipMap::new(a, b).ok()?;
        return Some((codes(map.values(), flip_color), Some(map.mean())));
    }
    Some((codes(&laboratory::relative_difference(a, b), difference_color), None))
}

#[cfg(test)]
mod tests {
    use translucid_render::SampleRanges;

    use super::*;

    /// A film with one sample, whose left half is a surface before the camera at a distance of 2, then 4.
    fn film() -> FilmSums {
        let mut film = FilmSums::new(4, 2);
        film.tiles[0].taken = SampleRanges::from(0..1);
        for (index, sums) in film.tiles[0].pixels_mut().iter_mut().enumerate() {
            if index % 4 < 2 {
                sums[layer::SUBSURFACE].copy_from_slice(&[0.5, 0.25, 0.125]);
                sums[layer::NORMAL].copy_from_slice(&[0.0, 0.0, 1.0]);
                sums[layer::ALPHA] = 1.0;
                sums[layer::SURFACE] = 1.0;
                sums[layer::DEPTH] = 2.0 + 2.0 * (index % 4) as f64;
            }
        }
        film
    }

    #[test]
    fn layers_are_shown_where_something_is() {
        let (film, settings) = (film(), Film::default());
        for shown in Shown::ALL {
            assert_eq!(Shown::from_name(shown.name()), Some(shown));
            let Shown::Layer(layer) = shown else { continue };
            let codes = layer_codes(&film, layer, &settings, Light::AsRendered);
            assert_eq!(codes.len(), 32);
            assert_eq!(codes[8..16], [0; 8], "{shown:?}");
        }
        let light = layer_codes(&film, FilmLayer::Radiance, &settings, Light::AsRendered);
        assert_eq!(light, layer_codes(&film, FilmLayer::Subsurface, &settings, Light::AsRendered));
        assert!(light[0] > light[1] && light[1] > light[2] && light[3] == 255);
        let normal = layer_codes(&film, FilmLayer::Normal, &settings, Light::AsRendered);
        assert!(normal[0].abs_diff(128) <= 1 && normal[2] == 255, "{normal:?}");
        let depth = layer_codes(&film, FilmLayer::Depth, &settings, Light::AsRendered);
        assert!(depth[0] == 255 && depth[4].abs_diff(26) <= 1, "{depth:?}");
    }

    #[test]
    fn thinned_picture_has_pixels_of_the_film_in_their_order() {
        let mut large = FilmSums::new(600, 400);
        for tile in &mut large.tiles {
            tile.taken = SampleRanges::from(0..1);
        }
        assert_eq!([thinned(&large).width(), thinned(&large).height()], [300, 200]);
        let all = comparable(&film(), &Film::default());
        assert_eq!(thinned(&film()).radiance(), all.radiance());
    }

    #[test]
    fn comparison_of_a_film_with_itself_shows_nothing() {
        let picture = comparable(&film(), &Film::default());
        let (codes, mean) = comparison_codes(Shown::Flip, [&picture, &picture]).unwrap();
        assert_eq!((mean, codes.len()), (Some(0.0), 32));
        let (codes, _) = comparison_codes(Shown::Difference, [&picture, &picture]).unwrap();
        assert!(codes.chunks(4).all(|pixel| pixel == &codes[..4]));
    }
}
