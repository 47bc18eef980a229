//! Media of skins that differ in melanin and blood, for textures.

use translucid_profile::ParameterError;
use translucid_reference::walk::Control;

use super::{Skin, SkinParameters};

/// Media of skins of one kind for every amount of melanin and blood in a range.
///
/// It is bilinear in the square roots of both, in logarithms of albedos and mean free paths.
#[derive(Clone, Debug, PartialEq)]
pub struct SkinTable {
    axes: [Axis; 2],
    /// Logarithms of albedos and mean free paths, blood by blood.
    nodes: Vec<[f64; 6]>,
    /// Greatest differences from the skins' own media in the middles between nodes: of albedos, and of mean free paths as a part
    /// of them.
    pub error: [f64; 2],
}

/// Amounts of a pigment that the table has.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    /// Square roots of the ends.
    ends: [f64; 2],
    /// Number of nodes, 1 where the ends are equal.
    count: usize,
}

/// Nodes for melanin and for blood.
const NODES: [usize; 2] = [8, 4];

impl SkinTable {
    /// Finds media between the ends of melanin and of blood, with some photons for each wavelength; `None` where it was stopped.
    ///
    /// `progress` is called with the part that is done.
    ///
    /// # Errors
    /// A parameter is outside its range, or one of the skins has no [medium](Skin::medium).
    pub fn new(
        parameters: SkinParameters,
        ends: [[f64; 2]; 2],
        photons: u64,
        control: &Control,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Option<Self>, ParameterError> {
        let axes = [0, 1].map(|i| Axis::new(ends[i], NODES[i]));
        let places = |middle: f64| {
            let along = move |axis: Axis| (0..axis.places(middle)).map(move |i| axis.at(i as f64 + middle));
            along(axes[1]).flat_map(move |blood| along(axes[0]).map(move |melanin| [melanin, blood]))
        };
        let all = (places(0.0).count() + places(0.5).count()) as f64;
        let mut done = 0.0;
        let mut values = |[melanin, blood]: [f64; 2]| {
            let skin = Skin::new(SkinParameters { melanin, blood, ..parameters })?;
            let medium = skin.medium(photons, control)?;
            done += 1.0;
            progress(done / all);
            Ok::<_, ParameterError>(medium.map(|medium| [medium.surface_albedo, medium.mfp]))
        };
        let mut table = Self { axes, nodes: Vec::new(), error: [0.0; 2] };
        for place in places(0.0) {
            let Some([albedo, mfp]) = values(place)? else { return Ok(None) };
            table.nodes.push(std::array::from_fn(|i| libm::log(if i < 3 { albedo[i] } else { mfp[i - 3] })));
        }
        for [melanin, blood] in places(0.5) {
            let Some([albedo, mfp]) = values([melanin, blood])? else { return Ok(None) };
            let found = table.medium(melanin, blood);
            for c in 0..3 {
                table.error[0] = table.error[0].max((found[0][c] - albedo[c]).abs());
                table.error[1] = table.error[1].max((found[1][c] / mfp[c] - 1.0).abs());
            }
        }
        Ok(Some(table))
    }

    /// Surface albedos and mean free paths \[mm\] of the channels; beyond the range those of its end, and NaN counts as 0.
    pub fn medium(&self, melanin: f64, blood: f64) -> [[f64; 3]; 2] {
        let [(i, s), (j, t)] = [self.axes[0].cell(melanin), self.axes[1].cell(blood)];
        let [width, height] = [self.axes[0].count, self.axes[1].count];
        let node = |i: usize, j: usize| &self.nodes[j.min(height - 1) * width + i.min(width - 1)];
        let value = |k: usize| {
            let row = |j: usize| (1.0 - s) * node(i, j)[k] + s * node(i + 1, j)[k];
            libm::exp((1.0 - t) * row(j) + t * row(j + 1))
        };
        [[0, 1, 2].map(value), [3, 4, 5].map(value)]
    }
}

impl Axis {
    fn new([first, last]: [f64; 2], count: usize) -> Self {
        Self { ends: [first.sqrt(), last.sqrt()], count: if first == last { 1 } else { count } }
    }

    /// Number of nodes, or of middles between nodes; an axis of one node has that one as its middle.
    fn places(self, middle: f64) -> usize {
        if middle > 0.0 { (self.count - 1).max(1) } else { self.count }
    }

    /// Amount at a place, counted in nodes.
    fn at(self, place: f64) -> f64 {
        let [first, last] = self.ends;
        let part = if self.count == 1 { 0.0 } else { place / (self.count - 1) as f64 };
        let root = (1.0 - part) * first + part * last;
        root * root
    }

    /// Node before an amount, and the place behind it as a part of the way to the next.
    fn cell(self, amount: f64) -> (usize, f64) {
        let [first, last] = self.ends;
        if self.count == 1 {
            return (0, 0.0);
        }
        let part = (amount.max(0.0).sqrt() - first) / (last - first);
        let place = part.clamp(0.0, 1.0) * (self.count - 1) as f64;
        let node = (place as usize).min(self.count - 2);
        (node, place - node as f64)
    }
}
