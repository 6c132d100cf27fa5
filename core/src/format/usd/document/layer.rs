//! One layer of scene description, with checks before and around the parser.

use std::borrow::Cow;
use std::fmt::Display;

use openusd::sdf::{self, AbstractData, ChildrenKey, FieldKey, Path, SpecType, Specifier, Value};
use openusd::{usda, usdc, usdz};

use super::{compose, text};
use crate::error::{Fault, ParserError, Within};
use crate::format::guard::guarded;
use crate::format::usd::Result;

/// Maximum number of prims of a layer.
pub(super) const MAX_PRIMS: usize = 1 << 20;

/// A layer whose values are decoded on demand.
pub(crate) struct Layer(Content);

/// The values of a layer.
enum Content {
    Parsed(Box<dyn AbstractData>),
    Composed(Box<sdf::Layer>),
}

impl Layer {
    /// Opens the bytes of a text, crate or package file, identified by their first bytes, and composes it with the layers
    /// that it refers to in the folder of `path` or below. Returns what could not be composed, and the prims whose value clips
    /// composing lost.
    pub(crate) fn open(bytes: &[u8], path: &std::path::Path) -> Result<(Self, Vec<String>, Vec<Path>)> {
        let data = parse(bytes)?;
        if !compose::has_arcs(&*data) {
            return Ok((Self(Content::Parsed(data)), Vec::new(), Vec::new()));
        }
        let composed = compose::compose(bytes, path)?;
        Ok((Self(Content::Composed(Box::new(composed.layer))), composed.missing, composed.value_clips))
    }

    fn data(&self) -> &dyn AbstractData {
        match &self.0 {
            Content::Parsed(data) => &**data,
            Content::Composed(layer) => layer.data(),
        }
    }

    /// All active, defined prims in file order, parents first.
    pub(crate) fn prims(&self) -> Result<Vec<Path>> {
        let mut prims = Vec::new();
        let mut open = vec![Path::abs_root()];
        while let Some(prim) = open.pop() {
            let children = match self.field(&prim, ChildrenKey::PrimChildren.as_str())? {
                Some(Value::TokenVec(children)) => children,
                _ => Vec::new(),
            };
            for child in children.iter().rev() {
                let child = prim.append_path(child.as_str()).map_err(|e| refused(&prim, e))?;
                let inactive = self.field(&child, FieldKey::Active.as_str())? == Some(Value::Bool(false));
                let specifier = self.field(&child, FieldKey::Specifier.as_str())?;
                let defined = specifier == Some(Value::Specifier(Specifier::Def));
                if self.data().spec_type(&child) == Some(SpecType::Prim) && defined && !inactive {
                    open.push(child);
                }
            }
            if prims.len() + open.len() > MAX_PRIMS {
                return Err(Fault::too_many(format_args!("{MAX_PRIMS} prims"), "more").into());
            }
            if !prim.is_abs_root() {
                prims.push(prim);
            }
        }
        Ok(prims)
    }

    /// The default prim, or else the first prim.
    pub(crate) fn main_prim(&self, prims: &[Path]) -> Result<Option<Path>> {
        let named = self.text(&Path::abs_root(), FieldKey::DefaultPrim.as_str())?;
        let named = named.and_then(|name| prims.iter().find(|p| p.is_root_prim() && p.name() == Some(&name)));
        Ok(named.or(prims.first()).cloned())
    }

    /// A prim's type name; empty if it has none.
    pub(crate) fn type_name(&self, prim: &Path) -> Result<String> {
        Ok(self.text(prim, FieldKey::TypeName.as_str())?.unwrap_or_default())
    }

    /// A field of a prim, a property or the layer.
    pub(crate) fn field(&self, path: &Path, field: &str) -> Result<Option<Value>> {
        let value = guarded(|| self.data().try_field(path, field).map(|value| value.map(Cow::into_owned)));
        Ok(value?)
    }

    /// A field that holds a token or a string.
    pub(crate) fn text(&self, path: &Path, field: &str) -> Result<Option<String>> {
        Ok(match self.field(path, field)? {
            Some(Value::Token(text)) => Some(text.as_str().to_owned()),
            Some(Value::String(text)) => Some(text),
            _ => None,
        })
    }

    /// A number in the layer's metadata.
    pub(crate) fn number(&self, field: &str) -> Result<Option<f64>> {
        Ok(match self.field(&Path::abs_root(), field)? {
            Some(Value::Double(number)) => Some(number),
            Some(Value::Float(number)) => Some(f64::from(number)),
            Some(Value::Int(number)) => Some(f64::from(number)),
            _ => None,
        })
    }

