//! One layer of scene description, with checks before and around the parser.

use std::borrow::Cow;
use std::fmt::Display;

use openusd::sdf::{AbstractData, ChildrenKey, FieldKey, Path, SpecType, Specifier, Value};
use openusd::{usda, usdc, usdz};

use crate::error::{Fault, ParserError, Within};
use crate::format::guard::guarded;
use crate::format::usd::Result;
use crate::text;

/// Maximum number of prims of a layer.
const MAX_PRIMS: usize = 1 << 20;
/// Maximum nesting of brackets in text: the parser recurses for each.
const MAX_NESTING: usize = 256;

/// A layer whose values are decoded on demand.
pub(crate) struct Layer(Box<dyn AbstractData>);

impl Layer {
    /// Opens the bytes of a `.usda`, `.usdc` or `.usdz`, identified by their first bytes.
    pub(crate) fn open(bytes: &[u8]) -> Result<Self> {
        let data: Box<dyn AbstractData> = if bytes.starts_with(usdc::MAGIC) {
            Box::new(guarded(|| usdc::CrateData::open(bytes.to_vec(), true))?)
        } else if bytes.starts_with(b"PK\x03\x04") {
            return Self::open_package(bytes);
        } else {
            let text = text::decode(bytes)?;
            let text = str::from_utf8(&text).map_err(|e| {
                let found = format!("what is not UTF-8 from byte {}", e.valid_up_to());
                Fault::unexpected("USD text, a crate or a package", found)
            })?;
            if !text.trim_start().starts_with("#usda ") {
                let start: String = text.chars().take(12).collect();
                let found = format!("a file that starts with {start:?}");
                return Err(Fault::unexpected("`#usda 1.0`, a crate or a package", found).into());
            }
            check_nesting(text)?;
            Box::new(guarded(|| usda::parse(text))?)
        };
        Ok(Self(data))
    }

    fn open_package(bytes: &[u8]) -> Result<Self> {
        let layer = guarded(|| {
            let mut archive = usdz::Archive::from_bytes(bytes.to_vec())?;
            let name = archive.first_layer_name().ok_or(usdz::ArchiveError::NoDefaultLayer)?;
            archive.entry(&name)
        })?;
        if layer.starts_with(b"PK") {
            return Err(Fault::unsupported("a package within a package").into());
        }
        Self::open(&layer)
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
                if self.0.spec_type(&child) == Some(SpecType::Prim) && defined && !inactive {
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
        let value = guarded(|| self.0.try_field(path, field).map(|value| value.map(Cow::into_owned)));
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

/// The path of a property.
fn property_path(prim: &Path, property: &str) -> Result<Path> {
    prim.append_property(property).map_err(|e| refused(format_args!("{prim}.{property}"), e).into())
}

/// The error for a name that the parser refuses.
fn refused(place: impl Display, error: impl Display) -> ParserError {
    ParserError::refused(format_args!("{place}: {error}"))
}

/// Refuses text with deeper nested brackets than any real layer, to protect the parser's stack.
fn check_nesting(text: &str) -> Result<()> {
    let (mut depth, mut line) = (0_usize, 1);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let quote =
            ["\"\"\"", "'''", "\"", "'", "@@@", "@"].into_iter().find(|quote| rest.starts_with(quote));
        let skipped = match (c, quote) {
            ('#', _) => rest.find('\n').unwrap_or(rest.len()),
            (_, Some(quote)) => quote.len() + quoted(&rest[quote.len()..], quote),
            _ => c.len_utf8(),
        };
        line += rest[..skipped].bytes().filter(|b| *b == b'\n').count();
        rest = &rest[skipped..];
        match c {
            '{' | '[' | '(' => depth += 1,
            '}' | ']' | ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MAX_NESTING {
            return Err(Fault::too_many(format_args!("{MAX_NESTING} nested brackets"), "more").into())
                .within(format_args!("line {line}"));
        }
    }
    Ok(())
}

/// Number of bytes up to and including the closing quote.
fn quoted(text: &str, quote: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices() {
        if !escaped && text[at..].starts_with(quote) {
            return at + quote.len();
        }
        escaped = !escaped && c == '\\' && quote != "@";
    }
    text.len()
}
