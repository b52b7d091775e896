//! Numbers as text for readers: plain if short, else with a power of ten in superscript.

/// Values of this size and above are written with a power of ten.
const LARGE: f64 = 1e6;
/// Values below this size are written with a power of ten.
const SMALL: f64 = 1e-4;

/// `value` with up to `digits` significant digits and no trailing zeros: 0.002, 12.5, 3×10⁻⁷.
pub fn short(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return if value.is_nan() { "n/a".into() } else { minus(value.to_string().replace("inf", "∞")) };
    }
    if value.abs() == 0.0 {
        return "0".into();
    }
    // Rounding first: 9.99 in two digits is 10, which is one digit longer.
    let rounded: f64 = format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value);
    if is_plain(rounded) { minus(format!("{rounded}")) } else { scientific(rounded, digits.saturating_sub(1)) }
}

/// An interval in brackets, to follow a value: begins with a space, and is empty for `None`.
pub fn between(interval: Option<(f64, f64)>, digits: usize) -> String {
    interval.map_or_else(String::new, |(low, high)| format!(" ({} to {})", short(low, digits), short(high, digits)))
}

/// Whether `value` is written without a power of ten.
pub fn is_plain(value: f64) -> bool {
    value.abs() == 0.0 || (SMALL..LARGE).contains(&value.abs())
}

pub fn fixed(value: f64, decimals: usize) -> String {
    minus(format!("{value:.decimals$}"))
}

/// `value` as mantissa × 10ⁿ. The mantissa has at most `decimals` decimals and is left out if it is 1.
pub fn scientific(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$e}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let mantissa = if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    match mantissa {
        "0" | "-0" => "0".into(),
        "1" => format!("10{}", superscript(exponent)),
        "-1" => format!("−10{}", superscript(exponent)),
        _ => minus(format!("{mantissa}×10{}", superscript(exponent))),
    }
}

fn superscript(exponent: &str) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    exponent.chars().map(|c| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])).collect()
}

/// A real minus sign instead of a hyphen; none before a zero.
fn minus(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().any(|c| c.is_ascii_digit() && c != '0') || rest == "∞" => format!("−{rest}"),
        Some(rest) => rest.to_string(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers() {
        let table = [
            (0.002, "0.002"),
            (12.5, "12.5"),
            (200.0, "200"),
            (786_432.0, "786432"),
            (-0.5, "−0.5"),
            (0.0, "0"),
            (-0.0, "0"),
            (1e6, "10⁶"),
            (2.5e7, "2.5×10⁷"),
            (3e-7, "3×10⁻⁷"),
            (1e-300, "10⁻³⁰⁰"),
            (f64::NAN, "n/a"),
            (f64::NEG_INFINITY, "−∞"),
        ];
        for (value, text) in table {
            assert_eq!(short(value, 6), text);
        }
        assert_eq!(short(0.123_456, 3), "0.123");
        assert_eq!(short(999.9, 3), "1000");
        assert_eq!(short(999_999.9, 3), "10⁶");
    }

    #[test]
    fn fixed_and_scientific() {
        assert_eq!(fixed(-0.5, 3), "−0.500");
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!(scientific(120.0, 3), "1.2×10²");
        assert_eq!(scientific(-100.0, 0), "−10²");
        assert_eq!(scientific(0.0, 2), "0");
    }
}
