//! Differences between several pictures of one scene: numbers, maps, a sheet and a page.

use translucid_laboratory::picture::{
    FlipMap, Picture, Raster, Sheet, SheetColumn, difference_color, flip_color, relative_difference,
    relative_mse, relative_noise, relative_noise_of_difference,
};
use translucid_laboratory::{Block, Cell, DataTable, Page, Plate, Section};

use super::files::{ERRORS, PAGE, SHEET, TITLE, map_names};
use crate::failure::Failure;
use crate::files::NamedFile;
use crate::progress::duration;

/// The picture with one model, and what it took.
pub(super) struct Entry {
    /// Name of the model.
    pub(super) model: String,
    pub(super) picture: Picture,
    /// The picture after the first of all samples, and the numbers of both.
    pub(super) first_half: Option<(Picture, [u32; 2])>,
    /// Samples per pixel.
    pub(super) samples: u32,
    /// Time spent rendering \[s\].
    pub(super) seconds: f64,
    /// CPU time of all threads \[s\].
    pub(super) cpu_seconds: Option<f64>,
    /// Whether it has the samples that it was to have.
    pub(super) is_finished: bool,
}

/// Pictures of one scene with different models.
pub(super) struct Report {
    /// Name of the scene.
    pub(super) scene: String,
    /// One for each model.
    pub(super) entries: Vec<Entry>,
    /// Index of the one that the others are compared with.
    pub(super) judge: usize,
}

/// How far a picture is from the judge.
struct Distance {
    relative_mse: f64,
    /// The part of it that is noise; not a number where that is not known.
    noise: f64,
    flip: FlipMap,
    /// Relative difference of luminance.
    difference: Vec<f32>,
}

impl Report {
    /// All files, the page first.
    pub(super) fn files(&self) -> Result<Vec<NamedFile>, Failure> {
        let distances: Vec<Distance> =
            self.entries.iter().map(|entry| self.distance(entry)).collect::<Result<_, _>>()?;
        let work = |error: std::io::Error| Failure::work(format!("cannot draw a picture: {error}"));
        let mut rasters = Vec::new();
        let mut files = Vec::new();
        for (entry, distance) in self.entries.iter().zip(&distances) {
            let maps = self.maps(entry, distance);
            for (name, map) in map_names(&entry.model).into_iter().zip(&maps) {
                files.push((name, map.png().map_err(work)?));
            }
            rasters.push(maps);
        }
        let table = self.table(&distances);
        let pictures: Vec<Raster> = self.entries.iter().map(|entry| shown(&entry.picture)).collect();
        let plates = self.plates(&pictures, &files, &distances)?;
        let sheet = self.sheet(pictures, rasters, &distances);
        files.push((SHEET.to_owned(), sheet.svg().map_err(work)?.into_bytes()));
        files.push((ERRORS.to_owned(), table.csv().into_bytes()));
        files.insert(0, (PAGE.to_owned(), self.page(table, plates).html().into_bytes()));
        Ok(files)
    }

    fn judge(&self) -> &Entry {
        &self.entries[self.judge]
    }

    fn distance(&self, entry: &Entry) -> Result<Distance, Failure> {
        let judge = self.judge();
        let flip = FlipMap::new(&entry.picture, &judge.picture);
        Ok(Distance {
            relative_mse: relative_mse(&entry.picture, &judge.picture),
            noise: self.noise(entry),
            flip: flip.map_err(|error| Failure::work(format!("cannot compare the pictures: {error}")))?,
            difference: relative_difference(&entry.picture, &judge.picture),
        })
    }

    /// The part of the error that is noise, for the judge its own; not a number where it is not known.
    fn noise(&self, entry: &Entry) -> f64 {
        let judge = self.judge();
        match (&entry.first_half, &judge.first_half) {
            (Some((half, samples)), _) if entry.model == judge.model => {
                relative_noise([&entry.picture, half], *samples, &judge.picture)
            }
            (Some((half, samples)), Some((judge_half, judge_samples))) if samples == judge_samples => {
                let reference = [&judge.picture, judge_half];
                relative_noise_of_difference([&entry.picture, half], reference, *samples)
            }
            _ => f64::NAN,
        }
    }

    fn maps(&self, entry: &Entry, distance: &Distance) -> [Raster; 2] {
        let [width, height] = [entry.picture.width(), entry.picture.height()];
        [
            Raster::of_map(width, height, distance.flip.values(), flip_color),
            Raster::of_map(width, height, &distance.difference, difference_color),
        ]
    }

    /// The numbers, with the columns that scripts depend on.
    fn table(&self, distances: &[Distance]) -> DataTable {
        let columns = [
            "model",
            "against",
            "samples",
            "seconds",
            "cpu_seconds",
            "relative_mse",
            "noise",
            "mean_flip",
            "max_flip",
        ];
        let mut table = DataTable::new("errors", "Errors and times", &columns);
        for (entry, distance) in self.entries.iter().zip(distances) {
            table.push([
                Cell::from(entry.model.as_str()),
                Cell::from(self.judge().model.as_str()),
                Cell::from(f64::from(entry.samples)),
                Cell::from(entry.seconds),
                Cell::from(entry.cpu_seconds.unwrap_or(f64::NAN)),
                Cell::from(distance.relative_mse),
                Cell::from(distance.noise),
                Cell::from(distance.flip.mean()),
                Cell::from(distance.flip.max()),
            ]);
        }
        table
    }

