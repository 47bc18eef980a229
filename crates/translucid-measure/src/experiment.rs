//! A photograph of light on a flat piece, on its way to the piece's material.
//!
//! ```text
//! exposures  merged into one photograph
//! region     cut out, its clipping checked, a spot found
//! dark       subtracted
//! white      divided by
//! edge       found
//! light      sampled across the edge, or around the spot
//! fit        of isotropic scatterers, and of models that are none
//! medium     the similar one with the mean cosine that was asked for
//! ```

use crate::alternative_model::AlternativeModel;
use crate::calibration::Calibration;
use crate::clipping::{check_clipping, check_core, note_equal_white, warn_of_cut_noise};
use crate::edge_fit::{fit_edge, fit_edge_of};
use crate::edge_line::EdgeLine;
use crate::error::MeasureError;
use crate::even_light::SlopeAlong;
use crate::fit::{Card, Fit, Outline, Scale, White};
use crate::limitations::{MISFIT, limitations, unlike};
use crate::linear_photo::{NamedPhoto, Photo};
use crate::measurement::Measurement;
use crate::options::{Options, Setup, refuse_together};
use crate::region::beside_white;
use crate::remark::{Remark, three_digits};
use crate::resolution::fit_finely;
use crate::samples::Samples;
use crate::similar_medium::SimilarMedium;
use crate::spot_fit::fit_spot;
use crate::spot_place::SpotPlace;
use crate::trace::{Trace, edge_line, spot_place};
use crate::unknown_albedo::widen_by_albedo;

/// Change of the light along the edge, over that in the middle, from which on it is said.
const UNEVEN_ALONG: f64 = 0.05;

/// Bend of the light along the edge, from its middle to its ends, from which on one across it makes lengths wrong.
const BENT_ALONG: f64 = 0.01;

/// Widths of what photographs show \[mm\], beyond which the scale is doubted.
const USUAL_WIDTHS: std::ops::RangeInclusive<f64> = 0.2..=2000.0;

/// Least pixels on a side of the part that is measured.
const LEAST_REGION: usize = 16;

/// Photographs of one view.
#[derive(Clone, Debug, PartialEq)]
pub struct Photographs {
    /// The piece.
    pub photo: NamedPhoto,
    /// Other exposures of the same view, merged with the first.
    pub exposures: Vec<NamedPhoto>,
    /// The same exposure with the light off, which is subtracted.
    pub dark: Option<NamedPhoto>,
    /// The same exposure and light with white paper in place of the piece.
    pub white: Option<NamedPhoto>,
}

/// Measures photographs of an edge of light or of a spot, given how they were taken.
///
/// ```
/// use translucid_measure::{Experiment, NamedPhoto, Options, Photo, Photographs};
///
/// # fn main() -> Result<(), translucid_measure::MeasureError> {
/// // Light that falls off over a millimeter to either side of a line, in pixels of 0.1 mm with some grain
/// let light = |x: usize, y: usize| {
///     let grain = 1e-3 * ((x * 7 + y * 13) % 11) as f32;
///     0.3 + 0.25 * ((x as f32 - 60.0) / 10.0).tanh() + grain
/// };
/// let photo = Photo::from_fn(120, 60, |x, y| [light(x, y); 3]);
/// let photographs = Photographs {
///     photo: NamedPhoto { name: String::from("soap"), photo },
///     exposures: Vec::new(),
///     dark: None,
///     white: None,
/// };
/// let options = Options { mm_per_pixel: Some(0.1), surface_albedo: vec![0.8], ..Options::default() };
/// let measurement = Experiment::new(options)?.measure(photographs, &mut |_| ())?;
/// assert!((0.1..10.0).contains(&measurement.fit.channels[0].mfp.value));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Experiment {
    options: Options,
    mm_per_pixel: f64,
    medium: SimilarMedium,
}

/// A photograph in the numbers that are fitted.
struct Calibrated {
    photo: NamedPhoto,
    region: [usize; 4],
    /// A spot in the region, and the radius of its core that is left out.
    spot: Option<(SpotPlace, f64)>,
    calibration: Calibration,
}

impl Experiment {
    /// The experiment of some options.
    ///
    /// # Errors
    /// A number is out of its range, options contradict each other, or the scale is missing.
    pub fn new(options: Options) -> Result<Self, MeasureError> {
        options.check()?;
        options.scale_without_white()?;
        options.white_reflectances()?;
        let medium = SimilarMedium::new(&options)?;
        let mm_per_pixel = options.pixel_width()?;
        Ok(Self { options, mm_per_pixel, medium })
    }

