//! The formats, and what each of them supports.

use std::{ffi::OsStr, path::Path};

use super::motion::{ReadOptions, raw::RawMotion};
use super::write::WriteOptions;
use super::{bvh, fbx, gltf, npz, obj, usd, vrm};
use crate::error::FormatError;
use crate::scene::Scene;
use crate::{Error, Result};

/// Declares [`Format`] from one line per format: documentation, name, and the description in the format's folder.
macro_rules! formats {
    ($($(#[$doc:meta])* $format:ident = $description:path,)*) => {
        /// A file format, chosen by the file extension. More may be added.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Format {
            $($(#[$doc])* $format,)*
        }

        impl Format {
            /// Every format.
            pub const ALL: &[Self] = &[$(Self::$format,)*];

            const fn description(self) -> &'static Description {
                match self {
                    $(Self::$format => &$description,)*
                }
            }
        }
    };
}

// Messages list the extensions in this order.
formats! {
    /// BVH, a joint hierarchy and one motion, as text.
    Bvh = bvh::BVH,
    /// Motion of AMASS and the SMPL family, an archive of numpy arrays.
    Npz = npz::NPZ,
    /// FBX, binary or text.
    Fbx = fbx::FBX,
    /// glTF 2.0 as one binary file.
    Glb = gltf::GLB,
    /// glTF 2.0 as JSON with its buffers in separate files.
    Gltf = gltf::GLTF,
    /// VRM 1.0, a humanoid character as a binary glTF.
    Vrm = vrm::VRM,
    /// VRM Animation 1.0, the motion of a humanoid as a binary glTF.
    Vrma = vrm::VRMA,
    /// USD as text.
    Usda = usd::USDA,
    /// USD as a crate file, its binary encoding.
    Usdc = usd::USDC,
    /// USD as a package, a zip archive with a crate file.
    Usdz = usd::USDZ,
    /// Wavefront OBJ, meshes only.
    Obj = obj::OBJ,
    /// USD as text or as a crate.
    Usd = usd::USD,
}

/// What a format can store, whether or not this library reads or writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Holds {
    /// Meshes.
    pub meshes: bool,
    /// A joint tree.
    pub skeleton: bool,
    /// Motions.
    pub clips: bool,
}

/// What a file is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// [`read_motion`](super::read_motion).
    ReadMotion,
    /// [`read_scene`](super::read_scene).
    ReadScene,
    /// [`read_meshes`](super::read_meshes).
    ReadMeshes,
    /// [`write_scene`](super::write_scene).
    WriteScene,
}

/// Reads a motion from a file's bytes. The path is for messages, files beside it, and the name of an unnamed clip.
pub(crate) type ReadMotion = fn(&[u8], &Path, &ReadOptions) -> Result<RawMotion>;
/// Reads a scene from a file's bytes. The path is for messages and files beside it.
pub(crate) type ReadScene = fn(&[u8], &Path) -> Result<Scene>;

/// How a format is written.
#[derive(Clone, Copy)]
pub(crate) enum Write {
    /// As one file.
    Alone(fn(&Scene, &WriteOptions) -> Result<Vec<u8>>),
    /// As a document and a buffer in a separate file with the given name.
    WithBuffer(fn(&Scene, &str, &WriteOptions) -> Result<gltf::GltfFiles>),
}

/// The description of a format, from its folder.
pub(crate) struct Description {
    /// File extension, in lower case, without the dot.
    pub(crate) extension: &'static str,
    /// Display name.
    pub(crate) title: &'static str,
    pub(crate) holds: Holds,
    pub(crate) read_motion: Option<ReadMotion>,
    pub(crate) read_scene: Option<ReadScene>,
    pub(crate) read_meshes: Option<ReadScene>,
    pub(crate) write: Option<Write>,
}

