//! SYSTEM:PARAMETER=VALUE, as an option gives it.

use translucid_profile::convention::{Setting, conversion_system_names};

use crate::failure::Failure;

/// Parses the values of an option.
pub(super) fn parse_all(option: &str, texts: &[String]) -> Result<Vec<Setting>, Failure> {
    texts.iter().map(|text| parse(option, text)).collect()
}

fn parse(option: &str, text: &str) -> Result<Setting, Failure> {
    let parts = text.split_once(':').and_then(|(system, rest)| {
        let (parameter, values) = rest.split_once('=')?;
        Some((system.trim(), parameter.trim(), values))
    });
    let Some((system, parameter, values)) = parts else {
        let known = conversion_system_names().join(", ");
        let message = format!("{option} is \"{text}\", but must be SYSTEM:PARAMETER=VALUE");
        return Err(Failure::input(message)
            .with_help(format!("for example renderman:dmfp=2; the systems are {known}")));
    };
    let numbers: Result<Vec<f64>, _> = values.split(',').map(|number| number.trim().parse()).collect();
    match numbers {
        Ok(numbers) if matches!(numbers.len(), 1 | 3) => {
            Ok(Setting::new(option, system, parameter, numbers)?)
        }
        _ => {
            // A system that is not known is the first thing to say
            Setting::new(option, system, parameter, vec![0.0])?;
            Err(Failure::input(format!(
                "{option} {system}:{parameter} is \"{values}\", but must be a number, or three with commas between"
            )))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parse_takes_spaces_and_three_values() {
        let setting = parse("--from", "renderman: subsurface-DmfpColor =1, 0.5,0.2").unwrap();
        let expected = Setting::new("", "renderman", "subsurface-DmfpColor", vec![1.0, 0.5, 0.2]).unwrap();
        assert_eq!(setting, expected);
    }

    #[test]
    fn parse_refuses_what_is_no_setting() {
        for text in ["", "renderman", "renderman:dmfp", "renderman:dmfp=", "renderman:dmfp=1,2", "maya:x=1"] {
            assert!(parse("--from", text).is_err(), "{text}");
        }
    }
}
