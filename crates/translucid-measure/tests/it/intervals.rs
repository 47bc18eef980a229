//! Intervals of synthetic photographs hold the truth as often as they say.

#[path = "../../examples/intervals/synthetic.rs"]
mod synthetic;

use synthetic::{ExactEdges, PIXEL, Synthetic};
use translucid_measure::{Experiment, Options, Photo, Remark};
use translucid_testing::{SplitMix, power};

/// Of 72 intervals of ℓ and of A in 24 photographs each, at most 12 miss the truth.
/// Three channels of a photograph share its white card and light, and err together: if 95 % of the photographs hold all three,
/// more than 4 of 24 miss once in 200 runs, and the seed is fixed. The whole study of 200 is the example `intervals`.
#[test]
fn intervals_hold_the_truth() {
    let (edges, mut random) = (ExactEdges::new(), SplitMix(7));
    let count = power(192) as usize;
    let (mut missed, mut channels) = ([0; 2], 0);
    for _ in 0..count {
        let synthetic = Synthetic::new(&edges, &mut random);
        let options =
            Options { mm_per_pixel: Some(PIXEL), white: Some(synthetic.white), ..Options::default() };
        let experiment = Experiment::new(options).unwrap();
        let found = experiment.measure(synthetic.photographs.clone(), &mut |_| ()).unwrap();
        for (c, channel) in found.fit.channels.iter().enumerate() {
            let albedo = channel.surface_albedo.unwrap();
            let truths = [(channel.mfp, synthetic.mfps[c]), (albedo, synthetic.surface_albedos[c])];
            for (missed, (found, truth)) in missed.iter_mut().zip(truths) {
                *missed += usize::from(truth < found.sure[0] || truth > found.sure[1]);
                // They tell something, too
                assert!(found.sure[1] - found.sure[0] < 0.5 * truth, "{c}: {found:?} {truth}");
            }
            channels += 1;
        }
    }
    assert!(missed.iter().all(|missed| missed * 6 <= channels), "{missed:?} of {channels}");
}

/// Of a photograph with a dark and a bright channel: without something white nothing is known of A, and ℓ may be that of any.
#[test]
fn intervals_without_white_hold_any_surface_albedo() {
    let (edges, mut random) = (ExactEdges::new(), SplitMix(3));
    let synthetic = Synthetic::new(&edges, &mut random);
    let options = Options { mm_per_pixel: Some(PIXEL), white: Some(synthetic.white), ..Options::default() };
    let measure = |options: Options| {
        Experiment::new(options).unwrap().measure(synthetic.photographs.clone(), &mut |_| ()).unwrap()
    };
    let region = measure(options.clone()).region;
    let found = measure(Options { white: None, region: Some(region), ..options });
    for (channel, truth) in found.fit.channels.iter().zip(synthetic.mfps) {
        let [low, high] = channel.mfp.sure;
        assert!(low < truth && truth < high && high > 2.0 * low, "{channel:?} {truth}");
        assert_eq!(channel.surface_albedo, None);
    }
}

/// A lens whose corners get 20 % less light, in a photograph of 192 × 144 pixels or so.
#[test]
fn dark_corners_are_told_of() {
    let (edges, mut random) = (ExactEdges::new(), SplitMix(5));
    let synthetic = Synthetic::new(&edges, &mut random);
    let options = Options { mm_per_pixel: Some(PIXEL), white: Some(synthetic.white), ..Options::default() };
    let told = |darkening: f32| {
        let mut photographs = synthetic.photographs.clone();
        let photo = &photographs.photo.photo;
        let [width, height] = [photo.width, photo.height];
        let light = |x: usize, y: usize| {
            let [u, v] = [(x, width), (y, height)].map(|(i, n)| 2.0 * (i as f32 + 0.5) / n as f32 - 1.0);
            1.0 - darkening * (u * u + v * v) / 2.0
        };
        photographs.photo.photo =
            Photo::from_fn(width, height, |x, y| photo.pixels[y * width + x].map(|v| v * light(x, y)));
        let mut remarks = Vec::new();
        let mut say = |remark| remarks.push(remark);
        Experiment::new(options.clone()).unwrap().measure(photographs, &mut say).unwrap();
        remarks
            .iter()
            .any(|remark| matches!(remark, Remark::Warning(text) if text.contains("dark corners: if it")))
    };
    assert!(told(0.2));
    assert!(!told(0.0));
}
