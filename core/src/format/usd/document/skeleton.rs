//! The Skeleton that is read: joints, rest pose, animation.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use openusd::sdf::Path;

use super::layer::Layer;
use super::values;
use super::xform::Xforms;
use crate::error::{Fault, UsdError, Within};
use crate::format::motion::raw::parent_from_joints;
use crate::format::usd::Result;
use crate::math::{RigidTransform, RigidTransformF64};
use crate::skeleton::MAX_JOINTS;

/// The skeleton that is read from a file.
pub(crate) struct Skeleton {
    pub(crate) prim: Path,
    /// The animation bound to it.
    pub(crate) animation: Option<Path>,
    pub(crate) joints: Joints,
    /// The transforms of the prims above it.
    pub(crate) above: Xforms,
}

impl Skeleton {
    /// Reads the first of these with a bound animation, or else the first.
    pub(super) fn read(layer: &Layer, skeletons: &[Path]) -> Result<Option<Self>> {
        let Some((prim, animation)) = chosen(layer, skeletons)? else { return Ok(None) };
        let (joints, above) = (Joints::read(layer, prim)?, Xforms::read(layer, prim)?);
        Ok(Some(Self { prim: prim.clone(), animation, joints, above }))
    }
}

fn chosen<'a>(layer: &Layer, skeletons: &'a [Path]) -> Result<Option<(&'a Path, Option<Path>)>> {
    for skeleton in skeletons {
        // The binding is inherited from ancestors.
        for prim in skeleton.ancestors_below_root() {
            if let Some(source) = layer.target(&prim, "skel:animationSource")? {
                return Ok(Some((skeleton, Some(source))));
            }
        }
    }
    Ok(skeletons.first().map(|first| (first, None)))
}

/// A joint's local transform with scale: scale first, then rotation, then translation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transform {
    pub(crate) rotation: DQuat,
    pub(crate) translation: DVec3,
    pub(crate) scale: DVec3,
}

impl Transform {
    /// Sets the rotation to a quaternion w, x, y, z, normalised; one of length 0 is ignored.
    pub(crate) fn rotate(&mut self, [w, x, y, z]: [f64; 4]) {
        let rotation = DQuat::from_xyzw(x, y, z, w);
        if rotation.length_squared() > 1e-24 {
            self.rotation = rotation.normalize();
        }
    }

