//! What no file of characters needs more of: a few bytes must not ask for all memory.

/// Most vertices, and most triangles, of all meshes of one file together.
pub(crate) const MAX_ELEMENTS: usize = 4 << 20;
/// Most meshes of one file.
pub(crate) const MAX_MESHES: usize = 1 << 16;
