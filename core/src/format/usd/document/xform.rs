//! The transform of a prim: its xformOps and those of its ancestors (openusd.org, UsdGeomXformable).

use glam::{DAffine3, DMat4, DQuat, DVec3};
use openusd::sdf::{Path, Value};

use super::layer::Layer;
use super::values;
use crate::error::{Fault, UsdError, Within};
use crate::format::usd::Result;

/// One operation with its values over time codes, at least one sample.
struct Op {
    /// Its path, for messages.
    path: String,
    kind: String,
    inverted: bool,
    samples: Vec<(f64, Vec<f64>)>,
    animated: bool,
}

/// Operations from the outermost ancestor inwards.
pub(crate) struct Xforms(Vec<Op>);

impl Xforms {
    /// Reads those of the prim and all its ancestors.
    pub(crate) fn read(layer: &Layer, prim: &Path) -> Result<Self> {
        let mut ops = Vec::new();
        let mut prims: Vec<Path> = prim.ancestors_below_root().collect();
        prims.reverse();
        for prim in prims {
            for name in layer.tokens(&prim, "xformOpOrder")?.unwrap_or_default() {
                if name == "!resetXformStack!" {
                    ops.clear();
                    continue;
                }
                let inverted = name.starts_with("!invert!");
                let attribute = name.trim_start_matches("!invert!");
                let kind = attribute.split(':').nth(1).unwrap_or_default().to_owned();
                ops.push(Op::read(layer, &prim, attribute, kind, inverted)?);
            }
        }
        Ok(Self(ops))
    }

    /// Time codes of the animated operations.
    pub(crate) fn times(&self) -> impl Iterator<Item = Vec<f64>> {
        let animated = self.0.iter().filter(|op| op.animated);
        animated.map(|op| op.samples.iter().map(|s| s.0).collect())
    }

    /// The earliest of these time codes.
    pub(crate) fn first_time(&self) -> Option<f64> {
        self.times().filter_map(|times| times.first().copied()).min_by(f64::total_cmp)
    }

    /// `world_from_prim` at a time code, for column vectors.
    pub(crate) fn at(&self, time: f64) -> Result<DAffine3> {
        let mut world = DAffine3::IDENTITY;
        for op in &self.0 {
            world *= op.at(time)?;
        }
        Ok(world)
    }

    /// `world_from_prim` at the first time code.
    pub(crate) fn at_start(&self) -> Result<DAffine3> {
        self.at(self.first_time().unwrap_or(0.0))
    }
}

impl Op {
    fn read(layer: &Layer, prim: &Path, attribute: &str, kind: String, inverted: bool) -> Result<Self> {
        let path = format!("{prim}.{attribute}");
        let numbers = |value: &Value| {
            let numbers = values::numbers(value).filter(|n| !n.is_empty() && n.iter().all(|n| n.is_finite()));
            let fault = || UsdError::from(Fault::unexpected("finite numbers", "something else"));
            numbers.ok_or_else(fault).within(&path)
        };
        let mut samples = Vec::new();
        for (time, value) in layer.samples(prim, attribute)? {
            samples.push((time, numbers(&value)?));
        }
        let animated = !samples.is_empty();
        if !animated {
            let value = layer.default(prim, attribute)?;
            let fault = || UsdError::from(Fault::missing("value, but xformOpOrder names it"));
            samples.push((0.0, numbers(&value.ok_or_else(fault).within(&path)?)?));
        }
        Ok(Self { path, kind, inverted, samples, animated })
    }

    fn at(&self, time: f64) -> Result<DAffine3> {
        let fault = || UsdError::from(Fault::unsupported("this xformOp, or it has too few numbers: it"));
        let matrix = self.matrix(&self.numbers(time)).ok_or_else(fault).within(&self.path)?;
        if !matrix.is_finite() || matrix.matrix3.determinant() == 0.0 {
            return Err(Fault::unexpected("a matrix with an inverse", matrix).into())
                .within(format_args!("{} at time code {time}", self.path));
        }
        Ok(if self.inverted { matrix.inverse() } else { matrix })
    }

    /// The values at a time code, linear between samples.
    fn numbers(&self, time: f64) -> Vec<f64> {
        let after = self.samples.partition_point(|sample| sample.0 <= time);
        let a = &self.samples[after.saturating_sub(1)];
        let Some(b) = self.samples.get(after).filter(|b| after > 0 && b.1.len() == a.1.len()) else {
            return a.1.clone();
        };
        let share = (time - a.0) / (b.0 - a.0);
        // Take the quaternion sign that gives the shorter arc.
        let dot: f64 = a.1.iter().zip(&b.1).map(|(a, b)| a * b).sum();
        let sign = if self.kind == "orient" && dot < 0.0 { -1.0 } else { 1.0 };
        a.1.iter().zip(&b.1).map(|(a, b)| a + (b * sign - a) * share).collect()
    }

    fn matrix(&self, numbers: &[f64]) -> Option<DAffine3> {
        let vector = || Some(DVec3::from_slice(numbers.get(..3)?));
        let turn = |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians());
        Some(match self.kind.as_str() {
            "translate" => DAffine3::from_translation(vector()?),
            "scale" => DAffine3::from_scale(vector()?),
            "orient" => {
                let [w, x, y, z] = *numbers.first_chunk::<4>()?;
                let rotation = DQuat::from_xyzw(x, y, z, w);
                DAffine3::from_quat(Some(rotation).filter(|q| q.length_squared() > 1e-24)?.normalize())
            }
            "transform" => DAffine3::from_mat4(DMat4::from_cols_array(numbers.first_chunk::<16>()?)),
            kind => {
                // The axes in order of application: the last is leftmost.
                let axes = kind.strip_prefix("rotate")?.chars();
                let mut rotation = DQuat::IDENTITY;
                for axis in axes.clone() {
                    let (axis, place) = match axis {
                        'X' => (DVec3::X, 0),
                        'Y' => (DVec3::Y, 1),
                        'Z' => (DVec3::Z, 2),
                        _ => return None,
                    };
                    let place = if numbers.len() == 1 { 0 } else { place };
                    rotation = turn(axis, *numbers.get(place)?) * rotation;
                }
                DAffine3::from_quat(rotation)
            }
        })
    }
}
