//! A layer under construction: prims, attributes, relationships, in the order in which they are added.

use std::fmt::Display;

use openusd::sdf::{
    AbstractData, AttributeSpecMut, Data, FieldKey, Path, PathListOp, PrimSpecMut, RelationshipSpecMut,
    Specifier, Value, Variability,
};

use crate::{Error, Result};

/// The error for a path or value that USD refuses; a scene that validates has none of these.
pub(super) fn fault(error: impl Display) -> Error {
    Error::invalid("USD layer", error.to_string())
}

/// Scene description, to be serialised.
#[derive(Default)]
pub(super) struct Layer(Data);

impl Layer {
    /// The data for a serialiser.
    pub(super) fn data(&self) -> &Data {
        &self.0
    }

    /// Defines a prim; `name` becomes its display name if the path ends with another name.
    pub(super) fn prim(&mut self, path: &str, name: &str, type_name: &str) -> Result<()> {
        let mut prim = PrimSpecMut::new(&mut self.0, path, Specifier::Def, type_name).map_err(fault)?;
        if !path.ends_with(&format!("/{name}")) {
            prim.set(FieldKey::DisplayName, Value::String(name.into()));
        }
        Ok(())
    }

    /// Applies an API schema to a prim.
    pub(super) fn apply(&mut self, path: &str, schema: &str) -> Result<()> {
        let mut prim = PrimSpecMut::over(&mut self.0, path).map_err(fault)?;
        prim.add_applied_schema(schema).map_err(fault)?;
        Ok(())
    }

    /// Sets a field of the layer (`/`), a prim or a property.
    pub(super) fn set(&mut self, path: &str, field: impl AsRef<str>, value: Value) -> Result<()> {
        let path = Path::new(path).map_err(fault)?;
        self.0.set_field(&path, field.as_ref(), value);
        Ok(())
    }

    /// Adds an attribute with a default value; returns its path.
    pub(super) fn attribute(
        &mut self,
        prim: &str,
        name: &str,
        type_name: &str,
        value: Value,
    ) -> Result<String> {
        self.declare(prim, name, type_name, Variability::Varying, Some(value))
    }

    /// Adds a uniform attribute, which cannot be animated; returns its path.
    pub(super) fn uniform(
        &mut self,
        prim: &str,
        name: &str,
        type_name: &str,
        value: Value,
    ) -> Result<String> {
        self.declare(prim, name, type_name, Variability::Uniform, Some(value))
    }

    /// Adds a uniform attribute that belongs to no schema.
    pub(super) fn custom(&mut self, prim: &str, name: &str, type_name: &str, value: Value) -> Result<()> {
        let path = format!("{prim}.{name}");
        AttributeSpecMut::new(&mut self.0, path.as_str(), type_name, Variability::Uniform, true)
            .map_err(fault)?
            .set_default(value)
            .map_err(fault)?;
        Ok(())
    }

    /// Adds an attribute, without a value if it will have connections or time samples; returns its path.
    pub(super) fn declare(
        &mut self,
        prim: &str,
        name: &str,
        type_name: &str,
        variability: Variability,
        value: Option<Value>,
    ) -> Result<String> {
        let path = format!("{prim}.{name}");
        let mut attribute = AttributeSpecMut::new(&mut self.0, path.as_str(), type_name, variability, false)
            .map_err(fault)?;
        if let Some(value) = value {
            attribute.set_default(value).map_err(fault)?;
        }
        Ok(path)
    }

    /// Connects an attribute to another.
    pub(super) fn connect(&mut self, attribute: &str, source: &str) -> Result<()> {
        let source = Path::new(source).map_err(fault)?;
        self.set(attribute, FieldKey::ConnectionPaths, Value::PathListOp(PathListOp::explicit([source])))
    }

    /// Adds a relationship with one target.
    pub(super) fn relate(&mut self, prim: &str, name: &str, target: &str) -> Result<()> {
        self.relate_all(prim, name, &[target])
    }

    /// Adds a relationship with these targets.
    pub(super) fn relate_all<T: AsRef<str>>(&mut self, prim: &str, name: &str, targets: &[T]) -> Result<()> {
        let path = format!("{prim}.{name}");
        RelationshipSpecMut::new(&mut self.0, path, Variability::Uniform, false)
            .map_err(fault)?
            .set_target_paths(targets.iter().map(AsRef::as_ref))
            .map_err(fault)
    }
}
