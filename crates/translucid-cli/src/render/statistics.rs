//! `--stats`: what a rendering took, as JSON.

use std::path::Path;

use serde_json::{Value, json};
use translucid_laboratory::picture::relative_noise;
use translucid_render::{FilmSums, Outcome};
use translucid_scene::{Film, Scene};
use translucid_view::comparable;

use crate::failure::Failure;
use crate::files::write_file;
use crate::{command_line, machine, messages};

/// Facts of a rendering, besides those of its scene and film.
pub(super) struct Statistics<'a> {
    pub(super) scene_name: String,
    /// Which of several pictures it is.
    pub(super) label: Option<String>,
    pub(super) files: Vec<String>,
    pub(super) outcome: Outcome,
    pub(super) threads: usize,
    /// Seconds of the parts of the work.
    pub(super) loading: f64,
    pub(super) preparing: f64,
    pub(super) rendering: f64,
    pub(super) rendering_before: f64,
    pub(super) writing: f64,
    pub(super) cpu_seconds: Option<f64>,
    /// Samples of this run.
    pub(super) samples_now: u64,
    /// The sums after half of the samples.
    pub(super) first_half: Option<&'a FilmSums>,
}

impl Statistics<'_> {
    /// All of it, by the names that `render --help` promises.
    pub(super) fn json(&self, scene: &Scene, film: &FilmSums) -> Value {
        let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "command": command_line::shown(),
            "scene": self.scene_name,
            "label": self.label,
            "outcome": match self.outcome {
                Outcome::Finished => "finished",
                Outcome::TimeUp => "time-up",
                Outcome::Interrupted => "interrupted",
            },
            "files": self.files,
            "width": film.width,
            "height": film.height,
            "threads": self.threads,
            "objects": scene.objects.len(),
            "triangles": triangles,
            "samples_per_pixel": film.samples(),
            "samples": film.paths(),
            "samples_now": self.samples_now,
            "samples_per_second": self.samples_now as f64 / self.rendering.max(1e-3),
            "seconds": {
                "loading": self.loading,
                "preparing": self.preparing,
                "rendering": self.rendering,
                "rendering_before": self.rendering_before,
                "writing": self.writing,
            },
            "cpu_seconds": self.cpu_seconds,
            "peak_memory_bytes": machine::peak_memory(),
            "relative_noise": self.relative_noise(&scene.film, film),
        })
    }

    fn relative_noise(&self, settings: &Film, film: &FilmSums) -> Option<f64> {
        let half = self.first_half.filter(|_| self.outcome == Outcome::Finished)?;
        let [all, first] = [film, half].map(|film| comparable(film, settings));
        let noise = relative_noise([&all, &first], [half.samples(), film.samples()], &all);
        Some(noise).filter(|noise| noise.is_finite())
    }
}

/// Writes statistics to a file, and to stderr where that is JSON.
pub(super) fn write(path: Option<&Path>, statistics: Value) -> Result<(), Failure> {
    let written = match path {
        Some(path) => write_file(path, format!("{statistics:#}\n").as_bytes()),
        None => Ok(()),
    };
    messages::event("statistics", statistics);
    written
}
