//! Residuals of fits to a table.

use super::Axis;
use super::Ink;
use super::{Chart, Mark, Series};

/// Most samples that get a marker each; more are joined by lines.
const MOST_MARKERS: usize = 300;

/// Residuals of one fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Residuals<'a> {
    /// Name of the fit.
    pub label: &'a str,
    /// Ink that it is drawn in.
    pub ink: Ink,
    /// R_fit − R of each sample, in parts of what [`ResidualScale`] says.
    pub values: &'a [f64],
}

/// Unit of residuals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResidualScale {
    /// By the standard error of each sample: a fit that holds stays within ±1 for two samples of three.
    StandardErrors,
    /// By the sample itself, which has no error.
    Reflectance,
}

/// The residuals of fits over the radii of the samples, with a line at zero and, where the samples have errors, a
/// band of ±1 of them.
///
/// Radii that span more than a decade are on a logarithmic axis; they may be in any order.
pub fn residual_chart(radii: &[f64], fits: &[Residuals<'_>], scale: ResidualScale) -> Chart {
    let extent = |from: f64, pick: fn(f64, f64) -> f64| {
        radii.iter().copied().filter(|r| r.is_finite()).fold(from, pick)
    };
    let [low, high] = [extent(f64::INFINITY, f64::min), extent(f64::NEG_INFINITY, f64::max)];
    let is_wide = low > 0.0 && high > 10.0 * low;
    let x = if is_wide { Axis::logarithmic("r", "") } else { Axis::linear("r", "") };
    let (label, caption) = match scale {
        ResidualScale::StandardErrors => (
            "(fit − R) / standard error",
            "What each fit leaves over, in standard errors of the samples. \
             Of a fit that holds, two points of three lie in the band of ±1, without a trend.",
        ),
        ResidualScale::Reflectance => (
            "(fit − R) / R",
            "What each fit leaves over, as a part of the sample, since the samples have no errors. \
             A trend shows what the fit cannot follow.",
        ),
    };
    let mut chart =
        Chart::new("residuals", "Residuals of the fits", x, Axis::linear(label, "")).with_caption(caption);
    let ends = |y: f64| vec![[low, y], [high, y]];
    if scale == ResidualScale::StandardErrors {
        chart.series.push(Series::new("±1 standard error", Ink::Guide, Mark::Band(vec![1.0; 2]), ends(-1.0)));
    }
    chart.series.push(Series::new("", Ink::Guide, Mark::Line, ends(0.0)));
    let mark = if radii.len() > MOST_MARKERS { Mark::Line } else { Mark::Points };
    for fit in fits {
        let mut points: Vec<[f64; 2]> = radii.iter().zip(fit.values).map(|(&r, &value)| [r, value]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        chart.series.push(Series::new(fit.label, fit.ink, mark.clone(), points));
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scale;

    #[test]
    fn residuals_are_over_a_band_of_one_standard_error() {
        let fits = [Residuals { label: "burley", ink: Ink::Fit, values: &[0.5, -2.0, 1.0] }];
        let chart = residual_chart(&[1.0, 0.1, 5.0], &fits, ResidualScale::StandardErrors);
        assert_eq!(chart.x.scale, Scale::Logarithmic);
        assert_eq!(chart.series[0].points, [[0.1, -1.0], [5.0, -1.0]]);
        assert_eq!(chart.series[0].mark, Mark::Band(vec![1.0, 1.0]));
        assert_eq!(chart.series[2].points, [[0.1, -2.0], [1.0, 0.5], [5.0, 1.0]]);
        let relative = residual_chart(&[1.0, 2.0], &fits, ResidualScale::Reflectance);
        assert!(relative.x.scale == Scale::Linear && relative.series.len() == 2);
    }

    #[test]
    fn no_samples_are_an_empty_chart() {
        let chart = residual_chart(&[], &[], ResidualScale::StandardErrors);
        assert!(!chart.svg().contains("inf"));
    }
}
