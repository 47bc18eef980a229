//! Tables of reflectance profiles as text: comma-separated values with a header.
//!
//! Columns `r` and `reflectance`, optionally `surface_albedo` and `enclosed`; others are ignored, so that what
//! `translucid reference` prints can be read back.

use super::profile_rows::{ALBEDO, ENERGY, FEWEST_RADII, MOST_PROFILES, ProfileRow, RADIUS, Range};
use crate::error::InputError;

/// Most rows of a text: a profile has some hundred radii.
const MOST_LINES: usize = 1_000_000;

/// Reads reflectance profiles from the bytes of a table of comma-separated values, in the order of their surface albedos.
///
/// The columns are `r` and `reflectance`, optionally `surface_albedo` and `enclosed`; others, empty lines and lines that
/// begin with `#` are ignored.
///
/// # Errors
/// A column is missing, or a number is not what it must be; the error has the line.
pub fn parse_profile_rows(bytes: &[u8]) -> Result<Vec<ProfileRow>, InputError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
        InputError::at_line(line, "a table must be UTF-8 text, but this is not")
    })?;
    let mut records = Records { rest: text.strip_prefix('\u{feff}').unwrap_or(text), line: 1 };
    let (line, header) = records.next().unwrap_or((1, Vec::new()));
    let places = find_columns(&header, line)?;
    let mut rows: Vec<ProfileRow> = Vec::new();
    for (count, (line, record)) in records.enumerate() {
        if count >= MOST_LINES {
            return Err(InputError::at_line(line, format!("more than {MOST_LINES} lines")));
        }
        if record.len() != header.len() {
            let (found, expected) = (record.len(), header.len());
            let message = format!("the line has {found} values, but the header names {expected} columns");
            return Err(InputError::at_line(line, message));
        }
        add(&mut rows, &places, &record, line)?;
    }
    check(&mut rows)?;
    Ok(rows)
}

/// The lines of a text, each as its number, from 1, and its fields without the spaces around them.
struct Records<'a> {
    rest: &'a str,
    line: usize,
}

impl Iterator for Records<'_> {
    type Item = (usize, Vec<String>);

    fn next(&mut self) -> Option<Self::Item> {
        while self.rest.starts_with(['\n', '\r', '#']) {
            self.take_until(&['\n', '\r']);
            self.end_line();
        }
        if self.rest.is_empty() {
            return None;
        }
        let line = self.line;
        let mut fields = Vec::new();
        loop {
            fields.push(self.field());
            match self.rest.strip_prefix(',') {
                Some(rest) => self.rest = rest,
                None => break,
            }
        }
        self.end_line();
        Some((line, fields))
    }
}

impl<'a> Records<'a> {
    fn take_until(&mut self, ends: &[char]) -> &'a str {
        let (taken, rest) = self.rest.split_at(self.rest.find(ends).unwrap_or(self.rest.len()));
        self.rest = rest;
        taken
    }

    fn end_line(&mut self) {
        for end in ["\r\n", "\n", "\r"] {
            if let Some(rest) = self.rest.strip_prefix(end) {
                self.rest = rest;
                self.line += 1;
                return;
            }
        }
    }

    /// A field, within whose quotes there may be commas, ends of lines and, doubled, quotes.
    fn field(&mut self) -> String {
        let mut text = String::new();
        if let Some(mut rest) = self.rest.strip_prefix('"') {
            loop {
                self.rest = rest;
                let part = self.take_until(&['"']);
                self.line += part.matches('\n').count();
                text += part;
                self.rest = self.rest.strip_prefix('"').unwrap_or_default();
                match self.rest.strip_prefix('"') {
                    Some(behind) => rest = behind,
                    None => break,
                }
                text.push('"');
            }
        }
        text += self.take_until(&[',', '\n', '\r']);
        text.trim().to_owned()
    }
}

/// Columns that are read and the ranges of their numbers; the first two must be there.
const COLUMNS: [(&str, Range); 4] =
    [("r", RADIUS), ("reflectance", ENERGY), ("surface_albedo", ALBEDO), ("enclosed", ENERGY)];

/// Places of the [`COLUMNS`].
type Places = [Option<usize>; 4];

