//! How often intervals hold the truth, in synthetic photographs of an edge of light.
//!
//! ```text
//! cargo run --release -p translucid-measure --example intervals [-- --write]
//! ```
//!
//! `--write` puts the tables into `docs/accuracy/measure.md`.
//! A photograph has three channels with random surface albedos and mean free paths, stray light, light that is uneven across
//! and along the edge, blur, noise, and a white card whose reflectance differs from the stated one.
//! A second table shows how the mean free path depends on a surface albedo that is guessed.

#![allow(clippy::print_stdout, reason = "the tables go to standard output")]

#[path = "intervals/synthetic.rs"]
mod synthetic;

use synthetic::{ExactEdges, PIXEL, Synthetic};
use translucid_measure::{Card, Experiment, Interval, Options, Response, Scale, fit_edge_of};
use translucid_reference::Incidence;
use translucid_testing::{SplitMix, write_measured};

const PHOTOGRAPHS: usize = 200;

/// Quantities of some channels: whether the interval holds the truth, its half width and the error, over the truth.
#[derive(Default)]
struct Quantities(Vec<(bool, f64, f64)>);

impl Quantities {
    fn add(&mut self, found: Interval, truth: f64) {
        let [low, high] = found.sure;
        let is_held = low <= truth && truth <= high;
        self.0.push((is_held, 0.5 * (high - low) / truth, (found.value / truth - 1.0).abs()));
    }

    fn cells(&self) -> String {
        let count = self.0.len().max(1) as f64;
        let held = self.0.iter().filter(|(is_held, ..)| *is_held).count() as f64 / count;
        let median = |of: fn(&(bool, f64, f64)) -> f64| {
            let mut all: Vec<f64> = self.0.iter().map(of).collect();
            all.sort_by(f64::total_cmp);
            100.0 * all.get(all.len() / 2).copied().unwrap_or(0.0)
        };
        let (half, error) = (median(|(_, half, _)| *half), median(|(.., error)| *error));
        format!("{:.1} % | {half:.1} % | {error:.1} %", 100.0 * held)
    }
}

fn main() {
    let (edges, mut random) = (ExactEdges::new(), SplitMix(2026));
    let mut all = [[Quantities::default(), Quantities::default()], Default::default()];
    for _ in 0..PHOTOGRAPHS {
        let synthetic = Synthetic::new(&edges, &mut random);
        let options =
            Options { mm_per_pixel: Some(PIXEL), white: Some(synthetic.white), ..Options::default() };
        let experiment = Experiment::new(options).expect("the options are those of the guide");
        let found = experiment.measure(synthetic.photographs.clone(), &mut |_| ());
        let found = match found {
            Ok(found) => found,
            Err(error) => {
                println!("not measured: {error}");
                continue;
            }
        };
        let [of_mfp, of_albedo] = &mut all[usize::from(synthetic.is_card_seen)];
        for (c, channel) in found.fit.channels.iter().enumerate() {
            of_mfp.add(channel.mfp, synthetic.mfps[c]);
            channel
                .surface_albedo
                .iter()
                .for_each(|albedo| of_albedo.add(*albedo, synthetic.surface_albedos[c]));
        }
    }
    let mut table = String::from(
        "| dark side | channels | ℓ within 95 % | half the interval | error of ℓ | A within 95 % | half the interval | error of A |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for (side, [of_mfp, of_albedo]) in ["the piece in shadow", "the card"].iter().zip(&all) {
        table += &format!("| {side} | {} | {} | {} |\n", of_mfp.0.len(), of_mfp.cells(), of_albedo.cells());
    }
    let guessed = guessed_albedos(&edges);
    print!("{table}\n{guessed}");
    if std::env::args().any(|argument| argument == "--write") {
        let command = "cargo run --release -p translucid-measure --example intervals -- --write";
        write_measured("docs/accuracy/measure.md", command, &table);
        write_measured("docs/accuracy/measure.md", &format!("{command}, guessed albedos"), &guessed);
    }
}

/// Mean free paths by guessed surface albedos, over those by the right ones.
fn guessed_albedos(edges: &ExactEdges) -> String {
    let response = Response::new(1.0, Incidence::Cosine).expect("it is solved");
    let mut random = SplitMix(5);
    let mut table = String::from("| A | ℓ for A = 0.7 | ℓ for 0.9 A | ℓ for 1.1 A |\n|---|---|---|---|\n");
    for places in [[0, 3, 6], [8, 10, 13]] {
        let samples = edges.samples(places, &mut random);
        let truths = places.map(ExactEdges::albedo);
        let mfps = |albedos: [f64; 3]| {
            let fit = fit_edge_of(Card::Hidden, &samples, &response, Scale::Relative(albedos));
            fit.expect("it gets brighter").channels.map(|channel| channel.mfp.value)
        };
        let right = mfps(truths);
        let guesses = [mfps([0.7; 3]), mfps(truths.map(|a| 0.9 * a)), mfps(truths.map(|a| 1.1 * a))];
        for c in 0..3 {
            let [usual, less, more] = guesses.map(|guess| guess[c] / right[c]);
            table += &format!("| {:.2} | {usual:.2} | {less:.2} | {more:.2} |\n", truths[c]);
        }
    }
    table
}