    /// The sheet of all pictures and maps.
    fn sheet(&self, pictures: Vec<Raster>, maps: Vec<[Raster; 2]>, distances: &[Distance]) -> Sheet {
        let columns = self.entries.iter().zip(pictures).zip(maps).zip(distances);
        let columns = columns.map(|(((entry, picture), maps), distance)| {
            let is_judge = entry.model == self.judge().model;
            SheetColumn {
                name: entry.model.clone(),
                lines: vec![self.times(entry), self.errors(entry, distance)],
                picture,
                maps: (!is_judge).then_some(maps),
            }
        });
        Sheet {
            title: self.title(),
            subtitle: self.subtitle(),
            judge: self.judge().model.clone(),
            columns: columns.collect(),
        }
    }

    fn title(&self) -> String {
        format!("{TITLE}: {}", self.scene)
    }

    fn subtitle(&self) -> String {
        let [width, height] = [self.judge().picture.width(), self.judge().picture.height()];
        format!(
            "{width}×{height} pixels, the same random numbers for all; the judge is {}",
            self.judge().model
        )
    }

    /// Samples and time of a picture, for readers.
    fn times(&self, entry: &Entry) -> String {
        let time = match entry.cpu_seconds {
            Some(cpu_seconds) => format!("{} of CPU", duration(cpu_seconds)),
            None => duration(entry.seconds),
        };
        format!("{} samples, {time}", entry.samples)
    }

    /// Errors of a picture, for readers.
    fn errors(&self, entry: &Entry, distance: &Distance) -> String {
        if entry.model == self.judge().model {
            return String::from("the judge");
        }
        format!("relMSE {}, mean ꟻLIP {:.4}", significant(distance.relative_mse), distance.flip.mean())
    }

    /// Pictures, ꟻLIP maps and differences for the page; the maps are among the files already.
    fn plates(
        &self,
        pictures: &[Raster],
        maps: &[NamedFile],
        distances: &[Distance],
    ) -> Result<[Vec<Plate>; 3], Failure> {
        let mut plates = [Vec::new(), Vec::new(), Vec::new()];
        let judge = &self.judge().model;
        for (index, (entry, distance)) in self.entries.iter().zip(distances).enumerate() {
            let model = &entry.model;
            let size = [entry.picture.width(), entry.picture.height()];
            let plate = |file: String, alternative: String, caption: String, png: Vec<u8>| Plate {
                file,
                alternative,
                caption,
                size,
                png,
            };
            let png = pictures[index].png();
            plates[0].push(plate(
                format!("{model}.png"),
                format!("The scene rendered with {model}"),
                format!("{model}: {}; {}.", self.times(entry), self.errors(entry, distance)),
                png.map_err(|error| Failure::work(format!("cannot draw a picture: {error}")))?,
            ));
            if index != self.judge {
                let kinds = ["ꟻLIP error", "Difference of luminance"];
                for (i, kind) in kinds.into_iter().enumerate() {
                    let (name, png) = &maps[2 * index + i];
                    let words = format!("{kind} of {model} against {judge}");
                    plates[1 + i].push(plate(name.clone(), words.clone(), format!("{words}."), png.clone()));
                }
            }
        }
        Ok(plates)
    }

    /// The page that shows and explains everything.
    fn page(&self, table: DataTable, [pictures, flips, differences]: [Vec<Plate>; 3]) -> Page {
        let judge = &self.judge().model;
        let text = |words: &str| Block::Text(words.to_owned());
        let section = |title: &str, blocks: Vec<Block>| Section { title: title.to_owned(), blocks };
        let sections = vec![
            section("The pictures", vec![Block::Plates(pictures)]),
            section(
                "What a viewer sees",
                vec![
                    text(
                        "ꟻLIP estimates the difference that a person sees who flips back and forth between two \
                         pictures on a display with 67 pixels for a degree of the field of view, from 0 (black, no \
                         difference) to 1 (nearly white) [P. Andersson and others, ꟻLIP: A Difference Evaluator for \
                         Alternating Images, 2020].",
                    ),
                    Block::Plates(flips),
                ],
            ),
            section(
                "Darker and brighter",
                vec![
                    Block::Text(format!(
                        "Luminance against {judge}: (Y − Y_ref) / √(Y_ref² + 0.01), from −50 % (blue) over none \
                         (white) to +50 % (orange)."
                    )),
                    Block::Plates(differences),
                ],
            ),
            section("Errors and times", vec![self.explanation(), Block::Table(table)]),
        ];
        Page { title: self.title(), introduction: vec![self.subtitle() + "."], sections }
    }

    fn explanation(&self) -> Block {
        Block::Text(String::from(
            "relative_mse is the mean of (x − ref)² / (ref² + 0.01) over all channels of all pixels that are not \
             background. noise is how much of it is noise (for the judge, that of its own picture), estimated from \
             how much the difference of the pictures changes from the first half of their samples to all: rather \
             too much, since samples are spread more evenly than by chance. Where relative_mse is not well above \
             it, a difference between models says nothing; relative_mse less noise is what the models differ by. \
             seconds are those of \
             the rendering itself; cpu_seconds, over all threads, are missing where an earlier run had a part in it.",
        ))
    }
}

/// A picture as a display shows it.
fn shown(picture: &Picture) -> Raster {
    Raster::new(picture.width(), picture.height(), picture.display().to_vec())
}

/// A number to three significant digits.
fn significant(number: f64) -> String {
    match number {
        0.0 => String::from("0"),
        n if n < 1e-3 => format!("{n:.1e}"),
        n => {
            let digits = (2.0 - n.log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{n:.digits$}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_has_three_digits() {
        for (number, text) in
            [(0.0, "0"), (1e-5, "1.0e-5"), (0.012345, "0.0123"), (1.5, "1.50"), (1234.5, "1234")]
        {
            assert_eq!(significant(number), text);
        }
    }
}
