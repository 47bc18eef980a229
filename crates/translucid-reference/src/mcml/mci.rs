//! MCML's `.mci` files.

use std::str::SplitWhitespace;

use translucid_profile::InputError;

use crate::layers::{Grid, Layers};

/// Most photons of a run.
const MOST_PHOTONS: f64 = 1e15;

/// A run of an `.mci` file. Lengths are in cm.
#[derive(Clone, Debug, PartialEq)]
pub struct MciRun {
    /// Line of the file, from 1, that names the output.
    pub line: usize,
    /// Name of the output file.
    pub output: String,
    /// Whether the output was asked for in binary (B), which MCML writes as text, too.
    pub is_binary: bool,
    /// Number of photons, at least 1.
    pub photons: u64,
    /// Depth of a cell \[cm\].
    pub dz: f64,
    /// Width of a ring \[cm\].
    pub dr: f64,
    /// Number of cells in depth.
    pub nz: usize,
    /// Number of rings; the last one also takes what is beyond it.
    pub nr: usize,
    /// Number of angles between 0 and 90 degrees from the normal.
    pub na: usize,
    /// Index of refraction of the medium above, where light comes from.
    pub n_above: f64,
    /// Layers from the top down, at least one.
    pub layers: Vec<MciLayer>,
    /// Index of refraction of the medium below.
    pub n_below: f64,
}

/// A layer of an `.mci` file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MciLayer {
    /// Index of refraction, in [0.1, 10].
    pub n: f64,
    /// Absorption coefficient \[1/cm\].
    #[doc(alias = "sigma_a")]
    pub mua: f64,
    /// Scattering coefficient \[1/cm\].
    #[doc(alias = "sigma_s")]
    pub mus: f64,
    /// Mean cosine of the phase function of Henyey and Greenstein, in (−1, 1).
    pub g: f64,
    /// Thickness \[cm\]; MCML's users write 1e8 where it is meant to be infinite.
    pub d: f64,
}

/// Reads the runs of an `.mci` file.
///
/// What stands behind `#` is a comment, empty lines are skipped, and lines may end as on any system. Every other line holds as
/// many values as MCML reads from it. Memory is allocated for what the file has, not for what it claims; a grid is limited.
///
/// ```
/// let text = "1.0 # file version\n1 # runs\nslab.mco A\n1e5\n1e-3 1e-3\n20 50 10\n1\n1\n1 10 90 0.75 0.02\n1\n";
/// let runs = translucid_reference::mcml::parse_mci(text.as_bytes())?;
/// assert_eq!((runs[0].photons, runs[0].layers[0].g), (100_000, 0.75));
/// # Ok::<(), translucid_profile::InputError>(())
/// ```
///
/// # Errors
/// A value is not a number or is out of range, a line has too few or too many values, an output is named twice, or the file
/// ends early or goes on after its last run.
pub fn parse_mci(bytes: &[u8]) -> Result<Vec<MciRun>, InputError> {
    let text = String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
    let mut lines = Lines { lines: text.lines().enumerate(), last: 0 };
    read_version(&mut lines)?;
    let count = lines.values("the number of runs", 1)?.whole("the number of runs", 1, 32_767)?;
    let mut runs: Vec<MciRun> = Vec::new();
    for number in 1..=count {
        let run = read_run(&mut lines).map_err(|error| in_run(error, number, count))?;
        if let Some(other) = runs.iter().find(|other| other.output == run.output) {
            let message =
                format!("the output {:?} is also that of the run in line {}", run.output, other.line);
            return Err(at(run.line, message));
        }
        runs.push(run);
    }
    match lines.next() {
        None => Ok(runs),
        Some((line, text)) => {
            let message =
                format!("{:?} follows the last run, but line 2 of the data says {count} runs", text.trim());
            Err(InputError { help: Some(String::from("correct the number of runs")), ..at(line, message) })
        }
    }
}

