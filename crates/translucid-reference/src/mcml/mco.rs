//! MCML's `.mco` files.

use std::f64::consts::{FRAC_PI_2, PI};

use translucid_profile::ParameterError;

use super::c_numbers::{exact, general, scientific};
use super::mci::MciRun;
use crate::layers::{Grid, Ground, Layer, Layers, LayersError, LayersTally, Quantity};
use crate::walk::Control;
use crate::{Estimate, Incidence};

/// Numbers in a line of a table of two dimensions.
const PER_LINE: usize = 5;

/// A figure of a result, and where it belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct McoFigure {
    /// MCML's name of the quantity: Rd, A, Tt, A_l and so on.
    pub name: &'static str,
    /// Layer, from 1.
    pub layer: Option<usize>,
    /// Center of the ring \[cm\].
    pub r: Option<f64>,
    /// Center of the depth \[cm\].
    pub z: Option<f64>,
    /// Center of the angle \[rad\].
    pub angle: Option<f64>,
    /// What MCML prints, with its standard error.
    pub density: Estimate,
}

/// MCML's names of quantities.
const NAMES: [(&str, Quantity); 12] = [
    ("Rd", Quantity::Reflected),
    ("A", Quantity::Absorbed),
    ("Tt", Quantity::Transmitted),
    ("A_l", Quantity::AbsorbedByLayer),
    ("A_z", Quantity::AbsorbedByDepth),
    ("Rd_r", Quantity::ReflectedByRing),
    ("Rd_a", Quantity::ReflectedByAngle),
    ("Tt_r", Quantity::TransmittedByRing),
    ("Tt_a", Quantity::TransmittedByAngle),
    ("A_rz", Quantity::AbsorbedByRingAndDepth),
    ("Rd_ra", Quantity::ReflectedByRingAndAngle),
    ("Tt_ra", Quantity::TransmittedByRingAndAngle),
];

/// Result of a run: the tables of an `.mco` file.
#[derive(Clone, Debug, PartialEq)]
pub struct Mco {
    run: MciRun,
    tally: LayersTally,
}

impl MciRun {
    /// The layers, in cm.
    ///
    /// # Errors
    /// They are no layers; none that an `.mci` file describes.
    pub fn layers(&self) -> Result<Layers, LayersError> {
        let layer = |layer: &super::MciLayer| {
            Layer::new(layer.mus, layer.mua, layer.d).with_g(layer.g).with_eta(layer.n)
        };
        let list = self.layers.iter().map(layer).collect();
        Layers::new(self.n_above, list, Ground::Medium { eta: self.n_below })
    }

    /// The cells in which light is counted, in cm.
    pub fn grid(&self) -> Grid {
        let &Self { dz, dr, nz, nr, na, .. } = self;
        Grid { dz, dr, nz, nr, na }
    }

    /// Checks what [`walk`](Self::walk) does before its first photon.
    ///
    /// # Errors
    /// As there.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.layers().map_err(|error| error.error)?.check_for_walk(Incidence::NORMAL, &self.grid())
    }

    /// Walks the photons of the run.
    ///
    /// # Errors
    /// Mean free paths and thicknesses differ by more than a factor of 1e12.
    pub fn walk(&self, seed: u64, control: &Control) -> Result<Mco, ParameterError> {
        let layers = self.layers().map_err(|error| error.error)?;
        let tally = layers.walk(Incidence::NORMAL, self.grid(), self.photons, seed, control)?;
        Ok(Mco { run: self.clone(), tally })
    }
}

impl Mco {
    /// Figures with their errors, as parts of the light.
    pub fn tally(&self) -> &LayersTally {
        &self.tally
    }

    /// The run, as it was read.
    pub fn run(&self) -> &MciRun {
        &self.run
    }