    /// An attribute's default value.
    pub(crate) fn default(&self, prim: &Path, attribute: &str) -> Result<Option<Value>> {
        let path = property_path(prim, attribute)?;
        let value = self.field(&path, FieldKey::Default.as_str())?;
        Ok(value.filter(|value| !matches!(value, Value::ValueBlock | Value::None)))
    }

    /// An attribute's time samples, sorted by time code; without blocked ones.
    pub(crate) fn samples(&self, prim: &Path, attribute: &str) -> Result<Vec<(f64, Value)>> {
        let path = property_path(prim, attribute)?;
        let Some(Value::TimeSamples(mut samples)) = self.field(&path, FieldKey::TimeSamples.as_str())? else {
            return Ok(Vec::new());
        };
        if let Some((time, _)) = samples.iter().find(|(time, _)| !time.is_finite()) {
            return Err(Fault::not_finite("the time code of a sample", time).into()).within(path);
        }
        samples.retain(|(_, value)| !matches!(value, Value::ValueBlock | Value::None));
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(samples)
    }

    /// The default value of a token array attribute.
    pub(crate) fn tokens(&self, prim: &Path, attribute: &str) -> Result<Option<Vec<String>>> {
        Ok(match self.default(prim, attribute)? {
            Some(Value::TokenVec(tokens)) => Some(tokens.iter().map(|t| t.as_str().to_owned()).collect()),
            _ => None,
        })
    }

    /// The default value of a token attribute.
    pub(crate) fn text_value(&self, prim: &Path, attribute: &str) -> Result<Option<String>> {
        Ok(match self.default(prim, attribute)? {
            Some(Value::Token(token)) => Some(token.as_str().to_owned()),
            _ => None,
        })
    }

    /// A primvar's interpolation: `vertex`, `faceVarying`, `constant`.
    pub(crate) fn interpolation(&self, prim: &Path, attribute: &str) -> Result<Option<String>> {
        let path = property_path(prim, attribute)?;
        self.text(&path, "interpolation")
    }

    /// The first target of a relationship.
    pub(crate) fn target(&self, prim: &Path, relationship: &str) -> Result<Option<Path>> {
        self.first_path(prim, relationship, FieldKey::TargetPaths.as_str())
    }

    /// The first source that an attribute is connected to.
    pub(crate) fn source(&self, prim: &Path, attribute: &str) -> Result<Option<Path>> {
        self.first_path(prim, attribute, FieldKey::ConnectionPaths.as_str())
    }

    /// All targets of a relationship, in order.
    pub(crate) fn targets(&self, prim: &Path, relationship: &str) -> Result<Vec<Path>> {
        let path = property_path(prim, relationship)?;
        Ok(match self.field(&path, FieldKey::TargetPaths.as_str())? {
            Some(Value::PathListOp(list)) => list.iter().map(|target| prim.make_absolute(target)).collect(),
            _ => Vec::new(),
        })
    }

    fn first_path(&self, prim: &Path, property: &str, field: &str) -> Result<Option<Path>> {
        let path = property_path(prim, property)?;
        Ok(match self.field(&path, field)? {
            Some(Value::PathListOp(list)) => list.iter().next().map(|target| prim.make_absolute(target)),
            _ => None,
        })
    }
}

/// The values of one layer: the file itself, or the first layer of a package.
fn parse(bytes: &[u8]) -> Result<Box<dyn AbstractData>> {
    if bytes.starts_with(usdc::MAGIC) {
        return Ok(Box::new(guarded(|| usdc::CrateData::open(bytes.to_vec(), true))?));
    }
    if !bytes.starts_with(b"PK\x03\x04") {
        let text = text::text(bytes)?;
        return Ok(Box::new(guarded(|| usda::parse(&text))?));
    }
    let layer = guarded(|| {
        let mut archive = usdz::Archive::from_bytes(bytes.to_vec())?;
        let name = archive.first_layer_name().ok_or(usdz::ArchiveError::NoDefaultLayer)?;
        archive.entry(&name)
    })?;
    if layer.starts_with(b"PK") {
        return Err(Fault::unsupported("a package within a package").into());
    }
    parse(&layer)
}

/// The path of a property.
fn property_path(prim: &Path, property: &str) -> Result<Path> {
    prim.append_property(property).map_err(|e| refused(format_args!("{prim}.{property}"), e).into())
}

/// The error for a name that the parser refuses.
fn refused(place: impl Display, error: impl Display) -> ParserError {
    ParserError::refused(format_args!("{place}: {error}"))
}
