//! Measures and picture sizes as typed.

use crate::failure::InvalidValue;
use crate::length::parse_length;

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
