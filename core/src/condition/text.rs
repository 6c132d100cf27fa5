//! Numbers and lists in messages.

/// A length in metres for a message: two to four decimals, an exponent for values that no length has.
pub(crate) fn metres(value: f64) -> String {
    if !value.is_finite() || value.abs() >= 1e7 || (value != 0.0 && value.abs() < 5e-5) {
        return format!("{value:e}");
    }
    let text = format!("{value:.4}");
    let short = text.trim_end_matches('0');
    match short.find('.') {
        Some(dot) if short.len() == dot + 1 && value.abs() >= 100.0 => short[..dot].to_owned(),
        Some(dot) => format!("{short}{}", "0".repeat((dot + 3).saturating_sub(short.len()))),
        None => text,
    }
}

/// Joins items with commas and `last`: for `and`, `a`, `a and b`, `a, b and c`.
pub(crate) fn list<S: AsRef<str>>(items: &[S], last: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [first @ .., end] => {
            let first: Vec<_> = first.iter().map(AsRef::as_ref).collect();
            format!("{} {last} {}", first.join(", "), end.as_ref())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_read_naturally() {
        let cases = [
            (1.7, "1.70"),
            (0.335, "0.335"),
            (1700.0, "1700"),
            (0.0, "0.00"),
            (-1.5, "-1.50"),
            (12.0, "12.00"),
            (1e300, "1e300"),
            (1e-9, "1e-9"),
            (f64::NAN, "NaN"),
            (0.12346, "0.1235"),
        ];
        for (value, text) in cases {
            assert_eq!(metres(value), text);
        }
    }

    #[test]
    fn lists_read_naturally() {
        assert_eq!(list::<&str>(&[], "and"), "");
        assert_eq!(list(&["a"], "and"), "a");
        assert_eq!(list(&["a", "b", "c"], "or"), "a, b or c");
    }
}
