//! Where a spot of light is in a photograph, and the light around it.

use std::f64::consts::{PI, TAU};

use crate::linear_photo::Photo;
use crate::samples::Samples;

/// The middle of a spot in pixels: x to the right, y down, (0.5, 0.5) the middle of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotPlace {
    /// The middle.
    pub center: [f64; 2],
    /// Radius within which light is half as bright as in the middle, or more.
    pub half: f64,
}

/// Why no spot was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoSpot {
    /// Fewer than 16 pixels in a direction.
    TooSmall,
    /// The brightest pixels over the darkest tenth: less than 1.5.
    NoContrast(f64),
    /// Number of pixels that are half as bright as the brightest: fewer than 12.
    FewPixels(usize),
    /// Number of spots of similar size.
    Several(usize),
    /// It goes on beyond the picture.
    OutOfFrame,
    /// Bright pixels lie farther apart than in a disk: so many times their mean square distance.
    NotRound(f64),
}

/// Sectors around a spot.
const SECTORS: usize = 12;

/// Least contrast of a spot.
const LEAST_CONTRAST: f64 = 1.5;

/// Part of the largest spot's pixels from which on another one counts.
const SIMILAR: f64 = 0.15;

/// Fewest pixels of a spot; smoothing makes nine of one.
const FEWEST: usize = 12;

/// Mean square distance over that of a disk up to which a spot is round.
const ROUND: f64 = 1.4;

/// Most rings, and how far they reach in half-light radii.
const RINGS: f64 = 160.0;
const REACH: f64 = 30.0;

impl SpotPlace {
    /// The one bright spot of a photograph.
    ///
    /// # Errors
    /// There is none, more than one, or one that is not round or not wholly in the picture.
    pub fn find(photo: &Photo) -> Result<Self, NoSpot> {
        let [width, height] = [photo.width, photo.height];
        if width < 16 || height < 16 {
            return Err(NoSpot::TooSmall);
        }
        let light = smoothed(photo);
        let mut sorted = light.clone();
        sorted.sort_by(f64::total_cmp);
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let dark = mean(&sorted[..sorted.len() / 10]);
        let bright = mean(&sorted[sorted.len() - (sorted.len() / 1000).max(4)..]);
        let contrast = bright / dark.max(1e-6 * bright);
        if !contrast.is_finite() || contrast < LEAST_CONTRAST {
            return Err(NoSpot::NoContrast(if contrast.is_finite() { contrast } else { 1.0 }));
        }
        let above = |part: f64| components(&light, width, dark + part * (bright - dark));
        // A weaker second spot is one, too
        for part in [0.5, 0.25] {
            let all = above(part);
            let most = all.iter().map(Vec::len).max().unwrap_or(0) as f64;
            let similar = all.iter().filter(|spot| spot.len() as f64 > SIMILAR * most).count();
            if similar > 1 {
                return Err(NoSpot::Several(similar));
            }
        }
        let spot = above(0.5).into_iter().max_by_key(Vec::len).unwrap_or_default();
        if spot.len() < FEWEST {
            return Err(NoSpot::FewPixels(spot.len()));
        }
        let of = |i: &usize| [i % width, i / width];
        if spot.iter().map(of).any(|[x, y]| x == 0 || y == 0 || x + 1 == width || y + 1 == height) {
            return Err(NoSpot::OutOfFrame);
        }
        let count = spot.len() as f64;
        let sum = spot.iter().map(of).fold([0.0; 2], |[sx, sy], [x, y]| [sx + x as f64, sy + y as f64]);
        let center = sum.map(|v| v / count + 0.5);
        let square =
            |[x, y]: [usize; 2]| (x as f64 + 0.5 - center[0]).powi(2) + (y as f64 + 0.5 - center[1]).powi(2);
        let spread = spot.iter().map(of).map(square).sum::<f64>() / count / (count / TAU);
        if spread > ROUND {
            return Err(NoSpot::NotRound(spread));
        }
        Ok(Self { center, half: (count / PI).sqrt() })
    }

