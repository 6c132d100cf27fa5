//! Limits that no character file needs to exceed: a few bytes must not allocate all memory.

/// Maximum number of vertices, and of triangles, over all meshes of a file.
pub(crate) const MAX_ELEMENTS: usize = 4 << 20;
/// Maximum number of meshes of a file.
pub(crate) const MAX_MESHES: usize = 1 << 16;
