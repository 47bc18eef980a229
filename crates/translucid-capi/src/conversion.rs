//! A material in the numbers of other systems.

use std::ffi::{CString, c_char};

use translucid_profile::Configuration;
use translucid_profile::convention::{
    ArgumentNames, Conversion, ConvertedNumber, Setting, Unit, conversion_system_names,
};

use crate::ffi_guard::{Caller, Kind, enter, room};
use crate::names::{self, Names};
use crate::status::{Failure, TranslucidStatus};

/// A parameter of a system.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TranslucidSetting {
    /// One of translucid_system_name.
    pub system: *const c_char,
    /// The parameter's name in the system; case, spaces and underscores do not matter.
    pub parameter: *const c_char,
    /// One number, or three for red, green and blue.
    pub values: [f64; 3],
    /// How many numbers, 1 or 3.
    pub count: usize,
}

/// A material in the numbers of one system, to be said in those of others. A field that is 0 or NULL has its default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TranslucidConversion {
    /// Parameters of the system that the material comes from.
    pub from: *const TranslucidSetting,
    /// Number of those parameters.
    pub from_count: usize,
    /// Surface albedo as one enters it in the source system, in [0, 1].
    pub surface_albedo: [f64; 3],
    /// How many numbers, 1 or 3; 0 for a system whose coefficients determine it.
    pub surface_albedo_count: usize,
    /// Unit of lengths in the scene that the material comes from, "mm", the default, "cm" or "m", for systems without a
    /// unit of their own.
    pub unit: *const c_char,
    /// Unit of lengths in the scene that it goes to; by default the same.
    pub to_unit: *const c_char,
    /// Systems that it goes to; by default all.
    pub to: *const *const c_char,
    /// Number of those systems.
    pub to_count: usize,
    /// Factors and distances of those systems that are to have a value.
    pub set: *const TranslucidSetting,
    /// Number of those.
    pub set_count: usize,
    /// How light enters in the fit between the width of a profile and the mean free path: "searchlight", or "diffuse",
    /// which is the default.
    pub configuration: *const c_char,
}

/// A number of a material. Texts last as long as the TranslucidConverted that they come from.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TranslucidConvertedNumber {
    /// Name of the system.
    pub system: *const c_char,
    /// Name of the parameter in the system.
    pub parameter: *const c_char,
    /// "r", "g" or "b", or "all" for what is one for all.
    pub channel: *const c_char,
    /// Value of the parameter.
    pub value: f64,
    /// Unit of the value; empty for numbers without one.
    pub unit: *const c_char,
    /// Quantity that is the same on both sides: "surface_albedo", "d", the profile's width, or "mfp".
    pub equal: *const c_char,
    /// The code or the document that the rule was read in.
    pub source: *const c_char,
}

/// A material in the numbers of other systems.
///
/// It never changes, so any number of threads may use it at once.
pub struct TranslucidConverted {
    _opaque: [u8; 0],
}

/// The value behind a `TranslucidConverted`.
pub(crate) struct Converted {
    numbers: Vec<(f64, [CString; 6])>,
    notes: Vec<CString>,
}

impl Kind for TranslucidConverted {
    type Value = Converted;
    const TAG: [u8; 8] = *b"tl-conve";
    const NAME: &'static str = "TranslucidConverted";
}

const NAMES: ArgumentNames = ArgumentNames::FIELDS;

/// Name of a system by its index: NULL behind the last.
///
/// The text lasts as long as the program.
#[unsafe(no_mangle)]
pub extern "C" fn translucid_system_name(index: usize) -> *const c_char {
    static ALL: Names = Names::new();
    names::name_of(&ALL, index, conversion_system_names)
}