fn read_version(lines: &mut Lines) -> Result<(), InputError> {
    let mut version = lines.values("the file version", 1)?;
    let word = version.word();
    if word.parse() == Ok(1.0_f64) {
        return Ok(());
    }
    let error = at(version.line, format!("the file version is {word:?}, but must be 1.0"));
    let help =
        word.starts_with("mcmli").then(|| String::from("this is a file of MCML 2.0; write it for MCML 1.2"));
    Err(InputError { help, ..error })
}

fn read_run(lines: &mut Lines) -> Result<MciRun, InputError> {
    let mut output = lines.values("the output's name and format", 2)?;
    let (line, name, format) = (output.line, output.word(), output.word());
    if !matches!(format, "A" | "B" | "a" | "b") {
        return Err(at(line, format!("the output's format is {format:?}, but must be A or B")));
    }
    let (output, is_binary) = (name.to_owned(), format.eq_ignore_ascii_case("B"));
    let photons =
        lines.values("the number of photons", 1)?.whole("the number of photons", 1, MOST_PHOTONS as u64)?;
    let mut sizes = lines.values("dz and dr", 2)?;
    let [dz, dr] = [sizes.number("dz", LENGTH)?, sizes.number("dr", LENGTH)?];
    let mut counts = lines.values("the numbers of dz, dr and da", 3)?;
    let [nz, nr, na] = ["dz", "dr", "da"]
        .map(|name| counts.whole(&format!("the number of {name}"), 1, Grid::MOST_CELLS as u64));
    let [nz, nr, na] = [nz?, nr?, na?];
    let cells = nr * (nz + 2 * na);
    if cells > Grid::MOST_CELLS as u64 {
        let message =
            format!("the grid has {cells} cells, nr (nz + 2 na), but must have at most {}", Grid::MOST_CELLS);
        return Err(at(counts.line, message));
    }
    let count =
        lines.values("the number of layers", 1)?.whole("the number of layers", 1, Layers::MOST as u64)?;
    let n_above = lines.values("n of the medium above", 1)?.number("n of the medium above", INDEX)?;
    let layers = (1..=count).map(|number| read_layer(lines, number)).collect::<Result<_, _>>()?;
    let n_below = lines.values("n of the medium below", 1)?.number("n of the medium below", INDEX)?;
    let [nz, nr, na] = [nz, nr, na].map(|count| count as usize);
    Ok(MciRun { line, output, is_binary, photons, dz, dr, nz, nr, na, n_above, layers, n_below })
}

fn read_layer(lines: &mut Lines, number: u64) -> Result<MciLayer, InputError> {
    let mut values = lines.values(&format!("n, mua, mus, g and d of layer {number}"), 5)?;
    let mut value = |name: &str, range| values.number(&format!("{name} of layer {number}"), range);
    Ok(MciLayer {
        n: value("n", INDEX)?,
        mua: value("mua", COEFFICIENT)?,
        mus: value("mus", COEFFICIENT)?,
        g: value("g", COSINE)?,
        d: value("d", LENGTH)?,
    })
}

/// Values that a number may have, as a test and in words that follow "must be".
type Range = (fn(f64) -> bool, &'static str);

const LENGTH: Range = (|value| (1e-12..=1e12).contains(&value), "in [1e-12, 1e12]");
const INDEX: Range = (|value| (0.1..=10.0).contains(&value), "in [0.1, 10]");
const COEFFICIENT: Range = (|value| value == 0.0 || (1e-12..=1e12).contains(&value), "0 or in [1e-12, 1e12]");
const COSINE: Range = (|value| value.abs() < 1.0, "in (-1, 1)");

/// The lines that hold data.
struct Lines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// The last line that was read, from 1.
    last: usize,
}

impl<'a> Lines<'a> {
    /// The next line with data, from 1, without its comment.
    fn next(&mut self) -> Option<(usize, &'a str)> {
        for (index, line) in self.lines.by_ref() {
            self.last = index + 1;
            let data = line.split('#').next().unwrap_or_default();
            if !data.trim().is_empty() {
                return Some((self.last, data));
            }
        }
        None
    }