    /// Measures the material in photographs; what there is to remark goes to `say`.
    ///
    /// # Errors
    /// A photograph does not show what the options say, is clipped, or shows no scattering.
    pub fn measure(
        &self,
        photographs: Photographs,
        say: &mut dyn FnMut(Remark),
    ) -> Result<Measurement, MeasureError> {
        self.check(&photographs)?;
        let has_white = self.options.white.is_some() || photographs.white.is_some();
        let calibrated = self.calibrate(photographs, say)?;
        self.doubt_of_scale(calibrated.photo.photo.width).into_iter().for_each(&mut *say);
        let scale =
            if has_white { self.white_scale(&calibrated)? } else { self.options.scale_without_white()? };
        let (trace, samples, scale, mut fit) = self.fit(&calibrated, scale, say)?;
        let Calibrated { photo: NamedPhoto { name, photo }, region, .. } = calibrated;
        refuse_unseen(&fit, &samples, &name)?;
        say(describe_outline(&fit));
        let alternative = AlternativeModel::best(&fit, &samples, scale);
        if scale == Scale::Unknown {
            widen_by_albedo(&mut fit, &samples, &self.medium.response);
        }
        let mut limits = limitations(&fit, &samples, scale);
        limits.extend(alternative.warning(&fit, &samples));
        limits.iter().for_each(|limit| say(limit.clone()));
        self.medium.scale(&mut fit, scale)?;
        Ok(Measurement {
            options: self.options.clone(),
            mm_per_pixel: self.mm_per_pixel,
            photo,
            region,
            trace,
            samples,
            fit,
            scale,
            alternative,
            limits,
        })
    }

    /// A warning if the photograph shows what is too large or too small for a table with a lamp.
    fn doubt_of_scale(&self, pixels: usize) -> Option<Remark> {
        let width = self.mm_per_pixel * pixels as f64;
        let message = format!(
            "the photograph is {} mm wide, by {} mm a pixel: is the scale in millimeters?",
            three_digits(width),
            three_digits(self.mm_per_pixel)
        );
        (!USUAL_WIDTHS.contains(&width)).then_some(Remark::Warning(message))
    }

    /// Refuses photographs that do not go together, or with the options.
    fn check(&self, photographs: &Photographs) -> Result<(), MeasureError> {
        let Photographs { exposures, dark, white, .. } = photographs;
        let [has_exposures, has_dark, has_white] = [!exposures.is_empty(), dark.is_some(), white.is_some()];
        refuse_together(&[
            (has_exposures && has_dark, ["exposure", "dark"]),
            (has_white && has_exposures, ["white_photo", "exposure"]),
            (has_white && self.options.white.is_some(), ["white_photo", "white"]),
            (has_white && !self.options.surface_albedo.is_empty(), ["surface_albedo", "white_photo"]),
        ])
    }

    /// The part that is measured: the one that is stated, or all, without the white card.
    fn region(&self, photo: &NamedPhoto, say: &mut dyn FnMut(Remark)) -> Result<[usize; 4], MeasureError> {
        let Photo { width, height, .. } = photo.photo;
        let stated = self.options.region.unwrap_or([0, 0, width, height]);
        photo.part("region", stated)?;
        let Some(white) = self.options.white else { return Ok(stated) };
        photo.part("white", white)?;
        let shows_edge = |part: &Photo| match self.options.edge {
            None => EdgeLine::find(part).is_ok(),
            // The line is where it is: part of the piece must be on either side
            Some(_) => part.width >= LEAST_REGION && part.height >= LEAST_REGION,
        };
        let region = beside_white(&photo.photo, stated, white, shows_edge);
        if region != stated {
            let [x0, y0, x1, y1] = region;
            say(Remark::Finding(format!(
                "measured in {x0},{y0},{x1},{y1}, beside the white card (`region`)"
            )));
        }
        Ok(region)
    }