fn find_columns(header: &[String], line: usize) -> Result<Places, InputError> {
    let fail = |message: String| {
        InputError::at_line(line, message).with_help(
            "a profile's columns are r,reflectance and optionally surface_albedo and enclosed, separated by commas",
        )
    };
    let mut places = [None; 4];
    for (number, (name, _)) in COLUMNS.iter().enumerate() {
        let mut found = (0..header.len()).filter(|&i| header[i].eq_ignore_ascii_case(name));
        places[number] = found.next();
        if found.next().is_some() {
            return Err(fail(format!("there are two columns \"{name}\"")));
        }
        if number < 2 && places[number].is_none() {
            let found = header.join(", ");
            return Err(fail(format!("there is no column \"{name}\"; the first line has \"{found}\"")));
        }
    }
    Ok(places)
}

/// Adds a line to the row of its surface albedo.
fn add(
    rows: &mut Vec<ProfileRow>,
    places: &Places,
    record: &[String],
    line: usize,
) -> Result<(), InputError> {
    let fail = |message: String| InputError::at_line(line, message);
    let mut numbers = [None; 4];
    for (number, (&place, (name, range))) in numbers.iter_mut().zip(places.iter().zip(COLUMNS)) {
        let Some(text) = place.and_then(|place| record.get(place)) else { continue };
        let value: Option<f64> = text.parse().ok();
        let value = value.ok_or_else(|| fail(format!("{name} is \"{text}\", but must be a number")))?;
        if !range.contains(value) {
            return Err(fail(format!("{name} is {value}, but must be in {}", range.text)));
        }
        *number = Some(value);
    }
    let [r, reflectance, surface_albedo, enclosed] = numbers;
    let (r, reflectance) = (r.unwrap_or_default(), reflectance.unwrap_or_default());
    let known = rows.iter().position(|row| row.surface_albedo == surface_albedo);
    if known.is_none() && rows.len() == MOST_PROFILES {
        return Err(fail(format!("more than {MOST_PROFILES} surface albedos")));
    }
    let index = known.unwrap_or_else(|| {
        let row = ProfileRow { surface_albedo, ..ProfileRow::default() };
        rows.push(row);
        rows.len() - 1
    });
    let row = &mut rows[index];
    if let Some(&before) = row.radii.last().filter(|&&before| before >= r) {
        return Err(fail(format!("r is {r}, but must be greater than {before}, the one before")));
    }
    if let (Some(energy), Some(&before)) = (enclosed, row.enclosed.last())
        && energy < before
    {
        return Err(fail(format!("enclosed is {energy}, but must be at least {before}, the one before")));
    }
    row.enclosed.extend(enclosed);
    row.radii.push(r);
    row.reflectances.push(reflectance);
    Ok(())
}

