//! The parts of a length as typed: numbers, units and marks.

use super::{EXPECTED, Unit};

/// A part of a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token {
    /// A number without a sign, and how many characters it has.
    Number {
        value: f64,
        len: usize,
    },
    Unit(Unit),
    Hyphen,
    Slash,
}

/// Splits a length into its parts, or says what was expected.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, &'static str> {
    let plain = plain(text);
    let mut rest = plain.trim_start().strip_prefix('+').unwrap_or(&plain).trim_start();
    let mut tokens = Vec::new();
    while let Some(c) = rest.chars().next() {
        let len = match c {
            '0'..='9' | '.' => {
                let len = number_len(rest);
                let value = rest[..len].parse().map_err(|_| EXPECTED)?;
                tokens.push(Token::Number { value, len });
                len
            }
            'a'..='z' => {
                let len = rest.find(|c: char| !c.is_ascii_lowercase()).unwrap_or(rest.len());
                let after_unit = matches!(tokens.last(), Some(Token::Unit(_)));
                if &rest[..len] != "and" || !after_unit {
                    tokens.push(Token::Unit(Unit::of_name(&rest[..len]).ok_or(EXPECTED)?));
                }
                // `5 ft. 7 in.` and `5 feet, 7 inches`.
                len + usize::from(rest[len..].starts_with(['.', ',']) && !starts_with_digit(&rest[len + 1..]))
            }
            '\'' | '"' => {
                tokens.push(Token::Unit(if c == '"' { Unit::Inch } else { Unit::Foot }));
                1
            }
            '-' | '/' => {
                tokens.push(if c == '-' { Token::Hyphen } else { Token::Slash });
                1
            }
            ',' => return Err("a length with a point, as in 1.7"),
            _ => return Err(EXPECTED),
        };
        rest = rest[len..].trim_start();
    }
    Ok(tokens)
}

/// Lower case, and plain marks, hyphens and fractions for typographic ones.
fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '′' | '’' | '‘' | '´' | '`' | 'ʹ' | 'ʼ' | '＇' => out.push('\''),
            '″' | '”' | '“' | 'ʺ' | '˝' | '＂' => out.push('"'),
            '‐' | '‑' | '‒' | '–' | '—' | '−' => out.push('-'),
            '⁄' | '∕' => out.push('/'),
            '½' => out.push_str(" 1/2"),
            '¼' => out.push_str(" 1/4"),
            '¾' => out.push_str(" 3/4"),
            '⅓' => out.push_str(" 1/3"),
            '⅔' => out.push_str(" 2/3"),
            '⅛' => out.push_str(" 1/8"),
            '⅜' => out.push_str(" 3/8"),
            '⅝' => out.push_str(" 5/8"),
            '⅞' => out.push_str(" 7/8"),
            _ => out.push(c.to_ascii_lowercase()),
        }
    }
    out.replace("''", "\"")
}

/// Number of characters of digits with a point and an exponent.
fn number_len(text: &str) -> usize {
    let digits = |from: usize| {
        let rest = &text[from..];
        from + rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())
    };
    let mut len = digits(0);
    if text[len..].starts_with('.') {
        len = digits(len + 1);
    }
    if let Some(exponent) = text[len..].strip_prefix('e') {
        let sign = usize::from(exponent.starts_with(['+', '-']));
        if starts_with_digit(&exponent[sign..]) {
            len = digits(len + 1 + sign);
        }
    }
    len
}

fn starts_with_digit(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit())
}
