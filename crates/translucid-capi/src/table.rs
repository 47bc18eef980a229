//! Tables over the surface albedo, for textures: one profile after another, each with numbers of its own.

use std::ffi::c_char;
use std::io;
use std::path::Path;
use std::sync::Arc;

use translucid_profile::{AlbedoTable, Appearance, InputError, ProfileRow, ProfileView, parse_profile_rows};

use crate::ffi_guard::{Caller, Kind, Rule, enter, room};
use crate::profile::{Described, RADII, SHARES, TranslucidAppearance, TranslucidProfile};
use crate::status::{Failure, TranslucidStatus};

/// Profiles of all surface albedos as a table, which is evaluated and sampled in constant time.
///
/// It never changes, so any number of threads may use it at once.
pub struct TranslucidTable {
    _opaque: [u8; 0],
}

impl Kind for TranslucidTable {
    type Value = Arc<AlbedoTable>;
    const TAG: [u8; 8] = *b"tl-table";
    const NAME: &'static str = "TranslucidTable";
}

const ALBEDOS: Rule = Rule { name: "surface_albedos", allowed: "in [0, 1]", least: 0.0, most: 1.0 };
const LENGTHS: Rule = Rule { name: "lengths", allowed: "in [1e-150, 1e150]", least: 1e-150, most: 1e150 };

/// Makes the table of a model, which is as in translucid_profile_new.
///
/// The appearance counts but for its surface albedo and the length: where mfp is not 0, lengths of the table's
/// profiles are mean free paths, and where dmfp is not 0 diffuse ones. Between albedos the cdf is off by less than
/// 3e-4; the most that the model reaches stands in for albedos above it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_table_new(
    model: *const c_char,
    appearance: *const TranslucidAppearance,
    table: *mut *mut TranslucidTable,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("table", table)?;
        let described = Described::read(caller, model, appearance)?;
        let made = AlbedoTable::for_every_albedo(|surface_albedo| {
            let appearance = Appearance { surface_albedo, length: 1.0, ..described.appearance };
            described.profile(&appearance)
        });
        slot.put_handle(Arc::new(made.map_err(Failure::argument)?));
        Ok(())
    })
}

/// Makes a table of samples: a row of reflectances at the same radii for each of the surface albedos, which rise.
///
/// Radii are multiples of the profiles' length, at least four, greater than 0, rising. The rows lie one after the other;
/// so do energies within the radii where they are known, else enclosed is NULL. Of the rows only the shape counts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_table_from_samples(
    surface_albedos: *const f64,
    row_count: usize,
    radii: *const f64,
    radius_count: usize,
    reflectances: *const f64,
    enclosed: *const f64,
    table: *mut *mut TranslucidTable,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("table", table)?;
        let albedos = caller.input(ALBEDOS.name, surface_albedos, row_count)?.to_vec()?;
        let radii = caller.input("radii", radii, radius_count)?.to_vec()?;
        let count = row_count.checked_mul(radius_count).ok_or_else(|| {
            Failure::argument(format_args!(
                "{row_count} rows of {radius_count} radii are more than memory holds"
            ))
        })?;
        let reflectances = caller.input("reflectances", reflectances, count)?.to_vec()?;
        let enclosed_count = if enclosed.is_null() { 0 } else { count };
        let enclosed = caller.input("enclosed", enclosed, enclosed_count)?.to_vec()?;
        let mut rows = room(row_count)?;
        for (i, &surface_albedo) in albedos.iter().enumerate() {
            let part = i * radius_count..(i + 1) * radius_count;
            rows.push(ProfileRow {
                surface_albedo: Some(surface_albedo),
                radii: radii.clone(),
                reflectances: reflectances[part.clone()].to_vec(),
                enclosed: enclosed.get(part).map_or(Vec::new(), <[f64]>::to_vec),
            });
        }
        let made = AlbedoTable::from_profile_rows(&rows);
        slot.put_handle(Arc::new(made.map_err(Failure::argument)?));
        Ok(())
    })
}