    /// Merges exposures, finds the spot, checks what is clipped, subtracts the dark, divides by white.
    fn calibrate(
        &self,
        photographs: Photographs,
        say: &mut dyn FnMut(Remark),
    ) -> Result<Calibrated, MeasureError> {
        let options = &self.options;
        let Photographs { photo, exposures, dark, white } = photographs;
        let mut photo = merged(photo, exposures)?;
        let region = self.region(&photo, say)?;
        let piece = photo.part("region", region)?;
        // A spot may be anywhere before it is known how much of its light is lost
        let spot = match options.setup {
            Setup::Spot => {
                let place = spot_place(&piece, corner(region), &photo.name, options, say)?;
                Some((place, check_core(&piece, &place, &photo.name, say)?))
            }
            Setup::Edge | Setup::Slab => {
                check_clipping(&piece, &photo.name, say)?;
                None
            }
        };
        if let Some(white) = options.white {
            check_clipping(&photo.part("white", white)?, &photo.name, say)?;
            note_equal_white(&photo, white, say);
        }
        if let Some(dark) = &dark {
            dark.require_size_of(&photo.photo)?;
            photo.photo.subtract(&dark.photo);
            warn_of_cut_noise(&dark.photo, &dark.name, &photo.photo, say);
        }
        let calibration = match &white {
            None => Calibration::by_card(&photo, options)?,
            Some(white) => {
                white.require_size_of(&photo.photo)?;
                let place = spot.map(|(place, _)| place.moved(corner(region)));
                let dark = dark.as_ref().map(|dark| &dark.photo);
                Calibration::by_photo(white, dark, place, options, say)?
            }
        };
        calibration.apply(&mut photo.photo);
        Ok(Calibrated { photo, region, spot, calibration })
    }

    /// The scale of reflectances by what is white, with its errors before the place of the edge is known.
    fn white_scale(&self, calibrated: &Calibrated) -> Result<Scale, MeasureError> {
        let tolerance = self.options.white_error();
        Ok(Scale::Reflectance(White {
            reflectance: self.options.white_reflectances()?,
            error: calibrated.calibration.errors().map(|error| tolerance.hypot(error)),
            place: None,
        }))
    }

    /// Light across the edge as even along it as light at the white card, and the scale with the card's place.
    fn evened(
        &self,
        line: &EdgeLine,
        region: [usize; 4],
        samples: &mut Samples,
        scale: Scale,
        say: &mut dyn FnMut(Remark),
    ) -> Scale {
        let [first, last] = samples.along;
        let slopes = samples.even_out_along();
        let most = slopes.iter().map(|along| along.slope.abs() * (last - first)).fold(0.0, f64::max);
        if most > UNEVEN_ALONG {
            say(Remark::Finding(format!(
                "the light changes by {:.0} % along the edge, which is taken out",
                100.0 * most
            )));
        }
        let bent = slopes.iter().map(|along| {
            // What an exponential has beside a straight line is in the intervals
            let square = 0.125 * (along.slope * (last - first)).powi(2);
            if along.bend.abs() > 2.0 * square { along.bend } else { 0.0 }
        });
        let bent = bent.fold(0.0, |most: f64, bend| if bend.abs() > most.abs() { bend } else { most });
        if bent.abs() > BENT_ALONG {
            let than = if bent < 0.0 { "darker" } else { "brighter" };
            say(Remark::Warning(format!(
                "the light is {:.1} % {than} at both ends of the edge than in the middle, as through a lens with dark corners: if it \
                 is bent across the edge, too, lengths are wrong beyond their intervals; `white_photo` takes it out",
                100.0 * bent.abs()
            )));
        }
        let (Scale::Reflectance(white), Some([x0, y0, x1, y1])) = (scale, self.options.white) else {
            return scale;
        };
        let [x, y] = [0.5 * (x0 + x1) as f64, 0.5 * (y0 + y1) as f64];
        let [left, top] = corner(region);
        let place = self.mm_per_pixel * line.distance_of(x - left, y - top);
        let along = self.mm_per_pixel * line.along(x - left, y - top) - 0.5 * (first + last);
        let light = slopes.map(|slope| (1.0 + slope.slope * along).max(0.1));
        samples
            .blocks
            .iter_mut()
            .flatten()
            .for_each(|v| v.iter_mut().zip(light).for_each(|(v, light)| *v *= light));
        let error = std::array::from_fn(|c| {
            let SlopeAlong { slope, error, .. } = slopes[c];
            // Of the slope, and of the square that an exponential has beside a straight line
            white.error[c].hypot(error * along / light[c]).hypot(0.5 * (slope * along).powi(2))
        });
        Scale::Reflectance(White { error, place: Some(place), ..white })
    }