    /// All figures but the specular reflectance, in the order of the file.
    pub fn figures(&self) -> impl Iterator<Item = McoFigure> {
        NAMES.into_iter().flat_map(move |(name, quantity)| {
            self.densities(quantity)
                .enumerate()
                .map(move |(i, density)| self.figure(name, quantity, i, density))
        })
    }

    fn figure(&self, name: &'static str, quantity: Quantity, i: usize, density: Estimate) -> McoFigure {
        let Grid { dz, nz, na, .. } = *self.tally.grid();
        let depth = |i: usize| Some((i as f64 + 0.5) * dz);
        let (ring, angle) = (|i: usize| Some(self.tally.grid().radius(i)), |i: usize| Some(self.angle(i)));
        let (layer, r, z, angle) = match quantity {
            Quantity::AbsorbedByLayer => (Some(i + 1), None, None, None),
            Quantity::AbsorbedByDepth => (None, None, depth(i), None),
            Quantity::ReflectedByRing | Quantity::TransmittedByRing => (None, ring(i), None, None),
            Quantity::ReflectedByAngle | Quantity::TransmittedByAngle => (None, None, None, angle(i)),
            Quantity::AbsorbedByRingAndDepth => (None, ring(i / nz), depth(i % nz), None),
            Quantity::ReflectedByRingAndAngle | Quantity::TransmittedByRingAndAngle => {
                (None, ring(i / na), None, angle(i % na))
            }
            _ => (None, None, None, None),
        };
        McoFigure { name, layer, r, z, angle, density }
    }

    /// Center of an angle \[rad\].
    fn angle(&self, index: usize) -> f64 {
        (index as f64 + 0.5) * self.angle_width()
    }

    fn angle_width(&self) -> f64 {
        FRAC_PI_2 / self.run.na as f64
    }

    /// Size of a cell of a quantity, by which MCML divides its part of the light: an area, a solid angle, a volume.
    ///
    /// Solid angles are MCML's own: at the center of the angle, but for `Rd_ra` and `Tt_ra`, whose sine is that of half
    /// the width.
    fn cell_size(&self, quantity: Quantity, index: usize) -> f64 {
        let Grid { dz, nz, na, .. } = *self.tally.grid();
        let area = |ring: usize| self.tally.grid().ring_area(ring);
        let width = self.angle_width();
        match quantity {
            Quantity::AbsorbedByDepth => dz,
            Quantity::ReflectedByRing | Quantity::TransmittedByRing => area(index),
            Quantity::ReflectedByAngle | Quantity::TransmittedByAngle => {
                2.0 * PI * width * libm::sin(self.angle(index))
            }
            Quantity::AbsorbedByRingAndDepth => area(index / nz) * dz,
            Quantity::ReflectedByRingAndAngle | Quantity::TransmittedByRingAndAngle => {
                let angle = self.angle(index % na);
                area(index / na) * 2.0 * PI * libm::sin(2.0 * angle) * libm::sin(0.5 * width)
            }
            _ => 1.0,
        }
    }

