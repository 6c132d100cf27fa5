//! Lengths as typed. The only place that converts units.

mod lexer;

use self::lexer::{Token, tokens};
use crate::failure::InvalidValue;

const EXPECTED: &str =
    "a finite length, such as 1.7, 170cm, 1700mm, 67in or 5ft7in (a plain number is metres)";

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    Metre,
    Centimetre,
    Millimetre,
    Foot,
    Inch,
}

impl Unit {
    fn of_name(name: &str) -> Option<Self> {
        Some(match name {
            "m" | "metre" | "metres" | "meter" | "meters" => Self::Metre,
            "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => Self::Centimetre,
            "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => Self::Millimetre,
            "ft" | "foot" | "feet" | "'" => Self::Foot,
            "in" | "inch" | "inches" | "\"" => Self::Inch,
            _ => return None,
        })
    }

    /// Parts of a metre, or metres. Division is exact where the product is not: 170 cm must be the same number as 1.7 m.
    fn metres(self, value: f64) -> f64 {
        match self {
            Self::Metre => value,
            Self::Centimetre => value / 100.0,
            Self::Millimetre => value / 1000.0,
            Self::Foot => value * 0.3048,
            Self::Inch => value * 0.0254,
        }
    }

    /// How many of a smaller unit make one of this, and what a length of both has to be like; `None` where nobody adds
    /// the two.
    fn in_smaller(self, smaller: Self) -> Option<(f64, &'static str)> {
        Some(match (self, smaller) {
            (Self::Foot, Self::Inch) => (12.0, "whole feet and less than 12 inches"),
            (Self::Metre, Self::Centimetre) => (100.0, "whole metres and less than 100 centimetres"),
            (Self::Metre, Self::Millimetre) => (1000.0, "whole metres and less than 1000 millimetres"),
            (Self::Centimetre, Self::Millimetre) => (10.0, "whole centimetres and less than 10 millimetres"),
            _ => return None,
        })
    }
}

/// Reads a length and returns metres: `1.7` and `1.7m`, `170cm`, `1700mm`, `1m70`, `67in`, `67"`, `38 1/2 in`, `5ft7in`,
/// `5ft`, `5'7"`, `5'-7 1/2"`, `5 feet 7 inches`.
///
/// A plain number is metres; a hyphen between two parts is no sign. Plausibility is not checked here: 1700 is 1700 m.
pub(crate) fn parse_length(text: &str) -> Result<f64, InvalidValue> {
    let text = text.trim();
    metres(text).map_err(|expected| InvalidValue::form(expected, text))
}

/// The length in metres, or what was expected.
fn metres(text: &str) -> Result<f64, &'static str> {
    let tokens = tokens(text)?;
    let negative = tokens.first() == Some(&Token::Hyphen);
    let mut rest = &tokens[usize::from(negative)..];
    let before = rest.len();
    let first = number(&mut rest).ok_or(EXPECTED)?;
    let whole_or_decimal = before - rest.len() == 1;
    let metres = match (unit(&mut rest), rest) {
        (None, []) if whole_or_decimal => first,
        (None, []) => return Err("a unit after a fraction, as in 38 1/2 in"),
        (None, _) => return Err(EXPECTED),
        (Some(unit), []) => unit.metres(first),
        (Some(unit), rest) => sum(first, unit, rest)?,
    };
    match metres {
        metres if !metres.is_finite() => Err(EXPECTED),
        metres if metres > 0.0 && !negative => Ok(metres),
        _ => Err("a length above zero"),
    }
}

/// Metres of a length in two units, of which the rest is the smaller: `5'7"`, `1m70`.
fn sum(first: f64, unit: Unit, mut rest: &[Token]) -> Result<f64, &'static str> {
    if let [Token::Hyphen, after @ ..] = rest {
        rest = after;
    }
    let start = rest;
    let second = number(&mut rest).ok_or(EXPECTED)?;
    let smaller = match (self::unit(&mut rest), unit) {
        (Some(smaller), _) => smaller,
        (None, Unit::Foot) => Unit::Inch,
        // 1m7 may be 1.07 m or 1.7 m.
        (None, Unit::Metre) => match start {
            [Token::Number { len: 2, .. }] => Unit::Centimetre,
            _ => return Err("two digits of centimetres after the metres, as in 1m70"),
        },
        (None, _) => return Err(EXPECTED),
    };
    let (per_unit, form) = unit.in_smaller(smaller).filter(|_| rest.is_empty()).ok_or(EXPECTED)?;
    if second >= per_unit || first.fract() != 0.0 && second > 0.0 {
        return Err(form);
    }
    Ok(match unit {
        Unit::Foot => unit.metres(first) + smaller.metres(second),
        _ => smaller.metres(first * per_unit + second),
    })
}

/// Takes a number, with or without a fraction: `38`, `38.5`, `1/2`, `38 1/2`, `38-1/2`.
fn number(tokens: &mut &[Token]) -> Option<f64> {
    use Token::{Hyphen, Number, Slash};
    let (whole, fraction, count) = match **tokens {
        [Number { value: over, .. }, Slash, Number { value: under, .. }, ..] => (0.0, Some((over, under)), 3),
        [Number { value, .. }, Number { value: over, .. }, Slash, Number { value: under, .. }, ..] => {
            (value, Some((over, under)), 4)
        }
        [
            Number { value, .. },
            Hyphen,
            Number { value: over, .. },
            Slash,
            Number { value: under, .. },
            ..,
        ] => (value, Some((over, under)), 5),
        [Number { value, .. }, ..] => (value, None, 1),
        _ => return None,
    };
    *tokens = &tokens[count..];
    match fraction {
        None => Some(whole),
        Some((over, under)) => {
            let proper = over < under && [whole, over, under].iter().all(|part| part.fract() == 0.0);
            proper.then(|| whole + over / under)
        }
    }
}

/// Takes a unit, also one with a hyphen before it, as in `6-foot`.
fn unit(tokens: &mut &[Token]) -> Option<Unit> {
    let (unit, after) = match *tokens {
        [Token::Unit(unit), after @ ..] | [Token::Hyphen, Token::Unit(unit), after @ ..] => (*unit, after),
        _ => return None,
    };
    *tokens = after;
    Some(unit)
}

#[cfg(test)]
mod tests;
