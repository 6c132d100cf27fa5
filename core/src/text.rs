//! Text of files as other programs write it: byte order marks, UTF-16, the line ends of old Macs. Every reader of text decodes
//! it here.

use std::borrow::Cow;

use crate::error::Fault;

/// The character U+FEFF, which some programs write before a text.
const MARK: char = '\u{feff}';

/// The text of a file as UTF-8 without a byte order mark, with a `\n` at every end of line.
///
/// UTF-16 is recognised by its mark, or without one by the zeros among its first four bytes. Other bytes are left as they
/// are: they need not be UTF-8.
///
/// # Errors
/// [`Fault::Unexpected`] for UTF-32, and for UTF-16 that ends within a character or has half of a pair.
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Fault> {
    let text = match *bytes {
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => {
            return Err(Fault::unexpected("text in UTF-8 or UTF-16", "UTF-32"));
        }
        [0xff, 0xfe, ..] => Cow::Owned(utf16(&bytes[2..], u16::from_le_bytes)?),
        [0xfe, 0xff, ..] => Cow::Owned(utf16(&bytes[2..], u16::from_be_bytes)?),
        [1..=255, 0, 1..=255, 0, ..] => Cow::Owned(utf16(bytes, u16::from_le_bytes)?),
        [0, 1..=255, 0, 1..=255, ..] => Cow::Owned(utf16(bytes, u16::from_be_bytes)?),
        _ => Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)),
    };
    let lone = |text: &[u8], at: usize| text[at] == b'\r' && text.get(at + 1) != Some(&b'\n');
    if !(0..text.len()).any(|at| lone(&text, at)) {
        return Ok(text);
    }
    Ok((0..text.len()).map(|at| if lone(&text, at) { b'\n' } else { text[at] }).collect())
}

/// [`decode`] for text that has to be UTF-8, such as JSON.
///
/// # Errors
/// As [`decode`], and [`Fault::Unexpected`] for bytes that are not UTF-8.
pub fn decode_str(bytes: &[u8]) -> Result<String, Fault> {
    String::from_utf8(decode(bytes)?.into_owned()).map_err(|error| {
        let found = format!("other bytes from byte {}", error.utf8_error().valid_up_to());
        Fault::unexpected("text in UTF-8 or UTF-16", found)
    })
}

/// The text without a byte order mark.
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix(MARK).unwrap_or(text)
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<Vec<u8>, Fault> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let units = pairs.iter().map(|pair| unit(*pair));
    let text: Result<String, _> = char::decode_utf16(units).collect();
    match text {
        Ok(text) if rest.is_empty() => Ok(text.into_bytes()),
        Ok(_) => Err(Fault::unexpected("text in UTF-16", "half a character at its end")),
        Err(half) => {
            let found = format!("half of a pair, 0x{:04x}", half.unpaired_surrogate());
            Err(Fault::unexpected("text in UTF-16", found))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_gives_the_same_text() {
        let text = "{\"größe\": \"𝄞\"}\n";
        let units = |mark: &str| format!("{mark}{text}").encode_utf16().collect::<Vec<_>>();
        let little = |mark| units(mark).into_iter().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        let big = |mark| units(mark).into_iter().flat_map(u16::to_be_bytes).collect::<Vec<u8>>();
        let plain = text.as_bytes().to_vec();
        let marked = format!("\u{feff}{text}").into_bytes();
        for bytes in [plain, marked, little("\u{feff}"), big("\u{feff}"), little(""), big("")] {
            assert_eq!(decode_str(&bytes).unwrap(), text, "{bytes:?}");
        }
        assert_eq!(without_mark("\u{feff}{}"), "{}");
        assert_eq!(without_mark("{}"), "{}");
    }

    #[test]
    fn every_end_of_line_is_seen() {
        assert_eq!(&*decode(b"a\rb\r\nc\nd\r").unwrap(), b"a\nb\r\nc\nd\n");
        assert!(matches!(decode(b"a\r\n\xff"), Ok(Cow::Borrowed(b"a\r\n\xff"))), "other bytes are kept");
        assert!(matches!(decode(b""), Ok(Cow::Borrowed(b""))));
    }

    #[test]
    fn what_is_no_text_is_told() {
        let cases: [(&str, &[u8]); 4] = [
            ("expected text in UTF-8 or UTF-16, got UTF-32", b"\xff\xfe\0\0{\0\0\0"),
            ("expected text in UTF-16, got half a character at its end", b"\xff\xfe{\0}"),
            ("expected text in UTF-16, got half of a pair, 0xd800", b"\xfe\xff\xd8\0"),
            ("expected text in UTF-8 or UTF-16, got other bytes from byte 1", b"a\xff"),
        ];
        for (expected, bytes) in cases {
            assert_eq!(decode_str(bytes).unwrap_err().to_string(), expected);
        }
    }
}