    /// The file's text, in MCML's order and units, with standard errors of totals in comments.
    ///
    /// Two numbers differ in meaning from MCML's: the absorption of a layer is what its own collisions absorbed, where MCML
    /// adds up cells whose center is in it; and the number of photons is that of those walked.
    pub fn text(&self) -> String {
        let mut text = String::from("A1 \t# version of the file format\n\n####\n# Parts of the file:\n");
        text += "# InParm, RAT,\n# A_l, A_z, Rd_r, Rd_a, Tt_r, Tt_a,\n# A_rz, Rd_ra, Tt_ra\n####\n\n";
        text += &format!("# translucid {}\n\n", env!("CARGO_PKG_VERSION"));
        self.write_parameters(&mut text);
        self.write_totals(&mut text);
        let lists = [
            ("A_z", "absorbed per depth, A[0] to A[nz-1] [1/cm]", Quantity::AbsorbedByDepth),
            ("Rd_r", "reflected per area, Rd[0] to Rd[nr-1] [1/cm2]", Quantity::ReflectedByRing),
            ("Rd_a", "reflected per solid angle, Rd[0] to Rd[na-1] [1/sr]", Quantity::ReflectedByAngle),
            ("Tt_r", "transmitted per area, Tt[0] to Tt[nr-1] [1/cm2]", Quantity::TransmittedByRing),
            ("Tt_a", "transmitted per solid angle, Tt[0] to Tt[na-1] [1/sr]", Quantity::TransmittedByAngle),
        ];
        for (name, comment, quantity) in lists {
            text += &format!("{name} # {comment}\n");
            self.densities(quantity)
                .for_each(|found| text += &format!("{:>12}\n", scientific(found.value, 4)));
            text.push('\n');
        }
        let tables = [
            ("A_rz", "A[r][z]: absorbed per volume [1/cm3]", "z", Quantity::AbsorbedByRingAndDepth),
            (
                "Rd_ra",
                "Rd[r][a]: reflected per area and solid angle [1/(cm2 sr)]",
                "a",
                Quantity::ReflectedByRingAndAngle,
            ),
            (
                "Tt_ra",
                "Tt[r][a]: transmitted per area and solid angle [1/(cm2 sr)]",
                "a",
                Quantity::TransmittedByRingAndAngle,
            ),
        ];
        for (name, comment, second, quantity) in tables {
            text += &format!(
                "# {comment}\n# [0][0], [0][1], .. [0][n{second}-1]\n# [1][0], [1][1], .. [1][n{second}-1]\n"
            );
            text += &format!("# ..\n# [nr-1][0], [nr-1][1], .. [nr-1][n{second}-1]\n{name}\n");
            for (i, found) in self.densities(quantity).enumerate() {
                let end = if (i + 1) % PER_LINE == 0 { "\n" } else { "" };
                text += &format!("{:>12} {end}", scientific(found.value, 4));
            }
            text.push('\n');
        }
        text
    }

    fn write_parameters(&self, text: &mut String) {
        let MciRun { output, dz, dr, nz, nr, na, n_above, layers, n_below, .. } = &self.run;
        *text += "InParm \t\t\t# what was asked for, in cm\n";
        *text += &format!("{output} \tA\t\t# output file, as text\n");
        *text += &format!("{} \t\t\t# number of photons\n", self.tally.photons());
        *text += &format!("{}\t{}\t\t# dz, dr [cm]\n", exact(*dz), exact(*dr));
        *text += &format!("{nz}\t{nr}\t{na}\t# numbers of dz, dr, da\n\n");
        *text += &format!(
            "{}\t\t\t\t\t# number of layers\n#n\tmua\tmus\tg\td\t# a line for each layer\n",
            layers.len()
        );
        *text += &format!("{}\t\t\t\t\t# n of the medium above\n", exact(*n_above));
        for (i, layer) in layers.iter().enumerate() {
            let values = [layer.n, layer.mua, layer.mus, layer.g, layer.d].map(exact);
            *text += &format!("{}\t# layer {}\n", values.join("\t"), i + 1);
        }
        *text += &format!("{}\t\t\t\t\t# n of the medium below\n\n", exact(*n_below));
    }

    fn write_totals(&self, text: &mut String) {
        *text += "RAT # reflectance, absorption, transmission\n";
        *text += &format!("{:<14} \t# specular reflectance [-]\n", general(self.tally.specular(), 6));
        for (name, quantity) in [
            ("diffuse reflectance", Quantity::Reflected),
            ("absorbed fraction", Quantity::Absorbed),
            ("transmittance", Quantity::Transmitted),
        ] {
            let total = self.tally.total(quantity);
            let (value, error) = (general(total.value, 6), general(total.error, 2));
            *text += &format!("{value:<14} \t# {name} [-], standard error {error}\n");
        }
        *text += "\nA_l # absorbed in each layer [-]\n";
        for layer in self.tally.all(Quantity::AbsorbedByLayer) {
            *text += &format!("{:>12}\n", general(layer.value, 4));
        }
        text.push('\n');
    }