    /// A spot around a given middle; `None` where that is not in the picture.
    pub fn around(photo: &Photo, center: [f64; 2]) -> Option<Self> {
        let inside =
            (0.0..photo.width as f64).contains(&center[0]) && (0.0..photo.height as f64).contains(&center[1]);
        let light = smoothed(photo);
        let bright = light.get(center[1] as usize * photo.width + center[0] as usize).copied();
        let dark = light.iter().copied().fold(f64::MAX, f64::min);
        let half = |bright: f64| {
            let count = light.iter().filter(|v| **v > 0.5 * (bright + dark)).count();
            (count.max(1) as f64 / PI).sqrt()
        };
        bright.filter(|_| inside).map(|bright| Self { center, half: half(bright) })
    }

    /// The same spot where the photograph goes on so far to the left and to the top.
    #[must_use]
    pub fn moved(self, [left, top]: [f64; 2]) -> Self {
        Self { center: [self.center[0] + left, self.center[1] + top], ..self }
    }

    /// Distance of a pixel's middle from that of the spot, in pixels.
    pub fn distance(&self, x: usize, y: usize) -> f64 {
        (x as f64 + 0.5 - self.center[0]).hypot(y as f64 + 0.5 - self.center[1])
    }

    /// Distance of the farthest pixel with a value of 1 or more, where light is lost, and half of its width; 0 where there is none.
    pub fn core(&self, photo: &Photo) -> f64 {
        let greatest = [0, 1, 2].map(|c| photo.pile_up(c).map_or(1.0, |pile| pile.from.min(1.0)));
        let is_lost = |i: &usize| photo.pixels[*i].iter().zip(greatest).any(|(value, most)| *value >= most);
        let farthest = (0..photo.pixels.len()).filter(is_lost);
        farthest.map(|i| self.distance(i % photo.width, i / photo.width) + 1.0).fold(0.0, f64::max)
    }

    /// Light by the distance from the middle, in rings that are wholly in the picture and beyond a core \[pixels\].
    pub fn samples(&self, photo: &Photo, pixel_width: f64, core: f64) -> Samples {
        let [x, y] = self.center;
        let reach = x.min(y).min(photo.width as f64 - x).min(photo.height as f64 - y).min(REACH * self.half);
        let ring = (reach / RINGS).max(1.0);
        let rings = (reach / ring) as usize;
        let mut sums = vec![([0.0; 3], 0.0, 0.0); SECTORS * rings];
        for i in 0..photo.pixels.len() {
            let (x, y) = (i % photo.width, i / photo.width);
            let distance = self.distance(x, y);
            let place = (distance / ring) as usize;
            if distance < core || place >= rings {
                continue;
            }
            let angle = (y as f64 + 0.5 - self.center[1]).atan2(x as f64 + 0.5 - self.center[0]);
            let sector = ((angle / TAU + 0.5) * SECTORS as f64) as usize;
            let (sum, distances, count) = &mut sums[sector.min(SECTORS - 1) * rings + place];
            for (sum, value) in sum.iter_mut().zip(photo.at(x, y)) {
                *sum += f64::from(value);
            }
            *distances += distance;
            *count += 1.0;
        }
        let of = |sector: usize, place: usize| sums[sector * rings + place];
        let seen: Vec<usize> = (0..rings).filter(|i| (0..SECTORS).all(|s| of(s, *i).2 > 0.0)).collect();
        let place = |i: &usize| {
            let add = |(a, n): (f64, f64), s: usize| (a + of(s, *i).1, n + of(s, *i).2);
            let (distances, count) = (0..SECTORS).fold((0.0, 0.0), add);
            distances / count * pixel_width
        };
        let mean = |s: usize, i: &usize| of(s, *i).0.map(|v| v / of(s, *i).2);
        Samples {
            places: seen.iter().map(place).collect(),
            pixel_width: ring * pixel_width,
            blocks: (0..SECTORS).map(|s| seen.iter().map(|i| mean(s, i)).collect()).collect(),
            along: [0.0; 2],
        }
    }

