//! The measures and measuring.

use std::ffi::{c_char, c_void};
use std::path::Path;

use anthronet::measure::{MEASURE_COUNT, MeasureId};
use anthronet::mesh::Lod;
use anthronet::model::MeasuredMesh;

use crate::bytes::{anthronet_bytes, json};
use crate::model::anthronet_model;
use crate::options::{Descriptor, DescriptorOut, space};
use crate::pointer::{Out, OutSlice, anthronet_text, beyond, exactly, read, read_vectors, text};
use crate::status::{Fault, Outcome, anthronet_error, anthronet_status, guard};

/// Mass and volume of a measured mesh.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_measured {
    /// Set by the caller: `sizeof(anthronet_measured)`.
    pub struct_size: u32,
    /// The level of detail of the mesh, recognised by its number of vertices.
    pub lod: u32,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Volume, m³.
    pub volume_m3: f64,
    /// Body mass index, kg/m².
    pub bmi: f64,
}

// SAFETY: numbers alone, the size first.
unsafe impl Descriptor for anthronet_measured {}

/// Number of measures.
#[unsafe(no_mangle)]
pub extern "C" fn anthronet_measure_count() -> u32 {
    MEASURE_COUNT as u32
}

/// The name of a measure, such as `waist_circumference`; always valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_measure_name(
    measure: u32,
    out_name: *mut anthronet_text,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_name, "out_name")?;
        let id = MeasureId::from_index(measure as usize);
        out.write(anthronet_text::of(id.ok_or_else(|| beyond("measure", measure, MEASURE_COUNT))?.name()));
        Ok(())
    })
}

/// The place of a measure by its name, with its side.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_measure_index(
    name: *const c_char,
    name_length: u64,
    out_measure: *mut u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_measure, "out_measure")?;
        let name = text(name, name_length, "name")?;
        let unknown = || Fault::request(name, "is not a measure");
        out.write(MeasureId::from_name(name).ok_or_else(unknown)?.index() as u32);
        Ok(())
    })
}

/// Measures a body in its bind pose at any level of detail, sculpted or not: `positions` are the vertices of the body
/// alone in the model's order, three floats each, `stride` bytes apart (0: packed), metres, in `from_space`. Fills
/// `count` measures, as many as `anthronet_measure_count` says, metres; `out_measured` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_measure_mesh(
    model: *const anthronet_model,
    positions: *const c_void,
    vertex_count: u32,
    stride: u64,
    from_space: u32,
    out_metres: *mut f64,
    count: u32,
    out_measured: *mut anthronet_measured,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Results::new(out_metres, count, out_measured)?;
        let space = space(from_space)?;
        let model = read(model, "model")?;
        known(model, vertex_count)?;
        let mut vertices = read_vectors(positions, vertex_count.into(), stride, "positions")?;
        for vertex in &mut vertices {
            *vertex = space.to_ours(*vertex);
        }
        out.write(&model.0.measure_mesh(&vertices)?);
        Ok(())
    })
}

/// Measures the body of a file: .glb, .gltf, .vrm, .obj, .usd, .usda, .usdc or .usdz with the model's vertex order. Results as
/// of `anthronet_measure_mesh`. Other units and axes are found from the body, which is logged as a warning.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_measure_file(
    model: *const anthronet_model,
    path: *const c_char,
    path_length: u64,
    out_metres: *mut f64,
    count: u32,
    out_measured: *mut anthronet_measured,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Results::new(out_metres, count, out_measured)?;
        let model = read(model, "model")?;
        out.write(&measured_file(model, text(path, path_length, "path")?)?);
        Ok(())
    })
}

/// Measures the body of a file as `anthronet_measure_file` does, as JSON: `{"measures": [{"name", "value"}, …], "mass_kg",
/// "volume_m3", "bmi", "lod", "warnings"}`; metres. The warnings say in which unit and axes the file was read, if not in metres
/// with +Y up.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_measure_file_report(
    model: *const anthronet_model,
    path: *const c_char,
    path_length: u64,
    out_json: *mut *mut anthronet_bytes,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_json, "out_json")?;
        let model = read(model, "model")?;
        let found = measured_file(model, text(path, path_length, "path")?)?;
        let named = MeasureId::all().zip(found.measurements);
        out.give(json(&serde_json::json!({
            "measures": named.map(|(id, value)| serde_json::json!({ "name": id.name(), "value": value })).collect::<Vec<_>>(),
            "mass_kg": found.mass.mass_kg,
            "volume_m3": found.mass.volume_m3,
            "bmi": found.mass.bmi,
            "lod": u8::from(found.lod),
            "warnings": found.warnings,
        }))?);
        Ok(())
    })
}

/// Measures a file and logs its warnings.
fn measured_file(model: &anthronet_model, path: &str) -> Outcome<MeasuredMesh> {
    let found = anthronet::format::measure_file(&model.0, Path::new(path))?;
    found.warnings.iter().for_each(|warning| crate::log::warning(warning));
    Ok(found)
}

/// Refuses a number of vertices that no level of detail has.
fn known(model: &anthronet_model, vertex_count: u32) -> Outcome {
    let counts = Lod::ALL.map(|lod| model.0.character().vertex_count(lod));
    if counts.contains(&(vertex_count as usize)) {
        return Ok(());
    }
    let known = counts.map(|count| count.to_string()).join(", ");
    let message = format_args!("expected {known} vertices in the model's order, got {vertex_count}");
    Err(Fault::size("positions", message))
}

/// Where a measured mesh goes.
struct Results {
    metres: OutSlice<f64>,
    measured: Option<DescriptorOut<anthronet_measured>>,
}

impl Results {
    fn new(metres: *mut f64, count: u32, measured: *mut anthronet_measured) -> Outcome<Self> {
        exactly("count", MEASURE_COUNT, count.into())?;
        let measured = match measured.is_null() {
            true => None,
            false => Some(DescriptorOut::new(measured, "out_measured")?),
        };
        Ok(Self { metres: OutSlice::new(metres, count.into(), "out_metres")?, measured })
    }

    fn write(mut self, found: &MeasuredMesh) {
        self.metres.write(found.measurements);
        if let Some(out) = self.measured {
            out.write(&anthronet_measured {
                struct_size: 0,
                lod: u8::from(found.lod).into(),
                mass_kg: found.mass.mass_kg,
                volume_m3: found.mass.volume_m3,
                bmi: found.mass.bmi,
            });
        }
    }
}
