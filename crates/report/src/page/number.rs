//! Numbers as people read them.

/// Numbers below are written with a power of ten.
const SMALL: f64 = 1e-2;
/// Numbers from here on are written with a power of ten.
const LARGE: f64 = 1e6;

/// A number with so many significant digits; very small and very large ones with a power of ten.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if !x.is_finite() {
        return if x.is_nan() { "not a number".to_owned() } else { format!("{}∞", if x < 0.0 { "−" } else { "" }) };
    }
    let scientific = format!("{x:.*e}", digits - 1);
    let exponent: i32 = scientific.split('e').nth(1).and_then(|e| e.parse().ok()).unwrap_or(0);
    if (SMALL..LARGE).contains(&x.abs()) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{x:.decimals$}")
    } else {
        scientific
    }
}

/// A round number, in as few digits as it has.
pub(crate) fn round(x: f64) -> String {
    const DIGITS: usize = 6;
    let text = significant(x, DIGITS);
    let (mantissa, exponent) = text.split_once('e').map_or((text.as_str(), None), |(m, e)| (m, Some(e)));
    let short = if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    let short = short.replace('-', "−");
    exponent.map_or(short.clone(), |e| format!("{short}e{e}"))
}

/// A count with its thousands apart.
pub(crate) fn grouped(count: usize) -> String {
    const GROUP: usize = 3;
    let digits = count.to_string();
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(GROUP) {
            // A thin space that does not break.
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

/// A power of ten, with a raised exponent.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |d| RAISED[d as usize]);
    format!("10{}", exponent.to_string().chars().map(raise).collect::<String>())
}

/// Round numbers for the marks of an axis.
pub(crate) const COARSE: &[f64] = &[1.0, 2.0, 5.0];
/// Round numbers for the end of a scale.
pub(crate) const FINE: &[f64] = &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0];

/// The least of the mantissas, which begin with 1, times a power of ten that is not below a positive `x`.
pub(crate) fn round_up(x: f64, mantissas: &[f64]) -> f64 {
    /// A hair above a round number still is that number.
    const SLACK: f64 = 1.0 - 1e-9;
    let power = 10_f64.powf(x.log10().floor());
    mantissas.iter().map(|m| m * power).find(|&r| r >= x * SLACK).unwrap_or(10.0 * power)
}

/// The value below which a share of the values lies, by rank; 0 if there are none.
pub(crate) fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let rank = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(rank, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_asked_for() {
        for (x, text) in
            [(5.041_9e-4, "5.042e-4"), (0.012_345, "0.01235"), (12.3, "12.30"), (0.0, "0"), (2e7, "2.000e7")]
        {
            assert_eq!(significant(x, 4), text);
        }
        assert_eq!(significant(f64::INFINITY, 4), "∞");
        assert_eq!(significant(123_456.0, 2), "123456");
    }

    #[test]
    fn round_numbers_have_no_digits_to_spare() {
        for (x, text) in [(0.5, "0.5"), (20.0, "20"), (-2.5, "−2.5"), (5e-6, "5e-6"), (0.0, "0")] {
            assert_eq!(round(x), text);
        }
    }

    #[test]
    fn thousands_are_apart_and_exponents_raised() {
        assert_eq!(grouped(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(grouped(123), "123");
        assert_eq!(power_of_ten(-12), "10⁻¹²");
    }

    #[test]
    fn rounding_up_ends_at_a_round_number() {
        for (x, up) in [(0.11, 0.2), (0.2, 0.2), (3.0, 5.0), (51.0, 100.0), (1e-6, 1e-6)] {
            assert!((round_up(x, COARSE) / up - 1.0).abs() < 1e-12, "{x} gives {}", round_up(x, COARSE));
        }
        assert_eq!((round_up(5.48, FINE), round_up(81.0, FINE)), (6.0, 100.0));
    }

    #[test]
    fn a_quantile_is_one_of_the_values() {
        assert_eq!(quantile(&mut [5.0, 1.0, 3.0], 0.5), 3.0);
        assert_eq!(quantile(&mut [5.0, 1.0, 3.0], 1.0), 5.0);
        assert_eq!(quantile(&mut [], 0.5), 0.0);
    }
}
