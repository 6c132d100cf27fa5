//! Requests: the input of a model.

use std::ffi::c_char;

use anthronet::condition::{Fill, Request};
use anthronet::measure::{MEASURE_COUNT, Sex};
use anthronet::network::config::MAX_LATENT;

use crate::bytes::anthronet_bytes;
use crate::options::{choice, flag};
use crate::pointer::{Out, OutSlice, at_most, beyond, change, exactly, finite, free, read, slice, text};
use crate::status::{anthronet_error, anthronet_status, guard};

/// Inferred from the measures.
pub const ANTHRONET_SEX_ANY: u32 = 0;
/// Female.
pub const ANTHRONET_SEX_FEMALE: u32 = 1;
/// Male.
pub const ANTHRONET_SEX_MALE: u32 = 2;

/// Measures that are not given get their most likely values, given the others.
pub const ANTHRONET_FILL_MEAN: u32 = 0;
/// Measures that are not given are drawn from their distribution, given the others; the seed chooses.
pub const ANTHRONET_FILL_SAMPLE: u32 = 1;

/// A person to be made. One thread at a time may change it.
pub struct anthronet_request(pub(crate) Request);

/// A request without given measures: the most likely person.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_new(
    out_request: *mut *mut anthronet_request,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        Out::new(out_request, "out_request")?.give(anthronet_request(Request::default()));
        Ok(())
    })
}

/// A request from JSON: `{"sex": "female", "measures": {"height": 1.7}, "seed": 7}`; metres.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_from_json(
    json: *const c_char,
    json_length: u64,
    out_request: *mut *mut anthronet_request,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_request, "out_request")?;
        out.give(anthronet_request(Request::from_json(text(json, json_length, "json")?)?));
        Ok(())
    })
}

/// A copy of a request.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_copy(
    request: *const anthronet_request,
    out_request: *mut *mut anthronet_request,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_request, "out_request")?;
        out.give(anthronet_request(read(request, "request")?.0.clone()));
        Ok(())
    })
}

/// Frees a request; NULL is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_free(request: *mut anthronet_request) {
    free(request);
}

/// The request as JSON, in the form that `anthronet_request_from_json` reads.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_to_json(
    request: *const anthronet_request,
    out_json: *mut *mut anthronet_bytes,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_json, "out_json")?;
        out.give(anthronet_bytes(read(request, "request")?.0.to_json().into_bytes()));
        Ok(())
    })
}

/// Sets the sex: `ANTHRONET_SEX_…`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_set_sex(
    request: *mut anthronet_request,
    sex: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let sex = choice(&[None, Some(Sex::Female), Some(Sex::Male)], sex, "sex")?;
        change(request, "request")?.0.sex = sex;
        Ok(())
    })
}

/// Sets a measure by its name, metres; a name without its side, such as `arm_length`, sets both sides.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_set_measure(
    request: *mut anthronet_request,
    name: *const c_char,
    name_length: u64,
    metres: f64,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let name = text(name, name_length, "name")?;
        finite(name, metres)?;
        Ok(change(request, "request")?.0.set(name, metres)?)
    })
}

/// Sets or unsets all measures at once: `metres` and `given` (0 or 1) have one entry per measure in the order of
/// `anthronet_measure_name`; `count` is their number. `metres` of a measure that is not given is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_set_measures(
    request: *mut anthronet_request,
    metres: *const f64,
    given: *const u8,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        exactly("count", MEASURE_COUNT, count.into())?;
        let metres = slice(metres, count.into(), "metres")?;
        let given = slice(given, count.into(), "given")?;
        let mut measures = [None; MEASURE_COUNT];
        for (i, measure) in measures.iter_mut().enumerate() {
            let name = anthronet::measure::MeasureId::from_index(i).map_or("measure", |id| id.name());
            if flag(given[i].into(), "given")? {
                finite(name, metres[i])?;
                *measure = Some(metres[i]);
            }
        }
        change(request, "request")?.0.measures = measures;
        Ok(())
    })
}

/// The given measures: fills `out_metres` (0 for a measure that is not given) and `out_given`, `count` entries each, one per measure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_measures(
    request: *const anthronet_request,
    out_metres: *mut f64,
    out_given: *mut u8,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        exactly("count", MEASURE_COUNT, count.into())?;
        let measures = &read(request, "request")?.0.measures;
        let mut metres = OutSlice::new(out_metres, count.into(), "out_metres")?;
        let mut given = OutSlice::new(out_given, count.into(), "out_given")?;
        metres.write(measures.iter().map(|measure| measure.unwrap_or_default()));
        given.write(measures.iter().map(|measure| measure.is_some().into()));
        Ok(())
    })
}

/// Makes a measure not given, so that it is filled again; by its place in the order of `anthronet_measure_name`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_unset_measure(
    request: *mut anthronet_request,
    measure: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let measures = &mut change(request, "request")?.0.measures;
        let count = measures.len();
        *measures.get_mut(measure as usize).ok_or_else(|| beyond("measure", measure, count))? = None;
        Ok(())
    })
}

/// Sets the seed: 0 for the most likely person with these measures, any other number for another one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_set_seed(
    request: *mut anthronet_request,
    seed: u64,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        change(request, "request")?.0.seed = seed;
        Ok(())
    })
}

/// Sets the latent numbers, as many as `anthronet_model_latent_size` says; none (`count` 0) leaves them to the seed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_set_latent(
    request: *mut anthronet_request,
    latent: *const f64,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        at_most("latent", "numbers", MAX_LATENT as u64, count.into())?;
        let latent = slice(latent, count.into(), "latent")?;
        for (i, value) in latent.iter().enumerate() {
            finite(&format!("latent {i}"), *value)?;
        }
        change(request, "request")?.0.z = (!latent.is_empty()).then(|| latent.to_vec());
        Ok(())
    })
}

/// Sets how measures that are not given are filled: `ANTHRONET_FILL_…`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_set_fill(
    request: *mut anthronet_request,
    fill: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let fill = choice(&[Fill::Mean, Fill::Sample], fill, "fill")?;
        change(request, "request")?.0.fill = fill;
        Ok(())
    })
}

/// Whether measures that no person has together are replaced by the nearest that a person has (1), with a warning in the
/// report, or refused (0).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_request_set_nearest(
    request: *mut anthronet_request,
    nearest: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let nearest = flag(nearest, "nearest")?;
        change(request, "request")?.0.nearest = nearest;
        Ok(())
    })
}