/// Makes a table of a CSV file with the columns r and reflectance, optionally enclosed and surface_albedo, such as
/// "translucid reference" prints.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_table_load(
    path: *const c_char,
    table: *mut *mut TranslucidTable,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("table", table)?;
        let path = Path::new(caller.text("path", path)?);
        // A pipe would keep the reader waiting
        let found = std::fs::metadata(path).and_then(|found| match found.is_file() {
            true => std::fs::read(path),
            false => Err(io::Error::other("not a file")),
        });
        let bytes = found.map_err(|error| {
            let message = format!("cannot read {}: {error}", path.display());
            Failure::new(TranslucidStatus::FileError, message)
        })?;
        let made = parse_profile_rows(&bytes).and_then(|rows| AlbedoTable::from_profile_rows(&rows));
        slot.put_handle(Arc::new(made.map_err(|error| in_file(path, &error))?));
        Ok(())
    })
}

/// The failure of a file whose content is not what it must be.
fn in_file(path: &Path, error: &InputError) -> Failure {
    let line = error.line.map_or(String::new(), |line| format!(":{line}"));
    Failure::argument(format_args!("{}{line}: {error}", path.display()))
}

/// Frees a table; profiles made of it stay. NULL is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_table_free(table: *mut TranslucidTable) -> TranslucidStatus {
    enter!(|caller| caller.free("table", table))
}

/// Makes the profile of a surface albedo in [0, 1] and a length in [1e-150, 1e150].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_table_profile(
    table: *const TranslucidTable,
    surface_albedo: f64,
    length: f64,
    profile: *mut *mut TranslucidProfile,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("profile", profile)?;
        let table = caller.handle("table", table)?;
        Rule { name: "surface_albedo", ..ALBEDOS }.require(surface_albedo)?;
        Rule { name: "length", ..LENGTHS }.require(length)?;
        slot.put_handle(Arc::new(AlbedoTable::profile_of_shared(table, surface_albedo, length)));
        Ok(())
    })
}

/// Gives R(r), each for a surface albedo, a length and a radius of its own.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_table_eval(
    table: *const TranslucidTable,
    surface_albedos: *const f64,
    lengths: *const f64,
    r: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, table, [surface_albedos, lengths, r], count, out, &RADII, |view, r| view
        .eval(r)))
}

/// Gives the probability density of radii per length, each for a surface albedo, a length and a radius of its own.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_table_pdf(
    table: *const TranslucidTable,
    surface_albedos: *const f64,
    lengths: *const f64,
    r: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, table, [surface_albedos, lengths, r], count, out, &RADII, |view, r| view
        .pdf(r)))
}

/// Gives a radius of that density, each for a surface albedo, a length and a random number u of its own, uniform on
/// [0, 1).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_table_sample(
    table: *const TranslucidTable,
    surface_albedos: *const f64,
    lengths: *const f64,
    u: *const f64,
    count: usize,
    out: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| apply(caller, table, [surface_albedos, lengths, u], count, out, &SHARES, |view, u| view
        .sample(u)))
}

fn apply(
    caller: &Caller,
    table: *const TranslucidTable,
    [surface_albedos, lengths, x]: [*const f64; 3],
    count: usize,
    out: *mut f64,
    rule: &Rule,
    f: impl Fn(ProfileView<'_>, f64) -> f64,
) -> Result<(), Failure> {
    let table = caller.handle("table", table)?;
    let input = |rule: &Rule, start| {
        let input = caller.input(rule.name, start, count)?;
        input.require(rule)?;
        Ok(input)
    };
    let (albedos, lengths, x) =
        (input(&ALBEDOS, surface_albedos)?, input(&LENGTHS, lengths)?, input(rule, x)?);
    let out = caller.output("out", out, count)?;
    x.map(&out, |start, from, to| {
        let (albedos, lengths) = (albedos.chunk(start, from.len()), lengths.chunk(start, from.len()));
        for (i, to) in to.iter_mut().enumerate() {
            *to = f(table.at(albedos[i], lengths[i]), from[i]);
        }
    });
    Ok(())
}
