//! USD text before the parser sees it: what the parser cannot read although USD can, and what it should not try.

use std::borrow::Cow;

use crate::error::{Fault, Within};
use crate::format::usd::Result;

/// Maximum nesting of brackets: the parser recurses for each.
const MAX_NESTING: usize = 256;

/// The text of a layer without a byte order mark, checked to begin as USD text does.
pub(super) fn text(bytes: &[u8]) -> Result<Cow<'_, str>> {
    let text = str::from_utf8(bytes).map_err(|e| {
        let utf16 = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
        let why = if utf16 { ": UTF-16, by its byte order mark" } else { "" };
        let found = format!("what is not UTF-8 from byte {}{why}", e.valid_up_to());
        Fault::unexpected("USD text, a crate or a package", found)
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if !text.trim_start().starts_with("#usda ") {
        let start: String = text.chars().take(12).collect();
        let found = format!("a file that starts with {start:?}");
        return Err(Fault::unexpected("`#usda 1.0`, a crate or a package", found).into());
    }
    readable(text)
}

/// The text with digits on both sides of every decimal point, as the parser reads neither `.01` nor `1.`. Refuses deeper
/// nested brackets than any real layer has, to protect the parser's stack.
fn readable(text: &str) -> Result<Cow<'_, str>> {
    let mut out = String::new();
    let (mut depth, mut line, mut at, mut copied) = (0_usize, 1, 0, 0);
    while let Some(c) = text[at..].chars().next() {
        let part = &text[at..at + part_len(&text[at..], c)];
        match c {
            '{' | '[' | '(' => depth += 1,
            '}' | ']' | ')' => depth = depth.saturating_sub(1),
            '0'..='9' | '.' => {
                if let Some(number) = completed(part) {
                    out.push_str(&text[copied..at]);
                    out.push_str(&number);
                    copied = at + part.len();
                }
            }
            _ => {}
        }
        line += part.bytes().filter(|b| *b == b'\n').count();
        at += part.len();
        if depth > MAX_NESTING {
            return Err(Fault::too_many(format_args!("{MAX_NESTING} nested brackets"), "more").into())
                .within(format_args!("line {line}"));
        }
    }
    if copied == 0 {
        return Ok(text.into());
    }
    out.push_str(&text[copied..]);
    Ok(out.into())
}

/// Number of bytes of a comment, a quoted text, a name, a number, or else of a character; the text begins with `c`.
fn part_len(text: &str, c: char) -> usize {
    let up_to = |end: &str| text[1..].find(end).map_or(text.len(), |at| 1 + at + end.len());
    let quotes = ["\"\"\"", "'''", "\"", "'", "@@@", "@"];
    match c {
        '#' => text.find('\n').unwrap_or(text.len()),
        '/' if text.starts_with("/*") => up_to("*/"),
        '<' => text.find(['>', '\n']).map_or(text.len(), |at| at + 1),
        '"' | '\'' | '@' => quotes
            .into_iter()
            .find(|quote| text.starts_with(quote))
            .map_or(1, |quote| quote.len() + quoted(&text[quote.len()..], quote)),
        '0'..='9' | '.' => number_len(text).max(1),
        _ if c.is_alphabetic() || c == '_' => {
            text.find(|c: char| !(c.is_alphanumeric() || "_:".contains(c))).unwrap_or(text.len())
        }
        _ => c.len_utf8(),
    }
}

/// Number of bytes of digits with a point and an exponent; 0 for a point alone.
fn number_len(text: &str) -> usize {
    let digits = |from: usize| {
        let rest = &text[from..];
        from + rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())
    };
    let mut len = digits(0);
    if text[len..].starts_with('.') {
        let end = digits(len + 1);
        if end == 1 {
            return 0;
        }
        len = end;
    }
    if text[len..].starts_with(['e', 'E']) {
        let sign = usize::from(text[len + 1..].starts_with(['+', '-']));
        let end = digits(len + 1 + sign);
        len = if end > len + 1 + sign { end } else { len };
    }
    len
}

/// A number with the digit that it lacks before or after its point; `None` if it lacks none, or is no number.
fn completed(number: &str) -> Option<String> {
    let (before, after) = number.split_once('.')?;
    let lacks_after = !after.starts_with(|c: char| c.is_ascii_digit());
    match (before.is_empty(), lacks_after) {
        (true, false) => Some(format!("0.{after}")),
        (false, true) => Some(format!("{before}.0{after}")),
        _ => None,
    }
}

/// Number of bytes up to and including the closing quote.
fn quoted(text: &str, quote: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices() {
        if !escaped && text[at..].starts_with(quote) {
            return at + quote.len();
        }
        escaped = !escaped && c == '\\' && !quote.starts_with('@');
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_get_the_digits_they_lack() {
        let same =
            |text: &str| assert!(matches!(readable(text), Ok(Cow::Borrowed(read)) if read == text), "{text}");
        for text in [
            "1.5 0.25e-3 -2 1e5 .x",
            "a1.timeSamples = 1",
            "primvars:st2.connect = </A1.b>",
            "\"1. .5\" '.5' @a.5@ @@@1.@@@ # .5 1.\n/* 1. .5 */ 2",
            "\"\"\"a \" 1.\"\"\" \"\\\" 1.\"",
            "größe1.x",
            "",
        ] {
            same(text);
        }
        for (text, read) in [
            ("(1., .01, -.5, -1.)", "(1.0, 0.01, -0.5, -1.0)"),
            ("1.e5 .5E-3 1.]", "1.0e5 0.5E-3 1.0]"),
            ("[.5,1.,.25]", "[0.5,1.0,0.25]"),
            ("a.b = 1.\n", "a.b = 1.0\n"),
        ] {
            assert_eq!(readable(text).unwrap(), read, "{text}");
        }
    }

    #[test]
    fn marks_and_encodings_are_told_apart() {
        assert_eq!(text(b"\xef\xbb\xbf#usda 1.0\n").unwrap(), "#usda 1.0\n");
        let message = |bytes: &[u8]| text(bytes).unwrap_err().to_string();
        assert!(message(b"\xff\xfe#\0u\0").contains("byte order mark"));
        assert!(message(b"\xfe\xff\0#\0u").contains("byte order mark"));
        assert!(message(b"#usda \xff").contains("UTF-8 from byte 6"));
        assert!(message(b"HIERARCHY").contains("a crate or a package"));
    }
}
