//! Content of a buffer's URI (glTF 2.0, section 3.6.1.2).

use std::path::{Component as PathComponent, Path, PathBuf};

use crate::error::Fault;
use crate::format::gltf::Result;

/// Where the bytes of a buffer are.
pub(crate) enum Source {
    /// In the URI itself.
    Data(Vec<u8>),
    /// In a file beside or below the document.
    File(PathBuf),
}

/// What a URI in a document refers to.
pub(crate) fn source(uri: &str, document: &Path) -> Result<Source> {
    if let Some(data) = uri.strip_prefix("data:") {
        let base64 = data.split_once(";base64,").and_then(|(_, base64)| base64_decoded(base64));
        let fault = || Fault::unexpected("base64 data", "other characters");
        return Ok(Source::Data(base64.ok_or_else(fault)?));
    }
    let relative = percent_decoded(uri)
        .ok_or_else(|| Fault::unexpected("a name in Unicode", format_args!("`{uri}`")))?;
    let relative = Path::new(&relative);
    if uri.contains(':')
        || !relative.components().all(|c| matches!(c, PathComponent::Normal(_) | PathComponent::CurDir))
    {
        let expected = "a file beside or below the document";
        return Err(Fault::unexpected(expected, format_args!("`{uri}`")).into());
    }
    Ok(Source::File(document.with_file_name("").join(relative)))
}

fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let escaped = (*first == b'%').then(|| tail.get(..2)).flatten();
        let escaped = escaped
            .and_then(|hex| std::str::from_utf8(hex).ok())
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(escaped.unwrap_or(*first));
        rest = if escaped.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(bytes).ok()
}

/// RFC 4648, section 4; padding is optional.
fn base64_decoded(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut word = 0u32;
        for character in group {
            let value = match character {
                b'A'..=b'Z' => character - b'A',
                b'a'..=b'z' => character - b'a' + 26,
                b'0'..=b'9' => character - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            word = word << 6 | u32::from(value);
        }
        let [_, decoded @ ..] = (word << (6 * (4 - group.len()))).to_be_bytes();
        bytes.extend_from_slice(decoded.get(..(group.len() * 6) / 8)?);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decodes_the_base64_of_the_standard() {
        // RFC 4648, section 10.
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob")] {
            assert_eq!(base64_decoded(text).unwrap(), bytes.as_bytes());
        }
        assert_eq!(base64_decoded("Zm9*"), None);
    }
}
