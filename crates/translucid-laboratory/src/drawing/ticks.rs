//! Ticks: round numbers along an axis, and their text.

use super::axis_span::Span;
use crate::chart::Scale;

/// The ticks of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ticks {
    /// Numbers with text.
    pub(crate) major: Vec<(f64, String)>,
    /// Numbers without.
    pub(crate) minor: Vec<f64>,
}

impl Ticks {
    /// Round numbers of a span, about one with text every `spacing` pixels.
    pub(crate) fn new(span: &Span, spacing: f64, unit: &str) -> Self {
        let count = ((span.pixels[1] - span.pixels[0]).abs() / spacing).max(1.0);
        match span.scale {
            Scale::Linear if matches!(unit, "°" | "degrees") => {
                degrees(span, count).unwrap_or_else(|| linear(span, count))
            }
            Scale::Linear => linear(span, count),
            Scale::Logarithmic => logarithmic(span, count),
        }
    }
}

/// Multiples of the parts of a right angle, if there are a few of them.
fn degrees(span: &Span, count: f64) -> Option<Ticks> {
    let raw = (span.range[1] - span.range[0]) / count;
    let (step, part) = [(10.0, 2.0), (15.0, 5.0), (30.0, 10.0), (45.0, 15.0), (90.0, 30.0)]
        .into_iter()
        .find(|&(step, _)| step > 0.9 * raw)
        .filter(|_| raw > 4.0)?;
    let major = multiples(span, step).map(|value| (value, fixed(value, 0.0))).collect();
    Some(Ticks { major, minor: multiples(span, part).filter(|value| value % step != 0.0).collect() })
}

/// Multiples of 1, 2 or 5 times a power of ten.
fn linear(span: &Span, count: f64) -> Ticks {
    let [low, high] = span.range;
    let raw = (high - low) / count;
    let exponent = raw.log10().floor();
    let (factor, parts) = match raw / 10_f64.powf(exponent) {
        ..1.2 => (1.0, 5.0),
        ..2.4 => (2.0, 4.0),
        ..6.0 => (5.0, 5.0),
        _ => (10.0, 5.0),
    };
    let step = factor * 10_f64.powf(exponent);
    let decimals = -(exponent + if factor == 10.0 { 1.0 } else { 0.0 });
    let common = exponent_in_common(low.abs().max(high.abs()));
    let text = |value: f64| match common {
        _ if value == 0.0 => String::from("0"),
        None => fixed(value, decimals),
        Some(power) => {
            format!("{}×10{}", fixed(value / 10_f64.powf(power), decimals + power), superscript(power))
        }
    };
    let major = multiples(span, step).map(|value| (value, text(value))).collect();
    let is_major = |i: f64| i % parts == 0.0;
    let minor = whole(span, step / parts).filter(|&i| !is_major(i)).map(|i| i * (step / parts)).collect();
    Ticks { major, minor }
}

/// The power of ten that the texts of a very large or small axis share.
fn exponent_in_common(size: f64) -> Option<f64> {
    (!(1e-3..1e5).contains(&size)).then(|| size.log10().floor())
}

/// The number with so many decimals and a true minus.
fn fixed(value: f64, decimals: f64) -> String {
    let text = format!("{value:.*}", decimals.clamp(0.0, 12.0) as usize);
    text.replace('-', "−")
}

/// Whole numbers whose multiples of the step are in the span.
fn whole(span: &Span, step: f64) -> impl Iterator<Item = f64> {
    const MOST: usize = 200;
    let [low, high] = span.range;
    let [first, last] = [(low / step - 1e-9).ceil(), (high / step + 1e-9).floor()];
    let count = (last - first + 1.0).clamp(0.0, MOST as f64) as usize;
    (0..count).map(move |i| first + i as f64)
}

fn multiples(span: &Span, step: f64) -> impl Iterator<Item = f64> {
    whole(span, step).map(move |i| i * step)
}

/// Decades up to which twice and five times a power of ten have text, too, and all are written without powers.
const PLAIN: f64 = 2.2;

