//! One layer of scene description, with checks before and around what parses it.

use openusd::sdf::{AbstractData, ChildrenKey, FieldKey, Path, SpecType, Specifier, Value};
use openusd::{usda, usdc, usdz};

use crate::error::Outcome;
use crate::format::guard::guarded;

/// Most prims of a layer.
const MAX_PRIMS: usize = 1 << 20;
/// Deepest nesting of brackets in text: the parser calls itself for each.
const MAX_NESTING: usize = 256;

/// A layer whose values are decoded when they are asked for.
pub(crate) struct Layer(Box<dyn AbstractData>);

impl Layer {
    /// Opens the bytes of a `.usda`, `.usdc` or `.usdz`, told apart by how they start.
    pub(crate) fn open(bytes: &[u8]) -> Outcome<Self> {
        let data: Box<dyn AbstractData> = if bytes.starts_with(usdc::MAGIC) {
            Box::new(guarded(|| usdc::CrateData::open(bytes.to_vec(), true))?)
        } else if bytes.starts_with(b"PK\x03\x04") {
            return Self::open_package(bytes);
        } else {
            let text = str::from_utf8(bytes).map_err(|e| {
                format!("expected USD text, a crate or a package; not UTF-8 from byte {}", e.valid_up_to())
            })?;
            if !text.trim_start().starts_with("#usda ") {
                let start: String = text.chars().take(12).collect();
                return Err(format!("expected `#usda 1.0`, a crate or a package; it starts with {start:?}"));
            }
            check_nesting(text)?;
            Box::new(guarded(|| usda::parse(text))?)
        };
        Ok(Self(data))
    }

    fn open_package(bytes: &[u8]) -> Outcome<Self> {
        let layer = guarded(|| {
            let mut archive = usdz::Archive::from_bytes(bytes.to_vec())?;
            let name = archive.first_layer_name().ok_or(usdz::ArchiveError::NoDefaultLayer)?;
            archive.entry(&name)
        })?;
        if layer.starts_with(b"PK") {
            return Err("a package within a package is not read".into());
        }
        Self::open(&layer)
    }

    /// All active, defined prims, parents first, in the file's order.
    pub(crate) fn prims(&self) -> Outcome<Vec<Path>> {
        let mut prims = Vec::new();
        let mut open = vec![Path::abs_root()];
        while let Some(prim) = open.pop() {
            let children = match self.field(&prim, ChildrenKey::PrimChildren.as_str())? {
                Some(Value::TokenVec(children)) => children,
                _ => Vec::new(),
            };
            for child in children.iter().rev() {
                let child = prim.append_path(child.as_str()).map_err(|e| format!("{prim}: {e}"))?;
                let inactive = self.field(&child, FieldKey::Active.as_str())? == Some(Value::Bool(false));
                let specifier = self.field(&child, FieldKey::Specifier.as_str())?;
                let defined = specifier == Some(Value::Specifier(Specifier::Def));
                if self.0.spec_type(&child) == Some(SpecType::Prim) && defined && !inactive {
                    open.push(child);
                }
            }
            if prims.len() + open.len() > MAX_PRIMS {
                return Err(format!("expected at most {MAX_PRIMS} prims"));
            }
            if !prim.is_abs_root() {
                prims.push(prim);
            }
        }
        Ok(prims)
    }

    /// The default prim, else the first below the root.
    pub(crate) fn main_prim(&self, prims: &[Path]) -> Outcome<Option<Path>> {
        let named = self.text(&Path::abs_root(), FieldKey::DefaultPrim.as_str())?;
        let named = named.and_then(|name| prims.iter().find(|p| p.is_root_prim() && p.name() == Some(&name)));
        Ok(named.or(prims.first()).cloned())
    }

    /// A prim's type; empty for none.
    pub(crate) fn type_name(&self, prim: &Path) -> Outcome<String> {
        Ok(self.text(prim, FieldKey::TypeName.as_str())?.unwrap_or_default())
    }

    /// A field of a prim, a property or the layer.
    pub(crate) fn field(&self, path: &Path, field: &str) -> Outcome<Option<Value>> {
        guarded(|| self.0.try_field(path, field).map(|value| value.map(std::borrow::Cow::into_owned)))
    }

    /// A field that holds a token or a string.
    pub(crate) fn text(&self, path: &Path, field: &str) -> Outcome<Option<String>> {
        Ok(match self.field(path, field)? {
            Some(Value::Token(text)) => Some(text.as_str().to_owned()),
            Some(Value::String(text)) => Some(text),
            _ => None,
        })
    }