/// Sorts the rows and refuses those that are no profile.
fn check(rows: &mut [ProfileRow]) -> Result<(), InputError> {
    let fail = |message: String| Err(InputError::new(message));
    if rows.is_empty() {
        return fail(String::from("the table has no lines after its header"));
    }
    for row in rows.iter() {
        let of = row.surface_albedo.map_or(String::new(), |a| format!(" of surface_albedo {a}"));
        if row.radii.len() < FEWEST_RADII {
            let count = row.radii.len();
            return fail(format!("the profile{of} has {count} radii, but needs at least {FEWEST_RADII}"));
        }
        if row.reflectances.iter().all(|&reflectance| reflectance == 0.0) {
            return fail(format!("the profile{of} is 0 everywhere"));
        }
    }
    let key = |row: &ProfileRow| row.surface_albedo.unwrap_or(0.0);
    rows.sort_by(|a, b| key(a).total_cmp(&key(b)));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AlbedoTable;

    fn parse(text: &str) -> Result<Vec<ProfileRow>, InputError> {
        let rows = parse_profile_rows(text.as_bytes())?;
        AlbedoTable::from_profile_rows(&rows)?;
        Ok(rows)
    }

    fn table(rows: &[ProfileRow]) -> AlbedoTable {
        AlbedoTable::from_profile_rows(rows).unwrap()
    }

    fn refuse(text: &str, expected: &str) {
        let error = parse(text).unwrap_err();
        let found = error.line.map_or(String::new(), |line| format!("{line}: ")) + &error.to_string();
        assert!(found.contains(expected), "{found}");
    }

    #[test]
    fn table_takes_the_columns_it_knows() {
        let rows =
            parse("r,error,Reflectance\n0.1,0,3\n# noise\n 0.2 ,0,2\n0.4,0,1e-1\n1,0,0.01\n2,0,0\n").unwrap();
        let row = ProfileRow {
            surface_albedo: None,
            radii: vec![0.1, 0.2, 0.4, 1.0, 2.0],
            reflectances: vec![3.0, 2.0, 0.1, 0.01, 0.0],
            enclosed: Vec::new(),
        };
        assert_eq!(rows, [row]);
    }

    /// R = e^−r/r with noise of 20 %, but energies without: the table has their shares, 1 − e^−r.
    #[test]
    fn table_keeps_energies() {
        let line = |i: i32| {
            let r = 0.05 * 1.12_f64.powi(i);
            let noise = if i % 2 == 0 { 1.2 } else { 0.8 };
            format!("{r},{},{}\n", noise * (-r).exp() / r, -2.0 * std::f64::consts::PI * (-r).exp_m1())
        };
        let text = format!("r,reflectance,enclosed\n{}", (0..50).map(line).collect::<String>());
        let table = table(&parse(&text).unwrap());
        for i in 0..50 {
            let r = 0.05 * 1.12_f64.powi(i);
            let share = table.at(0.8, 1.0).cdf(r);
            assert!((share + (-r).exp_m1()).abs() < 1e-4, "{r}: {share}");
        }
    }

    #[test]
    fn table_is_read_as_other_programs_write_it() {
        let plain = "r,reflectance\n0.1,5\n1,1\n2,0.4\n4,0.05\n";
        let expected = parse(plain).unwrap();
        assert_eq!(parse(&format!("\u{feff}{}", plain.replace('\n', "\r\n"))).unwrap(), expected);
        assert_eq!(parse("\"r\",\"reflectance\"\n\n0.1,5\n1,1\n2,0.4\n4,0.05").unwrap(), expected);
        let quoted = "r,by,reflectance\r.1,\"a, \"\"b\"\",\n\",5\r1,\"\",1\r2,,0.4\r\"4\",\"c\"d,\" 0.05\"";
        assert_eq!(parse(quoted).unwrap(), expected);
        refuse("r,by,reflectance\n1,\"\n\n\",1\n# 1\n\n1,1\n", "7: the line has 2 values");
    }

    #[test]
    fn table_may_span_all_radii() {
        for text in [
            "r,reflectance\n1e-100,1\n1e-99,1\n1e99,1e-200\n1e100,0\n",
            "r,reflectance\n1e-100,1\n1e-99,1\n1e99,1e-200\n1e100,1e-290\n",
            "r,reflectance\n1e-100,1e200\n2e-100,1e199\n3e-100,1e198\n4e-100,1e197\n",
            "r,reflectance\n1e99,1e-300\n2e99,1e-301\n3e99,1e-302\n4e99,1e-303\n",
        ] {
            let Ok(rows) = parse(text) else { continue };
            let table = table(&rows);
            let view = table.at(0.5, 1.0);
            for i in -1100..=1100 {
                let r = 10.0_f64.powf(0.1 * f64::from(i));
                let (density, within) = (view.eval(r), view.enclosed(r));
                assert!(density >= 0.0 && density.is_finite(), "{text} {r}: {density}");
                assert!((0.0..=0.5 * (1.0 + 1e-12)).contains(&within), "{text} {r}: {within}");
            }
        }
    }

    /// Changed, lost and repeated bytes: a table or an error, and a table can be evaluated and sampled.
    #[test]
    fn table_survives_any_change_of_its_bytes() {
        let seed =
            b"surface_albedo,r,reflectance\n0.2,1e-1,5\n0.2,1,1\n0.2,2,0.4\n0.2,4,.05\n0.8,1,1\n0.8,2,.5\n\
                     0.8,3,0.3\n0.8,9,1e-4\n";
        let letters = b"0123456789eE+-.,\n\r\"#; naif\xff";
        let mut state = 7_u64;
        let mut random = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) as usize) % n
        };
        let mut accepted = 0;
        for _ in 0..3000 {
            let mut bytes = seed.to_vec();
            for _ in 0..=random(3) {
                let (at, letter) = (random(bytes.len()), letters[random(letters.len())]);
                match random(4) {
                    0 => bytes[at] = letter,
                    1 => bytes.insert(at, letter),
                    2 => drop(bytes.remove(at)),
                    _ => bytes.extend_from_within(at..),
                }
            }
            let Ok(rows) = parse_profile_rows(&bytes) else { continue };
            let Ok(table) = AlbedoTable::from_profile_rows(&rows) else { continue };
            accepted += 1;
            for (a, u) in [(0.0, 0.0), (0.2, 0.3), (0.5, 0.7), (1.0, 1.0)] {
                let view = table.at(a, 1.0);
                let r = view.sample(u);
                let values = [r, view.eval(r), view.enclosed(r), view.pdf(r)];
                assert!(values.iter().all(|x| x.is_finite() && *x >= 0.0), "{values:?} of {bytes:?}");
            }
        }
        assert!(accepted > 50, "{accepted}");
    }

    #[test]
    fn table_sorts_profiles_by_albedo() {
        let lines = |a: &str| (1..=4).map(|r| format!("{a},{r},1e-{r}\n")).collect::<String>();
        let text = format!("surface_albedo,r,reflectance\n{}{}", lines("0.8"), lines("0.2"));
        let albedos: Vec<_> = parse(&text).unwrap().iter().map(|row| row.surface_albedo).collect();
        assert_eq!(albedos, [Some(0.2), Some(0.8)]);
    }

    #[test]
    fn table_says_what_is_wrong_and_where() {
        refuse("", "there is no column \"r\"");
        refuse(
            "radius,reflectance\n1,1\n",
            "there is no column \"r\"; the first line has \"radius, reflectance\"",
        );
        refuse("r;reflectance\n1;1\n", "there is no column \"r\"; the first line has \"r;reflectance\"");
        refuse("r,R,reflectance\n1,1,1\n", "there are two columns \"r\"");
        refuse("r,reflectance\n", "no lines");
        refuse("r,reflectance\n1,x\n", "2: reflectance is \"x\", but must be a number");
        refuse("r,reflectance\n1\n", "2: the line has 1 values");
        refuse("r,reflectance\n0,1\n", "2: r is 0, but must be in [1e-100, 1e100]");
        refuse("r,reflectance\n1,1\n1,1\n", "3: r is 1, but must be greater than 1");
        refuse("r,reflectance\n1,-1\n", "reflectance is -1");
        refuse("r,reflectance\n1,nan\n", "reflectance is NaN");
        refuse("r,reflectance\n1,1\n2,1\n3,1\n", "has 3 radii, but needs at least 4");
        refuse("r,reflectance\n1,0\n2,0\n3,0\n4,0\n", "is 0 everywhere");
        refuse("r,reflectance,surface_albedo\n1,1,1.5\n", "surface_albedo is 1.5");
        refuse("r,reflectance,enclosed\n1,1,-1\n", "2: enclosed is -1");
        refuse("r,reflectance,enclosed\n1,1,0.5\n2,1,0.4\n", "3: enclosed is 0.4, but must be at least 0.5");
        refuse(
            "surface_albedo,r,reflectance\n0.3,1,1\n0.3,2,2\n0.3,3,9\n0.3,4,27\n",
            "the profile of surface_albedo 0.3: ",
        );
        let many: String = (0..=MOST_PROFILES).map(|i| format!("{},1,1\n", 1e-4 * i as f64)).collect();
        refuse(&format!("surface_albedo,r,reflectance\n{many}"), "1002: more than 1000 surface albedos");
        let error = parse_profile_rows(b"r,reflectance\n1,\xff\n").unwrap_err();
        assert!(error.message.contains("UTF-8") && error.line == Some(2), "{error}");
    }
}
