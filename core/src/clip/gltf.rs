use super::ReadOptions;
use super::raw::Raw;
pub(super) fn read(_: &[u8], path: &std::path::Path, _: &ReadOptions) -> crate::Result<Raw> {
    Err(crate::Error::file(path, "not yet glTF"))
}
