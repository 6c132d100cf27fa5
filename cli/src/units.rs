//! Lengths and picture sizes as typed. The only place that converts units.

use crate::failure::InvalidValue;

/// Reads a length and returns metres: `1.7` and `1.7m`, `170cm`, `1700mm`, `67in`, `67"`, `5ft7in`, `5ft`, `5'7"`.
///
/// A plain number is metres. Plausibility is not checked here: 1700 is 1700 m.
pub(crate) fn parse_length(text: &str) -> Result<f64, InvalidValue> {
    let text = text.trim();
    let lower = text.to_ascii_lowercase().replace('′', "'").replace('″', "\"").replace("''", "\"");
    if let Some((feet, rest)) = split_feet(&lower) {
        let feet = number(feet, text)?;
        let inches = match rest.trim() {
            "" => 0.0,
            rest => {
                let digits = rest.trim_end_matches("in").trim_end_matches('"').trim();
                number(digits, text)?
            }
        };
        if inches >= 12.0 || feet.fract() != 0.0 && inches > 0.0 {
            return Err(InvalidValue::form("whole feet and less than 12 inches", text));
        }
        return positive(feet * 0.3048 + inches * 0.0254, text);
    }
    // Longer suffixes first: `cm` and `mm` end in `m`.
    const UNITS: [(&str, f64); 6] =
        [("mm", 0.001), ("cm", 0.01), ("inch", 0.0254), ("in", 0.0254), ("\"", 0.0254), ("m", 1.0)];
    let (digits, metres) = UNITS
        .iter()
        .find_map(|(suffix, metres)| lower.strip_suffix(suffix).map(|digits| (digits, *metres)))
        .unwrap_or((&lower, 1.0));
    let value = number(digits, text)?;
    // Division is exact where the product is not: 170 cm must be the same number as 1.7 m.
    let value = if metres < 0.0254 { value / (1.0 / metres).round() } else { value * metres };
    positive(value, text)
}

/// The parts before and after the mark for feet, if there is one.
fn split_feet(text: &str) -> Option<(&str, &str)> {
    text.split_once("ft").or_else(|| text.split_once('\''))
}

fn number(digits: &str, whole: &str) -> Result<f64, InvalidValue> {
    let digits = digits.trim();
    let plain = !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit() || "+-.e".contains(c));
    match digits.parse::<f64>() {
        Ok(value) if plain && value.is_finite() => Ok(value),
        _ if digits.contains(',') => Err(InvalidValue::form("a length with a point, as in 1.7", whole)),
        _ => Err(InvalidValue::form(
            "a finite length, such as 1.7, 170cm, 1700mm, 67in or 5ft7in (a plain number is metres)",
            whole,
        )),
    }
}

fn positive(metres: f64, whole: &str) -> Result<f64, InvalidValue> {
    if metres > 0.0 && metres.is_finite() {
        Ok(metres)
    } else {
        Err(InvalidValue::form("a length above zero", whole))
    }
}

/// Reads `NAME=LENGTH`, such as `height=170cm`, into the name and metres.
pub(crate) fn parse_measure(text: &str) -> Result<(String, f64), InvalidValue> {
    let Some((name, value)) = text.split_once('=') else {
        return Err(InvalidValue::form("NAME=VALUE, such as height=170cm", text));
    };
    let name = name.trim();
    if name.is_empty() {
        return Err(InvalidValue::form("the name of a measure before `=`", text));
    }
    let metres = parse_length(value)
        .map_err(|error| InvalidValue::Measure { measure: name.to_owned(), source: Box::new(error) })?;
    Ok((name.to_owned(), metres))
}

/// Reads a picture's size such as `1200x800`: 16 to 8192 pixels each way.
pub(crate) fn parse_size(text: &str) -> Result<(usize, usize), InvalidValue> {
    let wrong = || InvalidValue::form("WIDTHxHEIGHT in pixels, 16 to 8192 each, such as 1600x720", text);
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    let side = |digits: &str| match digits.trim().parse::<usize>() {
        Ok(side @ 16..=8192) => Ok(side),
        _ => Err(wrong()),
    };
    Ok((side(width)?, side(height)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_in_every_unit() {
        for (text, metres) in [
            ("1.7", 1.7),
            ("1.7m", 1.7),
            (" 1.7 m ", 1.7),
            ("170cm", 1.7),
            ("170 CM", 1.7),
            ("1700mm", 1.7),
            ("0.815", 0.815),
            ("67in", 67.0 * 0.0254),
            ("67\"", 67.0 * 0.0254),
            ("5ft7in", 5.0 * 0.3048 + 7.0 * 0.0254),
            ("5ft 7", 5.0 * 0.3048 + 7.0 * 0.0254),
            ("5'7\"", 5.0 * 0.3048 + 7.0 * 0.0254),
            ("5′7.5″", 5.0 * 0.3048 + 7.5 * 0.0254),
            ("5.5ft", 5.5 * 0.3048),
            ("1700", 1700.0),
        ] {
            let got = parse_length(text).unwrap();
            assert!((got - metres).abs() < 1e-12, "{text}: {got}");
        }
        assert_eq!(parse_length("170cm"), parse_length("1.7"));
        assert_eq!(parse_length("1700mm"), parse_length("1.7"));
    }

    #[test]
    fn invalid_lengths_are_refused() {
        for text in [
            "", "m", "NaN", "inf", "-inf", "1e999", "tall", "1.7.0", "5ft13in", "5ftx", "5.5ft3in", "1.7kg",
            "0x10",
        ] {
            let message = parse_length(text).unwrap_err().to_string();
            assert!(message.contains(&format!("got `{text}`")), "{text}: {message}");
        }
        assert!(parse_length("-1.7").unwrap_err().to_string().contains("above zero"));
        assert!(parse_length("0").unwrap_err().to_string().contains("above zero"));
        assert!(parse_length("1,70").unwrap_err().to_string().contains("point"));
    }

    #[test]
    fn errors_name_the_measure() {
        assert_eq!(parse_measure("height=170cm"), Ok(("height".to_owned(), 1.7)));
        assert!(parse_measure("height=NaN").unwrap_err().to_string().starts_with("height: "));
        assert!(parse_measure("height").unwrap_err().to_string().contains("NAME=VALUE"));
        assert!(parse_measure("=1").unwrap_err().to_string().contains("name"));
    }

    #[test]
    fn sizes() {
        assert_eq!(parse_size("1200x800"), Ok((1200, 800)));
        for text in ["1200", "0x800", "1200x", "x", "99999x10", "-5x10", "1200x800x3"] {
            assert!(parse_size(text).is_err(), "{text}");
        }
    }
}