    /// What MCML prints of a quantity: the part of the light over the size of the cell.
    fn densities(&self, quantity: Quantity) -> impl Iterator<Item = Estimate> {
        self.tally.all(quantity).enumerate().map(move |(i, Estimate { value, error })| {
            let size = self.cell_size(quantity, i);
            Estimate { value: value / size, error: error / size }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse_mci;
    use super::*;

    const RUN: &str =
        "1.0\n1\nskin.mco A\n20000\n0.01 0.02\n7 4 3\n2\n1\n1.37 1 100 0.9 0.02\n1.4 2 10 0 0.04\n1\n";

    fn result() -> Mco {
        parse_mci(RUN.as_bytes()).unwrap()[0].walk(1, &Control::default()).unwrap()
    }

    /// Numbers behind a name, as scripts read them: words that are not comments, up to the next name.
    fn numbers(text: &str, name: &str) -> Vec<f64> {
        let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
        let words: Vec<&str> = lines.flat_map(str::split_whitespace).collect();
        let start = words.iter().position(|word| *word == name).unwrap() + 1;
        words[start..].iter().map_while(|word| word.parse().ok()).collect()
    }

    #[test]
    fn text_holds_the_run_and_can_be_read_back() {
        let text = result().text();
        let inputs: Vec<&str> =
            text.split("InParm \t").nth(1).unwrap().split("RAT #").next().unwrap().lines().skip(1).collect();
        let again = format!("1.0\n1\n{}", inputs.join("\n"));
        let run = &parse_mci(again.as_bytes()).unwrap()[0];
        assert_eq!(run.layers, result().run.layers);
        assert_eq!((run.photons, run.grid()), (20_000, result().run.grid()));
    }

    /// Sizes of cells undone, the parts of the light are the totals again.
    #[test]
    fn tables_add_up_to_the_totals() {
        let (result, text) = (result(), result().text());
        let totals = numbers(&text, "RAT");
        assert!((totals.iter().sum::<f64>() - 1.0).abs() < 2e-3, "{totals:?}");
        for (name, quantity, count, total) in [
            ("A_l", Quantity::AbsorbedByLayer, 2, totals[2]),
            ("A_z", Quantity::AbsorbedByDepth, 7, totals[2]),
            ("Rd_r", Quantity::ReflectedByRing, 4, totals[1]),
            ("Rd_a", Quantity::ReflectedByAngle, 3, totals[1]),
            ("Tt_r", Quantity::TransmittedByRing, 4, totals[3]),
            ("Tt_a", Quantity::TransmittedByAngle, 3, totals[3]),
            ("A_rz", Quantity::AbsorbedByRingAndDepth, 28, totals[2]),
            ("Rd_ra", Quantity::ReflectedByRingAndAngle, 12, totals[1]),
            ("Tt_ra", Quantity::TransmittedByRingAndAngle, 12, totals[3]),
        ] {
            let values = numbers(&text, name);
            assert_eq!(values.len(), count, "{name}");
            let sum: f64 =
                values.iter().enumerate().map(|(i, value)| value * result.cell_size(quantity, i)).sum();
            assert!((sum - total).abs() < 1e-3 * total, "{name}: {sum} {total}");
        }
    }

    #[test]
    fn specular_line_is_fresnels_or_that_of_a_pane() {
        assert!(result().text().contains("0.0243729      \t# specular reflectance"));
        let pane = RUN.replace("1.37 1 100", "1.37 0 0");
        let result = parse_mci(pane.as_bytes()).unwrap()[0].walk(1, &Control::default()).unwrap();
        let [r1, r2] = [0.37f64 / 2.37, 0.03 / 2.77].map(|r| r * r);
        let expected = r1 + (1.0 - r1).powi(2) * r2 / (1.0 - r1 * r2);
        assert!((result.tally().specular() - expected).abs() < 1e-12);
    }
}
