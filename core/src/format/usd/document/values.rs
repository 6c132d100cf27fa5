//! Conversion of USD's many vector types to `f64`.

use bytemuck::Pod;
use openusd::sdf::Value;

/// The components of a value or an array of values, flattened; `None` for anything but floating-point numbers, vectors,
/// quaternions and matrices. Quaternions are w, x, y, z; matrices row by row for row vectors, which is column by column for
/// column vectors.
pub(crate) fn numbers(value: &Value) -> Option<Vec<f64>> {
    use openusd::gf::f16;
    fn each<T: Pod, N: Pod + Into<f64>>(values: &[T]) -> Vec<f64> {
        bytemuck::cast_slice::<T, N>(values).iter().map(|n| (*n).into()).collect()
    }
    Some(match value {
        Value::Half(v) => each::<_, f16>(&[*v]),
        Value::Float(v) => each::<_, f32>(&[*v]),
        Value::Double(v) => each::<_, f64>(&[*v]),
        Value::Vec3h(v) => each::<_, f16>(&[*v]),
        Value::Vec3f(v) => each::<_, f32>(&[*v]),
        Value::Vec3d(v) => each::<_, f64>(&[*v]),
        Value::Quath(v) => each::<_, f16>(&[*v]),
        Value::Quatf(v) => each::<_, f32>(&[*v]),
        Value::Quatd(v) => each::<_, f64>(&[*v]),
        Value::Matrix4d(v) => v.0.to_vec(),
        Value::FloatVec(v) => each::<_, f32>(v),
        Value::Vec2fVec(v) => each::<_, f32>(v),
        Value::Vec2dVec(v) => each::<_, f64>(v),
        Value::Vec3hVec(v) => each::<_, f16>(v),
        Value::Vec3fVec(v) => each::<_, f32>(v),
        Value::Vec3dVec(v) => each::<_, f64>(v),
        Value::QuathVec(v) => each::<_, f16>(v),
        Value::QuatfVec(v) => each::<_, f32>(v),
        Value::QuatdVec(v) => each::<_, f64>(v),
        Value::Matrix4dVec(v) => v.iter().flat_map(|m| m.0).collect(),
        _ => return None,
    })
}

/// [`numbers`] in rows of `N`; `None` also if the last row is incomplete.
pub(crate) fn rows<const N: usize>(value: &Value) -> Option<Vec<[f64; N]>> {
    let numbers = numbers(value)?;
    let (rows, rest) = numbers.as_chunks::<N>();
    rest.is_empty().then(|| rows.to_vec())
}