    /// The values of the next line, as many as there must be.
    fn values(&mut self, what: &str, count: usize) -> Result<Values<'a>, InputError> {
        let Some((line, data)) = self.next() else {
            return Err(at(self.last.max(1), format!("the file ends where {what} must follow")));
        };
        let found = data.split_whitespace().count();
        if found == count {
            return Ok(Values { line, words: data.split_whitespace() });
        }
        let plural = if found == 1 { "" } else { "s" };
        let message = format!("the line has {found} value{plural}, but must have {count}: {what}");
        let help = (found > count).then(|| String::from("a comment begins with #"));
        Err(InputError { help, ..at(line, message) })
    }
}

/// The values of a line.
struct Values<'a> {
    line: usize,
    words: SplitWhitespace<'a>,
}

impl<'a> Values<'a> {
    fn word(&mut self) -> &'a str {
        self.words.next().unwrap_or_default()
    }

    fn number(&mut self, name: &str, (holds, allowed): Range) -> Result<f64, InputError> {
        let word = self.word();
        match word.parse::<f64>() {
            Ok(value) if holds(value) => Ok(value),
            _ => Err(at(self.line, format!("{name} is {word}, but must be {allowed}"))),
        }
    }

    /// A whole number, which may be written as 1e6: MCML would take that for 1.
    fn whole(&mut self, name: &str, least: u64, most: u64) -> Result<u64, InputError> {
        let word = self.word();
        match word.parse::<f64>() {
            Ok(value) if value.fract() == 0.0 && (least as f64..=most as f64).contains(&value) => {
                Ok(value as u64)
            }
            _ => {
                let message = format!("{name} is {word}, but must be a whole number from {least} to {most}");
                Err(at(self.line, message))
            }
        }
    }
}

fn at(line: usize, message: String) -> InputError {
    InputError { message, line: Some(line), help: None }
}

