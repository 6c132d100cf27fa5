//! Resolves a buffer's URI (glTF 2.0, section 3.6.1.2).

use std::path::{Component as PathComponent, Path, PathBuf};

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use crate::error::Fault;
use crate::format::gltf::Result;

/// RFC 4648, section 4; padding is optional.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

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
        let (_, data) = data
            .split_once(";base64,")
            .ok_or_else(|| Fault::unexpected("base64 data", "data of another encoding"))?;
        let fault = |error| Fault::unexpected("base64 data", format_args!("other characters: {error}"));
        return Ok(Source::Data(BASE64.decode(data).map_err(fault)?));
    }
    let relative = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| Fault::unexpected("a name in Unicode", format_args!("`{uri}`")))?;
    let relative = Path::new(&*relative);
    if uri.contains(':')
        || !relative.components().all(|c| matches!(c, PathComponent::Normal(_) | PathComponent::CurDir))
    {
        let expected = "a file beside or below the document";
        return Err(Fault::unexpected(expected, format_args!("`{uri}`")).into());
    }
    Ok(Source::File(document.with_file_name("").join(relative)))
}

/// The file that a URI names, wherever it is; `None` for data in the URI itself or at another place than a disk.
pub(crate) fn file(uri: &str, document: &Path) -> Option<PathBuf> {
    let relative = percent_decode_str(uri).decode_utf8().ok().filter(|_| !uri.contains(':'))?;
    Some(document.with_file_name("").join(&*relative))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(uri: &str) -> Result<Source> {
        source(uri, Path::new("folder/a.gltf"))
    }

    #[test]
    fn data_comes_with_padding_or_without() {
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob")] {
            let data = load(&format!("data:application/octet-stream;base64,{text}"));
            assert!(matches!(data, Ok(Source::Data(data)) if data == bytes.as_bytes()), "{text}");
        }
        for uri in ["data:;base64,Zm9*", "data:;base64,Z", "data:,Zg=="] {
            assert!(load(uri).is_err(), "{uri}");
        }
    }

    #[test]
    fn names_are_escaped_and_stay_below_the_document() {
        for (uri, path) in
            [("a%20b.bin", "folder/a b.bin"), ("100%.bin", "folder/100%.bin"), ("%+5", "folder/%+5")]
        {
            assert!(matches!(load(uri), Ok(Source::File(file)) if file == Path::new(path)), "{uri}");
        }
        for uri in ["%ff", "../a.bin", "%2e%2e/a.bin", "/a.bin", "file:a.bin"] {
            assert!(load(uri).is_err(), "{uri}");
        }
    }
}
