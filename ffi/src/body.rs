//! Bodies: what a model makes of a request, and the report of it.

use anthronet::Body;
use anthronet::condition::Filled;
use anthronet::measure::{MEASURE_COUNT, Sex};

use crate::bytes::anthronet_bytes;
use crate::model::anthronet_model;
use crate::options::{Descriptor, DescriptorOut};
use crate::pointer::{Out, OutSlice, exactly, free, read};
use crate::request::{ANTHRONET_SEX_FEMALE, ANTHRONET_SEX_MALE, anthronet_request};
use crate::status::{anthronet_error, anthronet_status, guard};

/// A person in the bind pose, with the report of how it was made. Immutable.
pub struct anthronet_body {
    pub(crate) body: Body,
}

impl anthronet_body {
    pub(crate) fn new(body: Body) -> Self {
        for warning in &body.report().warnings {
            crate::log::warning(warning);
        }
        Self { body }
    }
}

/// One measure of a body. Metres.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_measure_report {
    /// The value in the request; 0 for a filled measure.
    pub asked: f64,
    /// The value of the body.
    pub obtained: f64,
    /// Obtained − asked; 0 for a filled measure.
    pub residual: f64,
    /// Lower end of what 90 % of people with the given measures have; the value itself for a given measure.
    pub low90: f64,
    /// Upper end of that interval.
    pub high90: f64,
    /// Share of people of this sex, 0 to 100, who have at most the obtained value.
    pub percentile: f64,
    /// 1 if the request gives it, else 0.
    pub given: u32,
    /// How a measure that is not given was filled: `ANTHRONET_FILL_…`; 0 for a given one.
    pub filled: u32,
}

/// A body in numbers.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_body_summary {
    /// Set by the caller: `sizeof(anthronet_body_summary)`.
    pub struct_size: u32,
    /// `ANTHRONET_SEX_FEMALE` or `ANTHRONET_SEX_MALE`.
    pub sex: u32,
    /// The request's seed.
    pub seed: u64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Volume, m³.
    pub volume_m3: f64,
    /// Body mass index, kg/m².
    pub bmi: f64,
    /// Largest |obtained − asked| over the given measures, metres.
    pub solve_residual: f64,
    /// Steps of the exact solve.
    pub iterations: u32,
    /// 1 if the solve met its tolerance.
    pub converged: u32,
    /// Number of joints.
    pub joint_count: u32,
    /// Number of warnings in the report.
    pub warning_count: u32,
}

// SAFETY: numbers alone, the size first.
unsafe impl Descriptor for anthronet_body_summary {}

/// Makes the body that a request describes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_generate(
    model: *const anthronet_model,
    request: *const anthronet_request,
    out_body: *mut *mut anthronet_body,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_body, "out_body")?;
        let (model, request) = (read(model, "model")?, read(request, "request")?);
        out.give(anthronet_body::new(model.0.generate(&request.0)?));
        Ok(())
    })
}

/// Makes a body between two requests: `t` = 0 is the first, 1 the second; measures and identity are interpolated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_interpolate(
    model: *const anthronet_model,
    from: *const anthronet_request,
    to: *const anthronet_request,
    t: f64,
    out_body: *mut *mut anthronet_body,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_body, "out_body")?;
        let (model, from, to) = (read(model, "model")?, read(from, "from")?, read(to, "to")?);
        out.give(anthronet_body::new(model.0.interpolate(&from.0, &to.0, t)?));
        Ok(())
    })
}

/// Frees a body; NULL is nothing. What was made of it stays whole.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_body_free(body: *mut anthronet_body) {
    free(body);
}

/// The report as JSON: `{"measures": [{"name", "asked", "obtained", …}], "warnings", "conflicts", "seed", …}`; metres.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_body_report(
    body: *const anthronet_body,
    out_json: *mut *mut anthronet_bytes,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_json, "out_json")?;
        out.give(anthronet_bytes(read(body, "body")?.body.report().to_json().into_bytes()));
        Ok(())
    })
}

/// The report's measures: fills `count` entries, one per measure, in the order of `anthronet_measure_name`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_body_measures(
    body: *const anthronet_body,
    out_measures: *mut anthronet_measure_report,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        exactly("count", MEASURE_COUNT, count.into())?;
        let report = read(body, "body")?.body.report();
        let mut out = OutSlice::new(out_measures, count.into(), "out_measures")?;
        out.write(report.measures.iter().map(|measure| anthronet_measure_report {
            asked: measure.asked.unwrap_or_default(),
            obtained: measure.obtained,
            residual: measure.residual.unwrap_or_default(),
            low90: measure.low90,
            high90: measure.high90,
            percentile: measure.percentile,
            given: measure.given.into(),
            filled: (measure.filled == Filled::PriorSample).into(),
        }));
        Ok(())
    })
}

/// Sex, seed, mass and how the solve went.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_body_summarise(
    body: *const anthronet_body,
    out_summary: *mut anthronet_body_summary,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = DescriptorOut::new(out_summary, "out_summary")?;
        let body = &read(body, "body")?.body;
        let report = body.report();
        out.write(&anthronet_body_summary {
            struct_size: 0,
            sex: match body.sex() {
                Sex::Female => ANTHRONET_SEX_FEMALE,
                Sex::Male => ANTHRONET_SEX_MALE,
            },
            seed: report.seed,
            mass_kg: report.mass_kg,
            volume_m3: report.volume_m3,
            bmi: report.bmi,
            solve_residual: report.solve_residual,
            iterations: report.iterations as u32,
            converged: report.converged.into(),
            joint_count: body.skeleton().len() as u32,
            warning_count: report.warnings.len() as u32,
        });
        Ok(())
    })
}

/// The latent numbers of the body: fills `count` entries, as many as `anthronet_model_latent_size` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_body_latent(
    body: *const anthronet_body,
    out_latent: *mut f64,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let z = &read(body, "body")?.body.report().z;
        exactly("count", z.len(), count.into())?;
        OutSlice::new(out_latent, count.into(), "out_latent")?.write(z.iter().copied());
        Ok(())
    })
}
