//! Named arrays, as model files store them.

use std::collections::BTreeMap;

use crate::{Error, Result};

/// A named array as stored in a model file, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    /// Sizes, outermost first.
    pub shape: Vec<usize>,
    /// As many values as the product of the sizes.
    pub data: Vec<f32>,
}

/// Arrays by name.
pub type Tensors = BTreeMap<String, Tensor>;

/// Shapes of arrays by name.
pub type Shapes = BTreeMap<String, Vec<usize>>;

/// Copies one array's data from the set; checks its shape, length and that all numbers are finite.
pub(super) fn take(tensors: &Tensors, shapes: &Shapes, name: &str) -> Result<Vec<f32>> {
    let bad = |message: String| Error::Model { origin: format!("tensor `{name}`"), message };
    let expected = shapes.get(name).ok_or_else(|| bad("not part of this network".into()))?;
    let tensor =
        tensors.get(name).ok_or_else(|| bad(format!("expected shape {expected:?}, it is missing")))?;
    if &tensor.shape != expected {
        return Err(bad(format!("expected shape {expected:?}, got {:?}", tensor.shape)));
    }
    let count: usize = expected.iter().product();
    if tensor.data.len() != count {
        return Err(bad(format!("expected {count} values, got {}", tensor.data.len())));
    }
    if let Some(i) = tensor.data.iter().position(|v| !v.is_finite()) {
        return Err(bad(format!("expected finite values, got {} at {i}", tensor.data[i])));
    }
    Ok(tensor.data.clone())
}
