//! Numbers and polynomials as source code writes them.

/// A number with the nine digits that single precision needs, and a point or an exponent.
pub(crate) fn literal(value: f64) -> String {
    // Reads back, as it has just been written
    let nine: f64 = format!("{value:.8e}").parse().unwrap_or(value);
    let magnitude = nine.abs();
    if magnitude != 0.0 && !(1e-4..1e9).contains(&magnitude) {
        return format!("{nine:e}");
    }
    let text = nine.to_string();
    if text.contains('.') { text } else { text + ".0" }
}

/// Σ c_i x^i by Horner's rule, for the variable of a name.
pub(crate) fn horner(coefficients: &[f64], name: &str) -> String {
    match coefficients {
        [] => literal(0.0),
        [last] => literal(*last),
        [first, rest @ ..] => {
            let rest_text = horner(rest, name);
            let rest_text = if rest.len() > 1 { format!("({rest_text})") } else { rest_text };
            format!("{} + {name} * {rest_text}", literal(*first))
        }
    }
}

/// Coefficients of p(1 − x) from those of p(x).
pub(crate) fn about_one(coefficients: &[f64]) -> Vec<f64> {
    // p(1 − x) = (… (c_n (1 − x) + c_{n−1}) (1 − x) + …), one power after the other
    let mut result: Vec<f64> = Vec::new();
    for c in coefficients.iter().rev() {
        let mut next = vec![0.0; result.len() + 1];
        for (i, r) in result.iter().enumerate() {
            next[i] += r;
            next[i + 1] -= r;
        }
        next[0] += c;
        result = next;
    }
    result.truncate(coefficients.len());
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literal_is_a_number_of_every_language() {
        for (value, expected) in
            [(1.0, "1.0"), (-2.5, "-2.5"), (1e-18, "1e-18"), (0.1 + 0.2, "0.3"), (0.0, "0.0"), (1e9, "1e9")]
        {
            assert_eq!(literal(value), expected);
        }
        assert_eq!(literal(std::f64::consts::PI).parse::<f32>().unwrap(), std::f32::consts::PI);
    }

    #[test]
    fn horner_nests() {
        assert_eq!(horner(&[1.0, -2.0, 3.0], "x"), "1.0 + x * (-2.0 + x * 3.0)");
    }

    #[test]
    fn about_one_is_the_same_polynomial() {
        let p = [1.0537, -1.4289, 0.5276, -0.1274];
        let q = about_one(&p);
        let at = |c: &[f64], x: f64| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
        assert_eq!(q.len(), p.len());
        for x in [0.0, 0.3, 1.0] {
            assert!((at(&p, x) - at(&q, 1.0 - x)).abs() < 1e-15);
        }
    }
}
