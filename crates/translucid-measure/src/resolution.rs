//! How finely, and how far from the edge, light is fitted: a photograph of many pixels has more than its light needs.

use crate::fit::{ChannelFit, Fit, Outline};
use crate::remark::{Remark, three_digits};
use crate::samples::Samples;

/// Most places that are fitted at once: a fit's time grows with their square.
const MOST_PLACES: usize = 224;

/// Steps of a mean free path from which on finer ones show no more.
const FINE: f64 = 3.0;

/// Mean free paths around the edge within which its light changes.
const REACH: f64 = 30.0;

/// Fits samples in steps that are fine beside the shortest mean free path: those of all, and where these are too coarse,
/// those of a part around the edge. Returns the samples that were fitted, too.
pub(crate) fn fit_finely(
    samples: Samples,
    fit: impl Fn(&Samples) -> Option<Fit>,
    say: &mut dyn FnMut(Remark),
) -> Option<(Samples, Fit)> {
    let (pixel, all) = (samples.pixel_width, samples.places.len());
    let mut around = samples;
    loop {
        let coarse = around.coarse(MOST_PLACES);
        let found = fit(&coarse)?;
        if let Some(near) = nearer(&around, &coarse, &found, pixel) {
            around = near;
            continue;
        }
        if around.places.len() < all {
            let extent = three_digits(around.places.len() as f64 * pixel);
            say(Remark::Finding(format!("measured in the {extent} mm around the edge")));
        }
        if coarse.pixel_width > pixel {
            let (pixels, width) = ((coarse.pixel_width / pixel).round(), three_digits(coarse.pixel_width));
            say(Remark::Finding(format!("measured in steps of {pixels} pixels, {width} mm")));
        }
        return Some((coarse, found));
    }
}

/// The samples around the edge, where those of all are too coarse for the fit and these are clearly fewer.
fn nearer(all: &Samples, coarse: &Samples, found: &Fit, pixel: f64) -> Option<Samples> {
    let mfp = |channel: &ChannelFit| if channel.is_seen { channel.mfp.value } else { 0.0 };
    let mfps = found.channels.each_ref().map(mfp);
    let [shortest, longest] =
        [mfps.iter().copied().fold(f64::MAX, f64::min), mfps.iter().copied().fold(0.0, f64::max)];
    if coarse.pixel_width <= pixel || shortest >= FINE * coarse.pixel_width {
        return None;
    }
    let middle = match found.outline {
        Outline::Edge { position, .. } => position,
        Outline::Spot { .. } => 0.0,
    };
    let near = all.within(middle, REACH * longest.max(2.0 * coarse.pixel_width));
    (near.places.len() < all.places.len() * 4 / 5).then_some(near)
}

impl Samples {
    /// Means over as many neighboring places as leave no more than `most`; a rest at the far end is left out.
    pub fn coarse(&self, most: usize) -> Self {
        let together = self.places.len().div_ceil(most.max(1)).max(1);
        let groups: Vec<_> = (0..self.places.len() / together)
            .map(|group| group * together..(group + 1) * together)
            // Where places are missing, a mean is none of one wide pixel
            .filter(|group| {
                let width = self.places[group.end - 1] - self.places[group.start];
                width < together as f64 * self.pixel_width
            })
            .collect();
        let count = together as f64;
        let mean = |block: &Vec<[f64; 3]>| {
            let of = |group: &std::ops::Range<usize>| {
                std::array::from_fn(|c| block[group.clone()].iter().map(|v| v[c]).sum::<f64>() / count)
            };
            groups.iter().map(of).collect()
        };
        Self {
            places: groups.iter().map(|g| self.places[g.clone()].iter().sum::<f64>() / count).collect(),
            pixel_width: count * self.pixel_width,
            blocks: self.blocks.iter().map(mean).collect(),
            along: self.along,
        }
    }

    /// The samples no farther than `reach` from a place.
    pub fn within(&self, middle: f64, reach: f64) -> Self {
        let first = self.places.partition_point(|x| *x < middle - reach);
        let end = self.places.partition_point(|x| *x <= middle + reach);
        Self {
            places: self.places[first..end].to_vec(),
            pixel_width: self.pixel_width,
            blocks: self.blocks.iter().map(|block| block[first..end].to_vec()).collect(),
            along: self.along,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that are their place, in two blocks, with the places from 40 to 44 missing.
    fn samples() -> Samples {
        let places: Vec<f64> = (0..103).filter(|i| !(40..45).contains(i)).map(f64::from).collect();
        let block = |offset: f64| places.iter().map(|x| [x + offset, 2.0 * x, 1.0]).collect();
        Samples { blocks: vec![block(0.0), block(1.0)], pixel_width: 1.0, places, along: [0.0; 2] }
    }

    #[test]
    fn coarse_samples_are_means_of_whole_pixels() {
        let coarse = samples().coarse(20);
        assert_eq!(coarse.pixel_width, 5.0);
        assert_eq!(&coarse.places[..2], &[2.0, 7.0]);
        // 98 places: 19 groups of 5, none of which spans the gap
        assert_eq!(coarse.places.len(), 19);
        for (i, x) in coarse.places.iter().enumerate() {
            assert_eq!(coarse.blocks[1][i], [x + 1.0, 2.0 * x, 1.0]);
        }
        let gap = samples().coarse(16);
        assert_eq!((gap.pixel_width, gap.places.len()), (7.0, 13));
        assert!(gap.places.iter().all(|x| (x - 3.0) % 7.0 == 0.0 || *x > 44.0), "{:?}", gap.places);
        assert_eq!(samples().coarse(98).places, samples().places);
    }

    #[test]
    fn samples_within_a_reach_are_those_around() {
        let near = samples().within(50.0, 7.5);
        assert_eq!((near.places[0], near.places[near.places.len() - 1]), (45.0, 57.0));
        assert_eq!(near.blocks[0].len(), near.places.len());
        assert!(samples().within(500.0, 1.0).places.is_empty());
    }
}
