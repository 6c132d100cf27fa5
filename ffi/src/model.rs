//! Models.

use std::path::Path;
use std::sync::Arc;

use anthronet::model::Model;

use crate::bytes::anthronet_bytes;
use crate::options::lod;
use crate::pointer::{Out, beyond, file, free, read, text};
use crate::status::{Outcome, anthronet_error, anthronet_status, guard};

/// A trained model: makes bodies. Immutable; may be used by many threads at once.
pub struct anthronet_model(pub(crate) Arc<Model>);

fn open(
    out_model: *mut *mut anthronet_model,
    error: *mut anthronet_error,
    model: impl FnOnce() -> Outcome<Model>,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_model, "out_model")?;
        out.give(anthronet_model(Arc::new(model()?)));
        Ok(())
    })
}

/// Opens the model that the library carries.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_open_embedded(
    out_model: *mut *mut anthronet_model,
    error: *mut anthronet_error,
) -> anthronet_status {
    open(out_model, error, || Ok(Model::embedded()?))
}

/// Opens the model file that the environment variable `ANTHRONET_MODEL` names, and the embedded one where it names
/// none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_open_default(
    out_model: *mut *mut anthronet_model,
    error: *mut anthronet_error,
) -> anthronet_status {
    open(out_model, error, || Ok(Model::from_environment()?))
}

/// Opens a model file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_open_path(
    path: *const std::ffi::c_char,
    path_length: u64,
    out_model: *mut *mut anthronet_model,
    error: *mut anthronet_error,
) -> anthronet_status {
    open(out_model, error, || Ok(Model::open(Path::new(text(path, path_length, "path")?))?))
}

/// Opens a model from the bytes of its file, which are not needed afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_open_memory(
    data: *const u8,
    length: u64,
    out_model: *mut *mut anthronet_model,
    error: *mut anthronet_error,
) -> anthronet_status {
    open(out_model, error, || Ok(Model::from_bytes(file(data, length, "data")?)?))
}

/// Frees a model; NULL is nothing. Bodies and jobs made by it stay whole.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_free(model: *mut anthronet_model) {
    free(model);
}

/// What the model is, as JSON: measures with definitions and ranges, joints, versions, scores.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_info(
    model: *const anthronet_model,
    out_json: *mut *mut anthronet_bytes,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_json, "out_json")?;
        let model = read(model, "model")?;
        out.give(anthronet_bytes(model.0.info().to_string().into_bytes()));
        Ok(())
    })
}

/// Number of latent numbers of a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_latent_size(
    model: *const anthronet_model,
    out_size: *mut u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_size, "out_size")?;
        out.write(read(model, "model")?.0.latent_size() as u32);
        Ok(())
    })
}

/// Number of vertices of the body at a level of detail, 0 to 3, in the model's order.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_vertex_count(
    model: *const anthronet_model,
    level: u32,
    out_count: *mut u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_count, "out_count")?;
        out.write(read(model, "model")?.0.character().vertex_count(lod(level)?) as u32);
        Ok(())
    })
}

/// The smallest and largest value that a request may give of a measure, metres.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_model_measure_range(
    model: *const anthronet_model,
    measure: u32,
    out_min: *mut f64,
    out_max: *mut f64,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let (min, max) = (Out::new(out_min, "out_min")?, Out::new(out_max, "out_max")?);
        let ranges = read(model, "model")?.0.ranges();
        let range = ranges.get(measure as usize).ok_or_else(|| beyond("measure", measure, ranges.len()))?;
        min.write(range.min);
        max.write(range.max);
        Ok(())
    })
}