/// Powers of ten; over few decades also twice and five times as much.
fn logarithmic(span: &Span, count: f64) -> Ticks {
    let [low, high] = span.range.map(f64::log10);
    let decades = high - low;
    let (first, last) = (low.floor(), high.ceil());
    let powers = (0..=(last - first) as usize).map(|i| first + i as f64);
    let stride = (decades / count).ceil().max(1.0);
    let mut ticks = Ticks::default();
    for power in powers {
        for digit in 1..=9 {
            let value = f64::from(digit) * 10_f64.powf(power);
            if !span.contains(value) {
                continue;
            }
            let has_text = match digit {
                1 => power % stride == 0.0,
                2 | 5 => decades < PLAIN,
                3 | 4 | 6 | 7 | 8 => decades < 0.5,
                _ => false,
            };
            if has_text {
                ticks.major.push((value, power_text(digit, power, decades)));
            } else if stride == 1.0 || digit == 1 {
                ticks.minor.push(value);
            }
        }
    }
    if ticks.major.len() < 2 {
        // Too few powers within: as on a linear axis
        let even = linear(&Span { scale: Scale::Linear, ..*span }, count);
        if even.major.len() > 1 {
            return even;
        }
    }
    ticks
}

/// The text of a digit times a power of ten: 10⁻³, over few decades 0.002.
fn power_text(digit: i32, power: f64, decades: f64) -> String {
    if decades < PLAIN && (-3.0..4.0).contains(&power) {
        fixed(f64::from(digit) * 10_f64.powf(power), -power)
    } else if digit == 1 {
        format!("10{}", superscript(power))
    } else {
        format!("{digit}×10{}", superscript(power))
    }
}

/// A whole number in superscript digits.
fn superscript(number: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    format!("{number:.0}").chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(scale: Scale, range: [f64; 2]) -> Vec<String> {
        let ticks = Ticks::new(&Span { scale, range, pixels: [0.0, 400.0] }, 60.0, "");
        ticks.major.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(texts(Scale::Linear, [0.0, 10.0]), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(
            texts(Scale::Linear, [-0.1, 0.1]),
            ["−0.10", "−0.05", "0", "0.05", "0.10"].map(String::from)
        );
        assert_eq!(texts(Scale::Linear, [0.0, 2e6]), ["0", "0.5×10⁶", "1.0×10⁶", "1.5×10⁶", "2.0×10⁶"]);
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(texts(Scale::Logarithmic, [1e-3, 1e1]), ["10⁻³", "10⁻²", "10⁻¹", "10⁰", "10¹"]);
        assert_eq!(texts(Scale::Logarithmic, [0.02, 0.3]), ["0.02", "0.05", "0.1", "0.2"]);
        assert!(texts(Scale::Logarithmic, [1e-300, 1e300]).len() < 12);
    }

    #[test]
    fn every_range_has_ticks_in_it() {
        for low in [-1e300_f64, -5.0, 0.0, 1e-290, 1e-3, 0.1, 0.99, 1.0, 3.3, 1e5, 1e299] {
            for size in [1e-280, 1e-8, 1e-3, 0.5, 1.0, 1.3, 77.0, 1e6, 1e299] {
                let range = [low, low + size];
                for scale in [Scale::Linear, Scale::Logarithmic] {
                    if size <= 1e-8 * low.abs() || (scale == Scale::Logarithmic && low <= 0.0) {
                        continue;
                    }
                    let span = Span { scale, range, pixels: [0.0, 400.0] };
                    let ticks = Ticks::new(&span, 60.0, "");
                    assert!((1..=14).contains(&ticks.major.len()), "{range:?} {scale:?} {ticks:?}");
                    assert!(
                        ticks.major.iter().all(|(value, _)| span.contains(*value)),
                        "{range:?} {ticks:?}"
                    );
                    assert!(ticks.minor.iter().all(|&value| span.contains(value)), "{range:?} {ticks:?}");
                }
            }
        }
    }
}