    pub(crate) fn to_affine(self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// The joints of a skeleton, parents first.
pub(crate) struct Joints {
    /// Paths from the root joint, as in the file.
    pub(crate) paths: Vec<String>,
    /// `jointNames` where the file has them, or else the last element of the path.
    pub(crate) names: Vec<String>,
    pub(crate) parents: Vec<Option<u32>>,
    /// Rest pose.
    pub(crate) rest: Vec<Transform>,
    /// Index of each joint in the file's own list.
    pub(crate) places: Vec<usize>,
}

impl Joints {
    pub(crate) fn read(layer: &Layer, prim: &Path) -> Result<Self> {
        let listed = layer.tokens(prim, "joints")?.unwrap_or_default();
        if listed.is_empty() || listed.len() > MAX_JOINTS {
            let expected = format!("1 to {MAX_JOINTS} joints");
            return Err(Fault::unexpected(expected, listed.len()).into())
                .within(format_args!("{prim}.joints"));
        }
        // A parent's path is shorter than its joint's; the order is kept if parents come first already.
        let place_of: BTreeMap<&str, usize> =
            listed.iter().enumerate().map(|(i, path)| (path.as_str(), i)).collect();
        if place_of.len() != listed.len() {
            return Err(Fault::inconsistent("a joint is listed twice").into())
                .within(format_args!("{prim}.joints"));
        }
        let parent_of = |path: &str| {
            let mut above = path;
            loop {
                above = &above[..above.rfind('/')?];
                if let Some(place) = place_of.get(above) {
                    return Some(*place);
                }
            }
        };
        let mut places: Vec<usize> = (0..listed.len()).collect();
        if places.iter().any(|&i| parent_of(&listed[i]).is_some_and(|parent| parent > i)) {
            places.sort_by_key(|&i| listed[i].matches('/').count());
        }
        let mut new_place = vec![0; listed.len()];
        places.iter().enumerate().for_each(|(new, &old)| new_place[old] = new as u32);
        let parents: Vec<Option<u32>> =
            places.iter().map(|&i| parent_of(&listed[i]).map(|parent| new_place[parent])).collect();

        let titles = layer.tokens(prim, "jointNames")?.filter(|titles| titles.len() == listed.len());
        let name = |&i: &usize| match &titles {
            Some(titles) if !titles[i].is_empty() => titles[i].clone(),
            _ => listed[i].rsplit('/').next().unwrap_or(&listed[i]).to_owned(),
        };
        let names = places.iter().map(name).collect();
        let rest = Self::rest(layer, prim, &places, &parents)?;
        let paths = places.iter().map(|&i| listed[i].clone()).collect();
        Ok(Self { paths, names, parents, rest, places })
    }

    /// The bind pose, `model_from_joint` without scale, transformed by `above`; matrices without scale are kept exactly. The
    /// rest pose if the file has no bind pose.
    pub(crate) fn bind_pose(&self, layer: &Layer, prim: &Path, above: &DAffine3) -> Result<Vec<DAffine3>> {
        let world: Vec<DAffine3> = match Self::matrices(layer, prim, "bindTransforms", &self.places)? {
            Some(bind) => bind.iter().map(|joint| *above * *joint).collect(),
            None => self.world(above),
        };
        Ok(world
            .iter()
            .map(
                |joint| {
                    if is_rigid(joint) { *joint } else { RigidTransformF64::without_scale(joint).to_affine() }
                },
            )
            .collect())
    }

    fn rest(layer: &Layer, prim: &Path, places: &[usize], parents: &[Option<u32>]) -> Result<Vec<Transform>> {
        let locals = match Self::matrices(layer, prim, "restTransforms", places)? {
            Some(locals) => locals,
            None => {
                let bind = Self::matrices(layer, prim, "bindTransforms", places)?.ok_or_else(|| {
                    UsdError::from(Fault::missing("restTransforms or bindTransforms, one per joint"))
                });
                let bind = bind.within(prim)?;
                let local = |(joint, parent): (&DAffine3, &Option<u32>)| match parent {
                    Some(parent) => bind[*parent as usize].inverse() * *joint,
                    None => *joint,
                };
                bind.iter().zip(parents).map(local).collect()
            }
        };
        let transform = |(joint, local): (usize, DAffine3)| {
            let (scale, rotation, translation) = local.to_scale_rotation_translation();
            let rest = Transform { rotation: rotation.normalize(), translation, scale };
            if rest.rotation.is_finite() && scale.is_finite() && translation.is_finite() {
                return Ok(rest);
            }
            Err(Fault::unexpected("a transform with an inverse", local).into())
                .within(format_args!("{prim}: rest transform of joint {joint}"))
        };
        locals.into_iter().enumerate().map(transform).collect()
    }

    fn matrices(
        layer: &Layer,
        prim: &Path,
        attribute: &str,
        places: &[usize],
    ) -> Result<Option<Vec<DAffine3>>> {
        let Some(value) = layer.default(prim, attribute)? else { return Ok(None) };
        let rows = values::rows::<16>(&value).unwrap_or_default();
        if rows.is_empty() {
            return Ok(None);
        }
        if rows.len() != places.len() {
            return Err(Fault::unexpected(format_args!("{} matrices", places.len()), rows.len()).into())
                .within(format_args!("{prim}.{attribute}"));
        }
        let matrices = places.iter().map(|&i| DAffine3::from_mat4(DMat4::from_cols_array(&rows[i])));
        let matrices: Vec<DAffine3> = matrices.collect();
        match matrices.iter().position(|m| !m.is_finite() || m.matrix3.determinant() == 0.0) {
            Some(joint) => Err(Fault::unexpected("a matrix with an inverse", matrices[joint]).into())
                .within(format_args!("{prim}.{attribute}: matrix {}", places[joint])),
            None => Ok(Some(matrices)),
        }
    }

    /// The rest pose, with `above` applied to the root joints and scale folded into the translations.
    pub(crate) fn locals(&self, above: &DAffine3) -> Vec<RigidTransform> {
        let rigid: Vec<RigidTransformF64> =
            self.world(above).iter().map(RigidTransformF64::without_scale).collect();
        parent_from_joints(&rigid, &self.parents)
    }

    fn world(&self, above: &DAffine3) -> Vec<DAffine3> {
        let mut world: Vec<DAffine3> = Vec::with_capacity(self.rest.len());
        for (joint, parent) in self.rest.iter().zip(&self.parents) {
            let parent = parent.and_then(|p| world.get(p as usize)).unwrap_or(above);
            world.push(*parent * joint.to_affine());
        }
        world
    }
}

/// Whether there is neither scale nor shear, up to rounding of `f32`.
fn is_rigid(transform: &DAffine3) -> bool {
    let m = transform.matrix3;
    let off = (m.transpose() * m - DMat3::IDENTITY).to_cols_array();
    off.iter().all(|v| v.abs() < 1e-6) && m.determinant() > 0.0
}
