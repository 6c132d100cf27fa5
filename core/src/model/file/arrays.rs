//! The arrays of a model file, by name.

use half::f16;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};

use super::{METADATA_KEY, Metadata, model_error};
use crate::mesh::Topology;
use crate::model::character::ReducedMesh;
use crate::network::Tensor;
use crate::{Error, Result};

/// Arrays to write: name, element type, shape, bytes.
#[derive(Default)]
pub(super) struct Arrays(Vec<(String, Dtype, Vec<usize>, Vec<u8>)>);

impl Arrays {
    pub(super) fn add<T: bytemuck::NoUninit>(
        &mut self,
        name: &str,
        dtype: Dtype,
        shape: Vec<usize>,
        data: &[T],
    ) {
        self.0.push((name.to_owned(), dtype, shape, bytemuck::cast_slice(data).to_vec()));
    }

    pub(super) fn topology(&mut self, name: &str, topology: &Topology) {
        let faces = topology.quads.len();
        self.add(&format!("{name}.vertex_count"), Dtype::U32, vec![1], &[topology.vertex_count as u32]);
        self.add(&format!("{name}.quads"), Dtype::U32, vec![faces, 4], &topology.quads);
        self.add(&format!("{name}.uvs"), Dtype::F32, vec![topology.uvs.len(), 2], &topology.uvs);
        self.add(&format!("{name}.quad_uvs"), Dtype::U32, vec![faces, 4], &topology.quad_uvs);
    }

    pub(super) fn serialize(&self, metadata: &Metadata) -> Result<Vec<u8>> {
        let bad = |e: String| Error::invalid("model file", e);
        let views = self
            .0
            .iter()
            .map(|(name, dtype, shape, data)| {
                TensorView::new(*dtype, shape.clone(), data)
                    .map(|view| (name.clone(), view))
                    .map_err(|e| bad(format!("{name}: {e}")))
            })
            .collect::<Result<Vec<_>>>()?;
        let text = serde_json::to_string(metadata).map_err(|e| bad(e.to_string()))?;
        let extra = std::collections::HashMap::from([(METADATA_KEY.to_owned(), text)]);
        safetensors::serialize(views, Some(extra)).map_err(|e| bad(e.to_string()))
    }
}

/// The arrays of a file that is read; errors name its origin.
pub(super) struct Reader<'a> {
    pub(super) file: &'a SafeTensors<'a>,
    pub(super) origin: &'a str,
}

impl Reader<'_> {
    fn fail(&self, message: String) -> Error {
        model_error(self.origin, message)
    }

    /// The array's content as a list of `T`, whose size must divide it.
    pub(super) fn get<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
        &self,
        name: &str,
        dtype: Dtype,
    ) -> Result<Vec<T>> {
        let view = self.file.tensor(name).map_err(|e| self.fail(format!("array `{name}`: {e}")))?;
        if view.dtype() != dtype || view.data().len() % size_of::<T>() != 0 {
            return Err(self.fail(format!(
                "array `{name}`: expected {dtype:?}, got {:?} of shape {:?}",
                view.dtype(),
                view.shape()
            )));
        }
        Ok(bytemuck::pod_collect_to_vec(view.data()))
    }

    pub(super) fn topology(&self, name: &str) -> Result<Topology> {
        let count: Vec<u32> = self.get(&format!("{name}.vertex_count"), Dtype::U32)?;
        let topology = Topology {
            vertex_count: count.first().map_or(0, |n| *n as usize),
            quads: self.get(&format!("{name}.quads"), Dtype::U32)?,
            uvs: self.get(&format!("{name}.uvs"), Dtype::F32)?,
            quad_uvs: self.get(&format!("{name}.quad_uvs"), Dtype::U32)?,
        };
        topology.validate().map_err(|e| self.fail(e.to_string()))?;
        Ok(topology)
    }

    pub(super) fn reduced(&self, level: &str) -> Result<ReducedMesh> {
        Ok(ReducedMesh {
            vertices: self.get(&format!("{level}.vertices"), Dtype::U32)?,
            triangles: self.get(&format!("{level}.triangles"), Dtype::U32)?,
            triangle_uvs: self.get(&format!("{level}.triangle_uvs"), Dtype::U32)?,
        })
    }

    pub(super) fn network(&self, name: &str) -> Result<Tensor> {
        let view = self.file.tensor(name).map_err(|e| self.fail(format!("array `{name}`: {e}")))?;
        let data = match view.dtype() {
            Dtype::F32 => self.get::<f32>(name, Dtype::F32)?,
            _ => self.get::<f16>(name, Dtype::F16)?.iter().map(|x| x.to_f32()).collect(),
        };
        Ok(Tensor { shape: view.shape().to_vec(), data })
    }
}