    /// Power of a spot on a white surface \[value × pixels\], and its standard error: what is brighter than the rim of the
    /// greatest disk in the picture.
    pub fn power(&self, photo: &Photo) -> [(f64, f64); 3] {
        let [x, y] = self.center;
        let reach = x.min(y).min(photo.width as f64 - x).min(photo.height as f64 - y);
        let inner = reach.min((0.8 * reach).max(1.0));
        let (mut inside, mut rim) = (Vec::new(), Vec::new());
        for i in 0..photo.pixels.len() {
            let distance = self.distance(i % photo.width, i / photo.width);
            if distance < inner {
                inside.push(photo.pixels[i]);
            } else if distance < reach {
                rim.push(photo.pixels[i]);
            }
        }
        let [count, of_rim] = [inside.len() as f64, rim.len().max(2) as f64];
        std::array::from_fn(|c| {
            let value = |pixel: &[f32; 3]| f64::from(pixel[c]);
            let stray = rim.iter().map(value).sum::<f64>() / of_rim;
            let variance = rim.iter().map(|p| (value(p) - stray).powi(2)).sum::<f64>() / (of_rim - 1.0);
            let power = inside.iter().map(value).sum::<f64>() - count * stray;
            (power, (variance * count * (1.0 + count / of_rim)).sqrt())
        })
    }
}

/// Means over the channels and 3×3 pixels.
fn smoothed(photo: &Photo) -> Vec<f64> {
    let [width, height] = [photo.width, photo.height];
    let at = |i: usize| {
        let (x, y) = (i % width, i / width);
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        let (mut sum, mut count) = (0.0, 0.0);
        for y in rows {
            for x in x.saturating_sub(1)..(x + 2).min(width) {
                (sum, count) = (sum + photo.gray(x, y), count + 1.0);
            }
        }
        sum / count
    };
    (0..width * height).map(at).collect()
}

/// Pixels above a level that hang together.
fn components(light: &[f64], width: usize, level: f64) -> Vec<Vec<usize>> {
    let mut is_free: Vec<bool> = light.iter().map(|v| *v > level).collect();
    let mut all = Vec::new();
    for start in 0..light.len() {
        if !is_free[start] {
            continue;
        }
        is_free[start] = false;
        let mut spot = vec![start];
        let mut next = 0;
        while let Some(&i) = spot.get(next) {
            next += 1;
            let x = i % width;
            let beside = [(x > 0, i.wrapping_sub(1)), (x + 1 < width, i + 1)];
            let above = [(i >= width, i.wrapping_sub(width)), (i + width < light.len(), i + width)];
            for (_, j) in beside.into_iter().chain(above).filter(|(is_inside, _)| *is_inside) {
                if is_free[j] {
                    is_free[j] = false;
                    spot.push(j);
                }
            }
        }
        all.push(spot);
    }
    all
}

#[cfg(test)]
mod tests {
    use translucid_testing::SplitMix;

    use super::*;

    /// Round spots of a middle, a radius and a height, with tails, on stray light and noise.
    fn photo(spots: &[([f64; 2], f64, f64)], noise: f64) -> Photo {
        let mut random = SplitMix(9);
        let noise: Vec<f64> = (0..80 * 60).map(|_| noise * (random.uniform() - 0.5)).collect();
        Photo::from_fn(80, 60, |x, y| {
            let light = |([cx, cy], radius, height): &([f64; 2], f64, f64)| {
                let distance = (x as f64 + 0.5 - cx).hypot(y as f64 + 0.5 - cy);
                height * libm::exp(-(distance / radius).powi(2))
            };
            [(0.05 + spots.iter().map(light).sum::<f64>() + noise[80 * y + x]) as f32; 3]
        })
    }

