//! Everything that is generated, by the names of the blocks that show it.

use std::collections::BTreeMap;

use translucid_laboratory::Chart;
use translucid_laboratory::comparison::{Comparison, Settings};
use translucid_laboratory::figures::Report;
use translucid_profile::Model;

use super::references::References;
use super::{charts, lit_shapes, tables};

/// Photons that walk for the figures, in each configuration: as many as leave error bars that one can see.
const PHOTONS: u64 = 1_000_000;

/// Page with errors against samples, which a bench of the renderer writes.
pub(crate) const NOISE_PAGE: &str = "docs/speed/noise.md";

/// The comparison that the documentation shows.
pub(crate) fn settings(has_times: bool) -> Settings {
    let all = Settings::default();
    Settings { photons: PHOTONS, timing_rounds: if has_times { all.timing_rounds } else { 0 }, ..all }
}

/// Tables and figures by the names of their blocks: those of figures begin with `figure/`, those of times have
/// "time" in them.
pub(crate) struct Generated {
    /// Contents of the blocks: a table, or a figure's image and caption; links are from the root.
    pub(crate) blocks: BTreeMap<String, String>,
    /// SVG documents.
    pub(crate) figures: BTreeMap<String, String>,
}

impl Generated {
    /// Lays out a comparison, with times if it has them, and what a bench has left in [`NOISE_PAGE`].
    pub(crate) fn new(comparison: &Comparison, noise_page: &str) -> Result<Self, String> {
        let Comparison { errors, settings, .. } = comparison;
        let contenders = &settings.contenders;
        let references = References::new()?;

        let mut generated = Self { blocks: BTreeMap::new(), figures: BTreeMap::new() };
        for name in ["models/errors", "readme/errors"] {
            generated.add(name, tables::errors_of_models(contenders, errors));
        }
        // The oblique one is the refined one along the normal; what is its own takes another kind of table
        for model in Model::ALL.into_iter().filter(|model| *model != Model::NormalizedDiffusionOblique) {
            let name = model.name();
            generated.add(&format!("{name}/errors"), tables::errors_of_model(model, contenders, errors));
            if model == Model::Exact {
                generated.add("exact/values", tables::exact_values(&references)?);
                generated.add_chart(&charts::exact(&references));
            } else {
                generated.add(&format!("{name}/ratios"), tables::ratios(model, &references)?);
                generated.add_chart(&charts::model(model, &references)?);
            }
        }
        generated.add("normalized-diffusion-refined/coefficients", tables::refined_coefficients()?);
        generated.add("tables/errors", tables::errors_of_tables(&references)?);
        generated.add("tables/samples", tables::errors_of_samples(&references)?);
        generated.add_chart(&charts::samples(&references)?);
        generated.add_chart(&charts::noise(noise_page)?);
        lit_shapes::charts()?.iter().for_each(|chart| generated.add_chart(chart));
        generated.add("how-good/errors-searchlight", tables::all_errors(contenders, errors));
        generated.add("how-good/claims", tables::claims(&comparison.claims));
        generated.add("how-good/scaling", tables::scaling(&comparison.scaling));
        // Figures of the page that `translucid compare` writes
        let report = Report::new(comparison);
        report.page.charts().for_each(|chart| generated.add_chart(chart));
        if settings.timing_rounds > 0 {
            generated.add("how-good/times", tables::times(contenders, &comparison.timings));
        } else {
            generated.blocks.retain(|name, _| !Self::is_time(name));
            generated.figures.retain(|name, _| !Self::is_time(name));
        }
        Ok(generated)
    }

    /// Tells whether a block may have this name: that of something generated, or of times that are left alone.
    pub(crate) fn knows(&self, name: &str) -> bool {
        self.blocks.contains_key(name) || Self::is_time(name)
    }

    /// Tells whether this is the name of a table or figure that shows times.
    fn is_time(name: &str) -> bool {
        name.contains("time")
    }

    /// Tells whether this is the name of a figure.
    pub(crate) fn is_figure(name: &str) -> bool {
        name.starts_with("figure/")
    }

    fn add(&mut self, name: &str, content: String) {
        self.blocks.insert(name.to_owned(), content);
    }

    /// Adds a figure, with its caption one sentence a line.
    fn add_chart(&mut self, chart: &Chart) {
        let name = format!("figure/{}", chart.name);
        let caption = chart.caption.replace(". ", ".\n");
        let image = format!("![{}](docs/figures/{}.svg)\n\n{caption}", chart.title, chart.name);
        self.blocks.insert(name.clone(), image);
        self.figures.insert(name, chart.svg());
    }
}