    /// Fits the light across the edge, or around the spot.
    fn fit(
        &self,
        calibrated: &Calibrated,
        scale: Scale,
        say: &mut dyn FnMut(Remark),
    ) -> Result<(Trace, Samples, Scale, Fit), MeasureError> {
        let Calibrated { photo, region, spot, .. } = calibrated;
        let piece = photo.part("region", *region)?;
        if let Some((place, core)) = *spot {
            let samples = place.samples(&piece, self.mm_per_pixel, core);
            let fit = fit_spot(&samples, &self.medium.response, scale).ok_or_else(|| {
                let message = "nothing gets brighter toward the center of the spot, or there are fewer than 16 rings around it";
                MeasureError::of_photo(&photo.name, message)
                    .with_help("show more of the piece around the spot, or set `center`")
            })?;
            return Ok((Trace::Spot(place), samples, scale, fit));
        }
        let line = edge_line(&piece, corner(*region), &photo.name, &self.options, say)?;
        let mut samples = line.samples(&piece, self.mm_per_pixel);
        let scale = self.evened(&line, *region, &mut samples, scale, say);
        let (samples, fit) =
            fit_finely(samples, |samples| self.edge_fit(samples, scale), say).ok_or_else(|| {
                let message =
                    "nothing gets brighter across the edge, or it has fewer than 16 pixels on a side";
                MeasureError::of_photo(&photo.name, message)
            })?;
        Ok((Trace::Line(line), samples, scale, fit))
    }

    fn edge_fit(&self, samples: &Samples, scale: Scale) -> Option<Fit> {
        let response = &self.medium.response;
        match self.options.card {
            // The camera sees the slab on both sides
            None if self.options.setup == Setup::Slab => fit_edge_of(Card::Hidden, samples, response, scale),
            None => fit_edge(samples, response, scale),
            Some(card) => fit_edge_of(card, samples, response, scale),
        }
    }
}

/// The photograph, merged with its other exposures.
fn merged(photo: NamedPhoto, exposures: Vec<NamedPhoto>) -> Result<NamedPhoto, MeasureError> {
    if exposures.is_empty() {
        return Ok(photo);
    }
    let NamedPhoto { name, photo } = photo;
    let all: Vec<Photo> =
        std::iter::once(photo).chain(exposures.into_iter().map(|other| other.photo)).collect();
    let photo = Photo::merged(&all).ok_or_else(|| {
        MeasureError::new(
            "`exposure`: the photographs have other sizes or nothing in common that none of them clips",
        )
    })?;
    Ok(NamedPhoto { name, photo })
}

/// Upper left corner of a region.
fn corner([left, top, ..]: [usize; 4]) -> [f64; 2] {
    [left as f64, top as f64]
}

/// Refuses a photograph in which no channel scatters.
fn refuse_unseen(fit: &Fit, samples: &Samples, name: &str) -> Result<(), MeasureError> {
    if fit.channels.iter().any(|channel| channel.is_seen) {
        return Ok(());
    }
    // A camera in focus does not blur so much either
    if fit.misfit > MISFIT && fit.blur > 3.0 * samples.pixel_width {
        return Err(MeasureError::of_photo(name, unlike(fit)));
    }
    let message = format!(
        "no scattering is seen: the {} is as sharp as a blur of {} mm makes it",
        fit.outline.name(),
        three_digits(fit.blur)
    );
    Err(MeasureError::of_photo(name, message)
        .with_help("come closer, so that light creeps over several pixels"))
}

/// The shape that the light was taken for.
fn describe_outline(fit: &Fit) -> Remark {
    Remark::Finding(match fit.outline {
        Outline::Edge { card: Card::Hidden, .. } => String::from(
            "the dark side shows light that creeps into a shadow (`card` hidden): stray light is measured there",
        ),
        Outline::Edge { card: Card::Visible, .. } => String::from(
            "the dark side shows the card: the lit side is measured (`card` visible), and intervals hold that the \
                 card's light may be stray light",
        ),
        Outline::Spot { radius } => format!(
            "a spot of {} mm radius, its edge as soft as {} mm",
            three_digits(radius),
            three_digits(fit.blur)
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_of_what_no_table_holds_are_doubted() {
        let doubt = |mm: f64| {
            let options = Options { mm_per_pixel: Some(mm), surface_albedo: vec![0.8], ..Options::default() };
            Experiment::new(options).unwrap().doubt_of_scale(240)
        };
        assert_eq!(doubt(0.125), None);
        let message =
            "the photograph is 30000 mm wide, by 125 mm a pixel: is the scale in millimeters?".to_owned();
        assert_eq!(doubt(125.0), Some(Remark::Warning(message)));
        assert!(doubt(0.000_125).is_some());
    }
}