impl Format {
    /// File extension, in lower case, without the dot: `glb`.
    pub const fn extension(self) -> &'static str {
        self.description().extension
    }

    /// Display name: `glTF 2.0, binary`.
    pub const fn title(self) -> &'static str {
        self.description().title
    }

    /// What the format can store.
    pub const fn holds(self) -> Holds {
        self.description().holds
    }

    /// Whether the library supports the format for this purpose.
    pub fn serves(self, purpose: Purpose) -> bool {
        purpose.is_served_by(self.description())
    }

    /// The formats supported for a purpose, in the order in which messages list them.
    pub fn serving(purpose: Purpose) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |format| format.serves(purpose))
    }

    /// The format with this file extension, without the dot, in any case.
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|format| format.extension().eq_ignore_ascii_case(extension))
    }

    /// The format of a path's extension, in any case, for a purpose.
    ///
    /// # Errors
    /// [`Error::File`] for a path without an extension or with one not supported for the purpose; it lists those that are.
    pub fn of_path(path: &Path, purpose: Purpose) -> Result<Self> {
        able(path, |description| purpose.is_served_by(description).then_some(())).map(|(format, ())| format)
    }

    /// The single-file output format with this extension, as hosts name it.
    ///
    /// # Errors
    /// [`Error::Request`] for any other name; it lists the valid ones.
    pub fn of_one_file(name: &str) -> Result<Self> {
        Self::of_extension(name)
            .filter(|format| format.is_one_file())
            .ok_or_else(|| Self::one_file_fault(name))
    }

    fn is_one_file(self) -> bool {
        matches!(self.description().write, Some(Write::Alone(_)))
    }

    /// The error for a format that is not written as a single file.
    pub(super) fn one_file_fault(name: &str) -> Error {
        let one_file = Self::ALL.iter().copied().filter(|format| format.is_one_file());
        let known: Vec<&str> = one_file.map(Self::extension).collect();
        let expected = format!("expected one of {}, which are one file each", known.join(" "));
        Error::request("format", format!("{expected}, got `{name}`"))
    }

    /// How the format is written, if it is.
    pub(super) fn writer(self) -> Option<Write> {
        self.description().write
    }
}

impl Purpose {
    fn is_served_by(self, description: &Description) -> bool {
        match self {
            Self::ReadMotion => description.read_motion.is_some(),
            Self::ReadScene => description.read_scene.is_some(),
            Self::ReadMeshes => description.read_meshes.is_some(),
            Self::WriteScene => description.write.is_some(),
        }
    }
}

/// The format of a path's extension, in any case, and its ability, among the formats that have that ability.
///
/// # Errors
/// [`Error::File`] for any other extension; it lists those that have it.
pub(super) fn able<T>(
    path: &Path,
    ability: impl Fn(&'static Description) -> Option<T>,
) -> Result<(Format, T)> {
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    let found =
        Format::of_extension(extension).and_then(|format| Some((format, ability(format.description())?)));
    found.ok_or_else(|| {
        let able = Format::ALL.iter().filter(|format| ability(format.description()).is_some());
        let known: Vec<String> = able.map(|format| format!(".{}", format.extension())).collect();
        Error::file(path, FormatError::Extension { expected: known.join(" ") })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extensions(purpose: Purpose) -> String {
        Format::serving(purpose).map(Format::extension).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn each_purpose_has_its_formats() {
        assert_eq!(extensions(Purpose::ReadMotion), "bvh npz fbx glb gltf vrm vrma usda usdc usdz usd");
        assert_eq!(extensions(Purpose::ReadScene), "glb gltf vrm usda usdc usdz usd");
        assert_eq!(extensions(Purpose::ReadMeshes), "glb gltf vrm usda usdc usdz obj usd");
        assert_eq!(extensions(Purpose::WriteScene), "glb gltf vrm vrma usda usdc usdz obj");
    }

    #[test]
    fn what_a_format_is_used_for_it_has_words_for() {
        for format in Format::ALL.iter().copied() {
            let holds = format.holds();
            // Other programs leave animations in `.vrm` files, which are to hold none.
            let moves = holds.clips || format == Format::Vrm;
            assert!(moves || !format.serves(Purpose::ReadMotion), "{format:?}");
            assert!(holds.skeleton || !format.serves(Purpose::ReadScene), "{format:?}");
            assert!(holds.meshes || !format.serves(Purpose::ReadMeshes), "{format:?}");
            assert_eq!(format.extension(), format!("{format:?}").to_lowercase());
            assert_eq!(Format::of_extension(&format.extension().to_uppercase()), Some(format));
            assert!(!format.title().is_empty());
        }
    }

    #[test]
    fn the_extension_of_a_path_tells_the_format() {
        let of = |path: &str| Format::of_path(Path::new(path), Purpose::ReadScene);
        assert_eq!(of("a/b.c.GLB").unwrap(), Format::Glb);
        for path in ["b.bvh", "b", "glb", "b.", "b.glb.txt", ""] {
            let message = of(path).unwrap_err().to_string();
            let expected = "unknown file extension, expected one of .glb .gltf .vrm .usda .usdc .usdz .usd";
            assert!(message.ends_with(expected), "{message}");
        }
        assert_eq!(Format::of_one_file("GLB").unwrap(), Format::Glb);
        let message = Format::of_one_file("gltf").unwrap_err().to_string();
        assert!(message.contains(
            "expected one of glb vrm vrma usda usdc usdz obj, which are one file each, got `gltf`"
        ));
    }
}