/// Names the run where the file has several.
fn in_run(error: InputError, number: u64, count: u64) -> InputError {
    if count == 1 {
        return error;
    }
    InputError { message: format!("run {number}: {}", error.message), ..error }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO_RUNS: &str = "\
# Lengths in cm, µ in 1/cm

1.0 \t# file version
2\t# runs
### First
skin.mco\tA
1000
20E-4 2e-3\t# dz, dr
10 20 30
2
#n mua mus g d
1
1.3 20 200 0.7 0.01
 1.4 0 0 -0.5 1.0E+8
1.0
teeth.mco b # binary
5e4
1 1
1 1 1
1
1.33
1.5 1 0 0 1
1
";

    #[test]
    fn runs_are_read_with_comments_and_any_line_ends() {
        let runs = parse_mci(TWO_RUNS.as_bytes()).unwrap();
        assert_eq!(runs.len(), 2);
        let MciRun { line, output, is_binary, photons, dz, dr, nz, nr, na, n_above, layers, n_below } =
            &runs[0];
        assert_eq!((*line, output.as_str(), *is_binary, *photons), (6, "skin.mco", false, 1000));
        assert_eq!((*dz, *dr, *nz, *nr, *na), (0.002, 0.002, 10, 20, 30));
        assert_eq!((*n_above, *n_below), (1.0, 1.0));
        let clear = MciLayer { n: 1.4, mua: 0.0, mus: 0.0, g: -0.5, d: 1e8 };
        assert_eq!(layers, &[MciLayer { n: 1.3, mua: 20.0, mus: 200.0, g: 0.7, d: 0.01 }, clear]);
        assert_eq!((runs[1].is_binary, runs[1].photons, runs[1].n_above), (true, 50_000, 1.33));
        for end in ["\r\n", "\n\n"] {
            let other = parse_mci(TWO_RUNS.replace('\n', end).as_bytes()).unwrap();
            assert_eq!((&other[0].layers, &other[1].output), (&runs[0].layers, &runs[1].output));
        }
        let without_last_end = parse_mci(TWO_RUNS.trim_end().as_bytes()).unwrap();
        assert_eq!(without_last_end, runs);
        let latin_1 = [b"# \xb5\n", TWO_RUNS.as_bytes()].concat();
        assert_eq!(parse_mci(&latin_1).unwrap()[0].layers, runs[0].layers);
    }

    /// A line of the first run or the whole, changed: the line and the message of the error.
    #[test]
    fn errors_name_line_value_and_what_is_allowed() {
        let cases = [
            ("1.0 \t#", "2.0 \t#", 3, r#"the file version is "2.0", but must be 1.0"#),
            ("1.0 \t#", "mcmli2.0 #", 3, r#"the file version is "mcmli2.0", but must be 1.0"#),
            ("2\t# runs", "0", 4, "the number of runs is 0, but must be a whole number from 1 to 32767"),
            ("2\t# runs", "3", 23, "run 3: the file ends where the output's name and format must follow"),
            (
                "2\t# runs",
                "1",
                16,
                r#""teeth.mco b" follows the last run, but line 2 of the data says 1 runs"#,
            ),
            (
                "skin.mco\tA",
                "skin.mco",
                6,
                "run 1: the line has 1 value, but must have 2: the output's name and format",
            ),
            ("skin.mco\tA", "skin.mco C", 6, r#"run 1: the output's format is "C", but must be A or B"#),
            ("teeth.mco", "skin.mco", 16, r#"the output "skin.mco" is also that of the run in line 6"#),
            (
                "1000",
                "-5",
                7,
                "run 1: the number of photons is -5, but must be a whole number from 1 to 1000000000000000",
            ),
            (
                "1000",
                "1.5",
                7,
                "run 1: the number of photons is 1.5, but must be a whole number from 1 to 1000000000000000",
            ),
            ("20E-4 ", "0 ", 8, "run 1: dz is 0, but must be in [1e-12, 1e12]"),
            ("20E-4 ", "NaN ", 8, "run 1: dz is NaN, but must be in [1e-12, 1e12]"),
            ("20E-4 ", "x ", 8, "run 1: dz is x, but must be in [1e-12, 1e12]"),
            (
                "10 20 30",
                "10 1000000000 30",
                9,
                "run 1: the number of dr is 1000000000, but must be a whole number from 1 to 4000000",
            ),
            (
                "10 20 30",
                "4e6 4e6 1",
                9,
                "run 1: the grid has 16000008000000 cells, nr (nz + 2 na), but must have at most 4000000",
            ),
            (
                "10 20 30\n2",
                "10 20 30\n1",
                14,
                "run 1: the line has 5 values, but must have 1: n of the medium below",
            ),
            (
                "10 20 30\n2",
                "10 20 30\n3",
                15,
                "run 1: the line has 1 value, but must have 5: n, mua, mus, g and d of layer 3",
            ),
            ("0.7 0.01", "0.7 0", 13, "run 1: d of layer 1 is 0, but must be in [1e-12, 1e12]"),
            ("0.7 0.01", "0.7 -1", 13, "run 1: d of layer 1 is -1, but must be in [1e-12, 1e12]"),
            ("0.7 0.01", "1 0.01", 13, "run 1: g of layer 1 is 1, but must be in (-1, 1)"),
            ("1.3 20", "0 20", 13, "run 1: n of layer 1 is 0, but must be in [0.1, 10]"),
            ("1.3 20", "1.3 inf", 13, "run 1: mua of layer 1 is inf, but must be 0 or in [1e-12, 1e12]"),
        ];
        for (from, to, line, message) in cases {
            assert!(TWO_RUNS.contains(from), "{from}");
            let error = parse_mci(TWO_RUNS.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert_eq!((error.message.as_str(), error.line), (message, Some(line)), "{from:?} → {to:?}");
        }
        for (text, line) in [("", 1), ("# nothing\n\n", 2), ("1.0\n", 1)] {
            assert_eq!(parse_mci(text.as_bytes()).unwrap_err().line, Some(line), "{text:?}");
        }
    }
}
