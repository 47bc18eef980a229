//! Charts: series over two axes, each in an ink that says what it stands for.

mod axis;
mod ink;
mod residuals;
mod shade;

pub use axis::{Axis, Scale};
pub use ink::Ink;
pub(crate) use ink::{Marker, Style};
pub use residuals::{ResidualScale, Residuals, residual_chart};
pub(crate) use shade::Shade;

use translucid_words::{Cell, Column, DataTable};

/// Form of a series.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A line from point to point, with a gap where a point has no place on the axes.
    Line,
    /// A marker at each point.
    Points,
    /// A marker with a bar of ± the standard error of y; one for each point.
    PointsWithErrors(Vec<f64>),
    /// A marker with words beside it; one for each point, of which the first 300 are drawn.
    LabelledPoints(Vec<String>),
    /// A histogram: each point is the left edge of a bin and its height, and the last one the right end of the last
    /// bin, its height unused.
    Steps,
    /// The area from each point up to another y at the same x; one for each point.
    Band(Vec<f64>),
}

/// Points, what they stand for and how they are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Words in the legend; a series without a label is not in it.
    pub label: String,
    /// Meaning: color, dash pattern and marker.
    pub ink: Ink,
    /// Form in which it is drawn.
    pub mark: Mark,
    /// x and y; a point without a place on the axes is left out.
    pub points: Vec<[f64; 2]>,
}

impl Series {
    /// A series.
    pub fn new(label: &str, ink: Ink, mark: Mark, points: Vec<[f64; 2]>) -> Self {
        Self { label: label.to_owned(), ink, mark, points }
    }
}

/// A chart: series over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Stem of its files' names, in letters, digits, "-" and "_".
    pub name: String,
    /// Title: what is seen, in a few words.
    pub title: String,
    /// Caption: what it shows and what to see in it, in one to three sentences; it stands below the chart on a page.
    pub caption: String,
    /// The axis from left to right.
    pub x: Axis,
    /// The axis from bottom to top.
    pub y: Axis,
    /// Everything that is drawn, the last on top; bands and lines of [`Ink::Reference`] are below all others.
    pub series: Vec<Series>,
}

impl Chart {
    /// A chart without series and caption.
    pub fn new(name: &str, title: &str, x: Axis, y: Axis) -> Self {
        let [name, title] = [name, title].map(str::to_owned);
        Self { name, title, caption: String::new(), x, y, series: Vec::new() }
    }

    /// The chart with a caption.
    #[must_use]
    pub fn with_caption(self, caption: &str) -> Self {
        Self { caption: caption.to_owned(), ..self }
    }

    /// The chart with one series more.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The numbers of all series, one row a point: series, x, y, and where a series has them the standard error, the
    /// upper end of a band and the words at a point.
    pub fn table(&self) -> DataTable {
        let has = |is: fn(&Mark) -> bool| self.series.iter().any(|series| is(&series.mark));
        let has_errors = has(|mark| matches!(mark, Mark::PointsWithErrors(_)));
        let has_bands = has(|mark| matches!(mark, Mark::Band(_)));
        let has_words = has(|mark| matches!(mark, Mark::LabelledPoints(_)));
        let optional = [(has_errors, "standard_error"), (has_bands, "upper"), (has_words, "point")];
        let (x, y) = (self.x.caption(), self.y.caption());
        let mut table = DataTable::new(&self.name, &self.title, &["series", x.as_str(), y.as_str()]);
        table
            .columns
            .extend(optional.iter().filter(|(has, _)| *has).map(|(_, name)| Column::new(name, "", "")));
        for series in &self.series {
            for (i, &[x, y]) in series.points.iter().enumerate() {
                let nth = |numbers: &[f64]| Cell::from(numbers.get(i).copied().unwrap_or(f64::NAN));
                let mut row = vec![Cell::from(series.label.as_str()), Cell::from(x), Cell::from(y)];
                let cells = match &series.mark {
                    Mark::PointsWithErrors(errors) => [Some(nth(errors)), None, None],
                    Mark::Band(upper) => [None, Some(nth(upper)), None],
                    Mark::LabelledPoints(words) => {
                        [None, None, words.get(i).map(|word| Cell::from(word.as_str()))]
                    }
                    Mark::Line | Mark::Points | Mark::Steps => [None, None, None],
                };
                let shown = cells.into_iter().zip(optional).filter(|(_, (has, _))| *has);
                row.extend(shown.map(|(cell, _)| cell.unwrap_or(Cell::Number(f64::NAN))));
                table.rows.push(row);
            }
        }
        table
    }
}