    /// A number of the layer's own metadata.
    pub(crate) fn number(&self, field: &str) -> Outcome<Option<f64>> {
        Ok(match self.field(&Path::abs_root(), field)? {
            Some(Value::Double(number)) => Some(number),
            Some(Value::Float(number)) => Some(f64::from(number)),
            Some(Value::Int(number)) => Some(f64::from(number)),
            _ => None,
        })
    }

    /// An attribute's default value.
    pub(crate) fn default(&self, prim: &Path, attribute: &str) -> Outcome<Option<Value>> {
        let path = prim.append_property(attribute).map_err(|e| format!("{prim}.{attribute}: {e}"))?;
        let value = self.field(&path, FieldKey::Default.as_str())?;
        Ok(value.filter(|value| !matches!(value, Value::ValueBlock | Value::None)))
    }

    /// An attribute's samples over time codes, in order; blocked ones left out.
    pub(crate) fn samples(&self, prim: &Path, attribute: &str) -> Outcome<Vec<(f64, Value)>> {
        let path = prim.append_property(attribute).map_err(|e| format!("{prim}.{attribute}: {e}"))?;
        let Some(Value::TimeSamples(mut samples)) = self.field(&path, FieldKey::TimeSamples.as_str())? else {
            return Ok(Vec::new());
        };
        if let Some((time, _)) = samples.iter().find(|(time, _)| !time.is_finite()) {
            return Err(format!("{path}: a sample at time code {time}"));
        }
        samples.retain(|(_, value)| !matches!(value, Value::ValueBlock | Value::None));
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(samples)
    }

    /// An attribute of tokens.
    pub(crate) fn tokens(&self, prim: &Path, attribute: &str) -> Outcome<Option<Vec<String>>> {
        Ok(match self.default(prim, attribute)? {
            Some(Value::TokenVec(tokens)) => Some(tokens.iter().map(|t| t.as_str().to_owned()).collect()),
            _ => None,
        })
    }

    /// An attribute that holds one token.
    pub(crate) fn text_value(&self, prim: &Path, attribute: &str) -> Outcome<Option<String>> {
        Ok(match self.default(prim, attribute)? {
            Some(Value::Token(token)) => Some(token.as_str().to_owned()),
            _ => None,
        })
    }

    /// What an attribute's values stand for: `vertex`, `faceVarying`, `constant`.
    pub(crate) fn interpolation(&self, prim: &Path, attribute: &str) -> Outcome<Option<String>> {
        let path = prim.append_property(attribute).map_err(|e| format!("{prim}.{attribute}: {e}"))?;
        self.text(&path, "interpolation")
    }

    /// The first target of a relationship.
    pub(crate) fn target(&self, prim: &Path, relationship: &str) -> Outcome<Option<Path>> {
        self.first_path(prim, relationship, FieldKey::TargetPaths.as_str())
    }

    /// The first source that an attribute is connected to.
    pub(crate) fn source(&self, prim: &Path, attribute: &str) -> Outcome<Option<Path>> {
        self.first_path(prim, attribute, FieldKey::ConnectionPaths.as_str())
    }

    /// All targets of a relationship, in order.
    pub(crate) fn targets(&self, prim: &Path, relationship: &str) -> Outcome<Vec<Path>> {
        let path = prim.append_property(relationship).map_err(|e| format!("{prim}.{relationship}: {e}"))?;
        Ok(match self.field(&path, FieldKey::TargetPaths.as_str())? {
            Some(Value::PathListOp(list)) => list.iter().map(|target| prim.make_absolute(target)).collect(),
            _ => Vec::new(),
        })
    }

    fn first_path(&self, prim: &Path, property: &str, field: &str) -> Outcome<Option<Path>> {
        let path = prim.append_property(property).map_err(|e| format!("{prim}.{property}: {e}"))?;
        Ok(match self.field(&path, field)? {
            Some(Value::PathListOp(list)) => list.iter().next().map(|target| prim.make_absolute(target)),
            _ => None,
        })
    }
}

/// Refuses text whose brackets nest deeper than any layer's: the parser's stack is finite.
fn check_nesting(text: &str) -> Outcome<()> {
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
            return Err(format!("line {line}: brackets nest deeper than {MAX_NESTING}"));
        }
    }
    Ok(())
}

/// Bytes up to and with the closing quote.
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