    #[test]
    fn middle_is_found() {
        for center in [[40.3, 28.7], [25.1, 33.9], [52.0, 20.5]] {
            let place = SpotPlace::find(&photo(&[(center, 7.0, 0.8)], 0.1)).unwrap();
            let off = (place.center[0] - center[0]).hypot(place.center[1] - center[1]);
            assert!(off < 0.3, "{place:?} {center:?}");
            // e^{−r²/49} is ½ at 7 √ln 2
            assert!((place.half - 5.83).abs() < 0.5, "{place:?}");
            // The brightest pixel cut off
            let given = SpotPlace::around(&photo(&[(center, 7.0, 0.8)], 0.0), center).unwrap();
            assert!((given.half - 5.83).abs() < 0.5, "{given:?}");
        }
        assert_eq!(SpotPlace::around(&photo(&[], 0.0), [90.0, 5.0]), None);
        assert_eq!(SpotPlace::around(&photo(&[], 0.0), [f64::NAN, 5.0]), None);
    }

    #[test]
    fn samples_are_those_of_the_spot() {
        let center = [38.2, 31.4];
        let photo = photo(&[(center, 7.0, 0.8)], 0.0);
        let place = SpotPlace { center, half: 5.8 };
        assert_eq!(place.core(&photo), 0.0);
        let samples = place.samples(&photo, 0.5, 4.0);
        assert!(samples.blocks.len() == SECTORS && samples.places.is_sorted());
        assert!(samples.places[0] >= 2.0 && samples.places.len() > 20, "{:?}", samples.places);
        for (r, mean) in samples.places.iter().zip(samples.means()) {
            let expected = 0.05 + 0.8 * libm::exp(-(r / 3.5).powi(2));
            assert!((mean[1] - expected).abs() < 0.01, "{r}: {} {expected}", mean[1]);
        }
        // ∫ 0.8 e^{−r²/49} 2πr dr
        let [(power, error), ..] = place.power(&photo);
        assert!((power / (0.8 * 49.0 * PI) - 1.0).abs() < 0.01 && error < 0.02 * power, "{power} {error}");
    }

    #[test]
    fn clipped_core_is_as_wide_as_what_is_lost() {
        let center = [40.0, 30.0];
        let whole = photo(&[(center, 7.0, 2.0)], 0.0);
        let clipped = Photo::from_fn(80, 60, |x, y| whole.at(x, y).map(|v| v.min(1.0)));
        let core = SpotPlace { center, half: 7.0 }.core(&clipped);
        // 0.05 + 2 e^{−r²/49} is 1 at r = 6.04
        assert!((5.5..7.6).contains(&core), "{core}");
    }

    #[test]
    fn what_is_no_spot_is_refused() {
        let spot = |x: f64, y: f64, height: f64| ([x, y], 5.0, height);
        assert!(matches!(SpotPlace::find(&photo(&[], 0.0)), Err(NoSpot::NoContrast(_))));
        assert_eq!(SpotPlace::find(&Photo::from_fn(9, 60, |_, _| [0.5; 3])), Err(NoSpot::TooSmall));
        let two = photo(&[spot(25.0, 30.0, 0.8), spot(55.0, 30.0, 0.6)], 0.02);
        assert_eq!(SpotPlace::find(&two), Err(NoSpot::Several(2)));
        let weak = photo(&[spot(25.0, 30.0, 0.8), spot(55.0, 30.0, 0.35)], 0.02);
        assert_eq!(SpotPlace::find(&weak), Err(NoSpot::Several(2)));
        assert_eq!(SpotPlace::find(&photo(&[spot(2.0, 30.0, 0.8)], 0.0)), Err(NoSpot::OutOfFrame));
        assert!(SpotPlace::find(&photo(&[], 0.2)).is_err());
        let oval = Photo::from_fn(80, 60, |x, y| {
            let distance = (x as f32 / 25.0 - 1.6).hypot(y as f32 / 8.0 - 3.75);
            [if distance < 1.0 { 0.8 } else { 0.05 }; 3]
        });
        assert!(matches!(SpotPlace::find(&oval), Err(NoSpot::NotRound(_))));
        let point = Photo::from_fn(80, 60, |x, y| [if x == 40 && y == 30 { 1.0 } else { 0.05 }; 3]);
        assert!(SpotPlace::find(&point).is_err());
        assert!(SpotPlace::find(&Photo::from_fn(40, 40, |_, _| [f32::NAN; 3])).is_err());
    }
}