/// Converts a material.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_convert(
    conversion: *const TranslucidConversion,
    converted: *mut *mut TranslucidConverted,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("converted", converted)?;
        let given = caller.structure("conversion", conversion)?;
        let from = settings(caller, NAMES.from, given.from, given.from_count)?;
        let set = settings(caller, NAMES.set, given.set, given.set_count)?;
        let to = caller.structures(NAMES.to, given.to, given.to_count)?;
        let to: Vec<&str> = to.iter().map(|&name| caller.text(NAMES.to, name)).collect::<Result<_, _>>()?;
        let unit = unit(caller, "unit", given.unit, Unit::Millimeter)?;
        let configuration = names::configuration(caller, given.configuration)?;
        let conversion = Conversion {
            from: &from,
            surface_albedo: numbers(NAMES.surface_albedo, &given.surface_albedo, given.surface_albedo_count)?,
            unit,
            to_unit: self::unit(caller, "to_unit", given.to_unit, unit)?,
            to: &to,
            set: &set,
            configuration: configuration.unwrap_or(Configuration::Diffuse),
            color_space: None,
            names: NAMES,
        };
        let done = conversion.run().map_err(Failure::argument)?;
        slot.put_handle(Converted {
            numbers: done.numbers.iter().map(row).collect(),
            notes: done.notes.iter().map(|note| text(note)).collect(),
        });
        Ok(())
    })
}

/// Frees what a conversion made. NULL is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_converted_free(converted: *mut TranslucidConverted) -> TranslucidStatus {
    enter!(|caller| caller.free("converted", converted))
}

/// Gives how many numbers there are, system by system, the surface albedo first, and how many notes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_converted_count(
    converted: *const TranslucidConverted,
    numbers: *mut usize,
    notes: *mut usize,
) -> TranslucidStatus {
    enter!(|caller| {
        let slots = (caller.slot("numbers", numbers)?, caller.slot("notes", notes)?);
        let converted = caller.handle("converted", converted)?;
        slots.0.put(converted.numbers.len());
        slots.1.put(converted.notes.len());
        Ok(())
    })
}

/// Gives the number of an index.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_converted_number(
    converted: *const TranslucidConverted,
    index: usize,
    number: *mut TranslucidConvertedNumber,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("number", number)?;
        let all = &caller.handle("converted", converted)?.numbers;
        let (value, texts) = all.get(index).ok_or_else(|| no_such(index, all.len()))?;
        let [system, parameter, channel, unit, equal, source] = texts.each_ref().map(|text| text.as_ptr());
        slot.put(TranslucidConvertedNumber {
            system,
            parameter,
            channel,
            value: *value,
            unit,
            equal,
            source,
        });
        Ok(())
    })
}

/// Gives the note of an index: which system has no numbers, or will not use them as they are.
///
/// The text lasts as long as the TranslucidConverted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_converted_note(
    converted: *const TranslucidConverted,
    index: usize,
    note: *mut *const c_char,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("note", note)?;
        let all = &caller.handle("converted", converted)?.notes;
        slot.put(all.get(index).ok_or_else(|| no_such(index, all.len()))?.as_ptr());
        Ok(())
    })
}

fn no_such(index: usize, count: usize) -> Failure {
    Failure::argument(format_args!("index is {index}, but must be below {count}"))
}

fn text(text: &str) -> CString {
    CString::new(text).unwrap_or_default()
}

fn row(number: &ConvertedNumber) -> (f64, [CString; 6]) {
    let ConvertedNumber { system, parameter, channel, value, unit, equal, source, .. } = number;
    (*value, [*system, parameter, channel, unit, equal, source].map(text))
}

fn settings(
    caller: &Caller,
    argument: &str,
    start: *const TranslucidSetting,
    count: usize,
) -> Result<Vec<Setting>, Failure> {
    let given = caller.structures(argument, start, count)?;
    let mut settings = room(count)?;
    for setting in &given {
        let system = caller.text("system", setting.system)?;
        let parameter = caller.text("parameter", setting.parameter)?;
        let values = numbers(argument, &setting.values, setting.count)?;
        let setting = Setting::new(argument, system, parameter, values.to_vec());
        settings.push(setting.map_err(Failure::argument)?);
    }
    Ok(settings)
}

/// As many of three numbers as there are.
fn numbers<'a>(name: &str, values: &'a [f64; 3], count: usize) -> Result<&'a [f64], Failure> {
    values.get(..count).ok_or_else(|| {
        Failure::argument(format_args!("{name} has {count} numbers, but must have one or three"))
    })
}

fn unit(caller: &Caller, name: &str, unit: *const c_char, default: Unit) -> Result<Unit, Failure> {
    let text = caller.text_or(name, unit, default.name())?;
    Unit::from_name(text).ok_or_else(|| Failure::unknown(name, text, &["mm", "cm", "m"]))
}
