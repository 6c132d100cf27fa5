//! Composition of a file with the layers that it is made of: sublayers, references, payloads, chosen variants, inherits.
//!
//! The result is one layer, with the opinions of all of them in USD's order of strength. Only files in the folder of the
//! document or below it are read, as a file that somebody sends should not read others of the machine.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use openusd::ar::{self, Asset, DefaultResolver, ResolvedPath, Resolver};
use openusd::sdf::{AbstractData, FieldKey};
use openusd::usd::Stage;
use openusd::usd_utils::compute_all_dependencies;
use openusd::{sdf, usdc};

use super::layer::MAX_PRIMS;
use super::text;
use crate::error::{Fault, UsdError};
use crate::format::disk;
use crate::format::guard::guarded;
use crate::format::usd::Result;

/// Fields by which a prim, or a layer, has opinions elsewhere.
const ARCS: [FieldKey; 6] = [
    FieldKey::SubLayers,
    FieldKey::References,
    FieldKey::Payload,
    FieldKey::InheritPaths,
    FieldKey::Specializes,
    FieldKey::VariantSetNames,
];

/// Maximum number of sentences about what is not composed.
const MAX_NOTES: usize = 8;

/// A composed file.
pub(super) struct Composed {
    pub(super) layer: sdf::Layer,
    /// What could not be composed, one sentence each.
    pub(super) missing: Vec<String>,
    /// Prims with value clips, which are lost.
    pub(super) value_clips: Vec<sdf::Path>,
}

/// Whether a layer is more than it says itself.
pub(super) fn has_arcs(layer: &dyn AbstractData) -> bool {
    let paths = layer.spec_paths();
    paths.iter().any(|path| ARCS.iter().any(|arc| layer.has_field(path, arc.as_str())))
}

/// Composes the document at `path`, whose bytes are these.
pub(super) fn compose(bytes: &[u8], path: &Path) -> Result<Composed> {
    let outside = Rc::default();
    let resolver = Folder::new(bytes, path, Rc::clone(&outside));
    let root = resolver.root.clone();
    let stage = guarded(|| Stage::builder().resolver(resolver).open(&root))?;
    let value_clips = check_prims(&stage)?;
    let layer = guarded(|| stage.flatten())?;
    let outside = outside.borrow();
    let mut missing: Vec<String> = stage
        .composition_errors()
        .iter()
        .map(|error| {
            let error = error.to_string();
            match outside.iter().find(|asset| error.contains(asset.as_str())) {
                Some(_) => format!("{error}: outside the folder of the file"),
                None => error,
            }
        })
        .collect();
    if missing.len() > MAX_NOTES {
        let more = missing.len() - MAX_NOTES;
        missing.truncate(MAX_NOTES);
        missing.push(format!("{more} more"));
    }
    Ok(Composed { layer, missing, value_clips })
}

/// The layers and assets that a document is made of or refers to, of those in its folder or below it.
pub(super) fn files(bytes: &[u8], path: &Path) -> Vec<PathBuf> {
    let resolver = Folder::new(bytes, path, Rc::default());
    let root = resolver.root.clone();
    let files = guarded(|| {
        let stage = Stage::builder().resolver(resolver).open(&root)?;
        let all = compute_all_dependencies(&stage, &root)?;
        Ok::<_, openusd::Error>([all.layers, all.assets, all.unresolved].concat())
    });
    let files = files.unwrap_or_default();
    let outer = |file: String| ar::split_package_relative_path_outer(&file).map_or(file, |(outer, _)| outer);
    files.into_iter().filter(|file| *file != root).map(|file| outer(file).into()).collect()
}

/// Refuses a stage of too many prims before it is flattened: references of references multiply. Returns those with value clips.
fn check_prims(stage: &Stage) -> Result<Vec<sdf::Path>> {
    let mut open = vec![sdf::Path::abs_root()];
    let mut count = 0;
    let mut value_clips = Vec::new();
    while let Some(path) = open.pop() {
        let prim = guarded(|| stage.prim(&path))?;
        if guarded(|| prim.has_clips())? {
            value_clips.push(path);
        }
        let children = guarded(|| prim.children())?;
        count += children.len();
        if count > MAX_PRIMS {
            return Err(Fault::too_many(format_args!("{MAX_PRIMS} prims"), "more").into());
        }
        open.extend(children.iter().map(|child| child.path().clone()));
    }
    Ok(value_clips)
}

/// Finds layers in the folder of the document or below it.
struct Folder {
    disk: DefaultResolver,
    /// The document's absolute path, with the extension of its content.
    root: String,
    bytes: Vec<u8>,
    folder: PathBuf,
    /// Files that were asked for and are elsewhere.
    outside: Rc<RefCell<BTreeSet<String>>>,
}

impl Folder {
    fn new(bytes: &[u8], path: &Path, outside: Rc<RefCell<BTreeSet<String>>>) -> Self {
        let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let package = bytes.starts_with(b"PK\x03\x04");
        let known = name.to_lowercase().ends_with(if package { ".usdz" } else { ".usd" });
        // `.usd` is what is told apart by its content; here any file is.
        let extension = match (known, package) {
            (true, _) => "",
            (false, true) => ".usdz",
            (false, false) => ".usd",
        };
        let root = folder.join(format!("{name}{extension}")).to_string_lossy().into_owned();
        Self { disk: DefaultResolver::new(), root, bytes: bytes.to_vec(), folder, outside }
    }
}

impl Resolver for Folder {
    fn create_identifier(&self, asset_path: &str, anchor: Option<&ResolvedPath>) -> String {
        self.disk.create_identifier(asset_path, anchor)
    }

    fn resolve(&self, asset_path: &str) -> Option<ResolvedPath> {
        if asset_path == self.root {
            return Some(ResolvedPath::new(asset_path));
        }
        let found = self.disk.resolve(asset_path)?;
        if found.starts_with(&self.folder) {
            return Some(found);
        }
        self.outside.borrow_mut().insert(asset_path.to_owned());
        None
    }

    fn resolve_for_new_asset(&self, _: &str) -> Option<ResolvedPath> {
        None
    }

    fn open_asset(&self, resolved: &ResolvedPath) -> io::Result<Box<dyn Asset>> {
        let path = resolved.to_string();
        let bytes = if path == self.root {
            self.bytes.clone()
        } else if ar::is_package_relative_path(&path) {
            self.disk.open_asset(resolved)?.read_all()?
        } else {
            disk::read(resolved).map_err(io::Error::other)?
        };
        let is_text = !bytes.starts_with(usdc::MAGIC) && !bytes.starts_with(b"PK\x03\x04");
        let bytes = match is_text {
            true => text::text(&bytes).map_err(|e: UsdError| io::Error::other(e))?.into_owned().into_bytes(),
            false => bytes,
        };
        Ok(Box::new(io::Cursor::new(bytes)))
    }

    fn is_context_dependent_path(&self, asset_path: &str) -> bool {
        self.disk.is_context_dependent_path(asset_path)
    }
}
