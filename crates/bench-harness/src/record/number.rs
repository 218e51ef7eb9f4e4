//! Numbers for people: no more digits than mean something.

/// `digits` significant digits, with an exponent where plain digits would be many.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    /// Plain digits between these two powers of ten.
    const PLAIN: std::ops::Range<i32> = -2..6;
    if x == 0.0 {
        return "0".to_owned();
    }
    if !x.is_finite() {
        return if x.is_nan() { "unknown".to_owned() } else { "infinite".to_owned() };
    }
    let exponential = format!("{x:.*e}", digits.saturating_sub(1));
    // Taken from the rounded number: 9.9999 may have become 10.
    let exponent: i32 = exponential.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    if !PLAIN.contains(&exponent) {
        return exponential;
    }
    let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
    format!("{x:.decimals$}")
}

/// A duration: `3.1 ms`, `0.425 s`, `75.3 s`.
pub(crate) fn seconds(s: f64) -> String {
    const DIGITS: usize = 2;
    /// Below, a clock measures itself.
    const SHORTEST: f64 = 1e-4;
    if s < SHORTEST {
        "<0.1 ms".to_owned()
    } else if s < 0.1 {
        format!("{} ms", significant(1e3 * s, DIGITS))
    } else {
        format!("{} s", significant(s, DIGITS + 1))
    }
}

/// Bytes in millions: `12`, `1.2`.
pub(crate) fn megabytes(bytes: usize) -> String {
    const MEGA: f64 = 1e6;
    match bytes as f64 / MEGA {
        mb if mb < 0.1 => "<0.1".to_owned(),
        mb if mb < 10.0 => format!("{mb:.1}"),
        mb => format!("{mb:.0}"),
    }
}

/// `1 face`, `2 faces`.
pub(crate) fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_asked_for() {
        let cases = [
            (5.3310e-4, 4, "5.331e-4"),
            (1.26702, 5, "1.2670"),
            (0.012345, 3, "0.0123"),
            (9.99999, 3, "10.0"),
            (1234.5, 3, "1234"),
            (0.0, 3, "0"),
            (f64::INFINITY, 3, "infinite"),
            (1.5e7, 2, "1.5e7"),
        ];
        for (x, digits, text) in cases {
            assert_eq!(significant(x, digits), text, "{x}");
        }
    }

    #[test]
    fn durations_and_sizes_are_short() {
        assert_eq!([1e-5, 0.00312, 0.4249, 75.3].map(seconds), ["<0.1 ms", "3.1 ms", "0.425 s", "75.3 s"]);
        assert_eq!([99, 1_234_567, 98_765_432].map(megabytes), ["<0.1", "1.2", "99"]);
    }
}
