//! Numbers as the C library writes them.

/// `%E` with so many digits behind the point: 1.2340E-05.
pub(super) fn scientific(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$E}");
    match text.split_once('E') {
        Some((mantissa, exponent)) => match exponent.strip_prefix('-') {
            Some(exponent) => format!("{mantissa}E-{exponent:0>2}"),
            None => format!("{mantissa}E+{exponent:0>2}"),
        },
        None => text,
    }
}

/// `%G` with so many significant digits: the shorter of both forms, without zeros at the end.
pub(super) fn general(value: f64, digits: usize) -> String {
    let text = scientific(value, digits - 1);
    let exponent = text.split_once('E').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    let places = digits as i32 - 1 - exponent;
    if exponent >= -4 && places >= 0 {
        return without_zeros(&format!("{value:.*}", places as usize)).to_owned();
    }
    match text.split_once('E') {
        Some((mantissa, exponent)) => format!("{}E{exponent}", without_zeros(mantissa)),
        None => text,
    }
}

/// A number as [`general`] writes it with six digits, or with as many as it takes to read the same number back.
pub(super) fn exact(value: f64) -> String {
    let text = general(value, 6);
    if text.parse() == Ok(value) { text } else { format!("{value:?}") }
}

fn without_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the C library of GNU prints them.
    #[test]
    fn numbers_are_written_as_in_c() {
        for (value, expected) in [
            (0.0, "0.0000E+00"),
            (1.0, "1.0000E+00"),
            (30.924, "3.0924E+01"),
            (1.234_56e-5, "1.2346E-05"),
            (9.999_99e9, "1.0000E+10"),
            (1e-120, "1.0000E-120"),
        ] {
            assert_eq!(scientific(value, 4), expected);
        }
        for (value, digits, expected) in [
            (0.024_372_937, 6, "0.0243729"),
            (0.0, 6, "0"),
            (1.0, 6, "1"),
            (1e8, 6, "1E+08"),
            (123_456.7, 6, "123457"),
            (1_234_567.0, 6, "1.23457E+06"),
            (0.000_123_4, 4, "0.0001234"),
            (0.000_012_34, 4, "1.234E-05"),
            (999_999.6, 6, "1E+06"),
            (0.26120, 4, "0.2612"),
        ] {
            assert_eq!(general(value, digits), expected);
        }
        assert_eq!((exact(0.002).as_str(), exact(1e8).as_str()), ("0.002", "1E+08"));
        assert_eq!(exact(1.333_333_3).parse(), Ok(1.333_333_3));
    }
}
