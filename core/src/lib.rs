//! Conditional human bodies from tape measures: a request goes in, a rigged and skinned person comes out.
//!
//! ```
//! use anthronet::condition::Request;
//! use anthronet::format::gltf::to_glb;
//! use anthronet::measure::Sex;
//! use anthronet::mesh::Lod;
//! use anthronet::model::Model;
//! use anthronet::scene::{Scene, SceneOptions};
//!
//! let model = Model::embedded()?;
//! let request = Request { sex: Some(Sex::Female), ..Request::default() }
//!     .with("height", 1.70)?
//!     .with("waist_circumference", 0.74)?;
//! let body = model.generate(&request)?;
//! assert!((body.measurements()[3] - 1.70).abs() < 1e-6); // metres, in the order of `MeasureId`
//! assert_eq!(body.vertices().len(), 53_514);
//!
//! let options = SceneOptions { lod: Lod::Lod2, ..SceneOptions::default() };
//! let glb: Vec<u8> = to_glb(&Scene::from_body(&body, &options)?)?;
//! assert_eq!(&glb[..4], b"glTF");
//! # Ok::<(), anthronet::Error>(())
//! ```
//!
//! # Tour
//!
//! | Type | What it is | Ownership and cost |
//! |---|---|---|
//! | [`model::Model`] | networks, shape space, prior, definitions: the result of training | immutable; open it once and share it between threads, a clone copies a pointer |
//! | [`model::Character`] | what all bodies share: topology, levels of detail, joint tree, skin weights | in the model, behind an `Arc` |
//! | [`condition::Request`] | what a body is made from: any subset of the measures, sex, seed or z | plain data |
//! | [`Body`] | one person in the bind pose, with joints and [`condition::Report`] | immutable; owns about 2 MB of vertices and normals, shares the character |
//! | [`measure::Definitions`] | where each measure is taken, as data | in the model |
//! | [`skeleton::Skeleton`] | a joint tree with its rest pose | immutable, a few kilobytes; shared by a body and its clips |
//! | [`skeleton::Pose`] | one transform per joint, relative to its parent | a reusable buffer: keep one per thread and character and nothing is allocated per frame |
//! | [`clip::Clip`], [`clip::Sampler`] | a motion; evaluates it at a time | a clip is immutable and shared, a sampler is two words |
//! | [`skin::Skinner`], [`skin::SkinJob`] | a surface with its weights; one evaluation of it | a skinner is immutable and shared, a job borrows the caller's buffers |
//! | [`skin::SkinContext`] | the memory that skinning works in | keep one per thread or character; the next call reuses it |
//! | [`scene::Scene`] | meshes, joints, materials, clips, of any character | plain data that every file format is read into and written from |
//!
//! Data flows one way: `condition` → `model` → [`Body`] → `skeleton`, `clip`, `skin` → `scene` → `format`. ARCHITECTURE.md lists
//! the modules and their allowed dependencies.
//!
//! # Conventions
//!
//! Metres, radians, seconds, kilograms; other units, axes and handedness are converted in [`space`] alone. Right-handed,
//! +Y up, +Z forward, +X the character's left, as glTF. The bind pose is a T-pose with the feet on y = 0 and the pelvis
//! over the origin. Matrices act on column vectors: `model_from_joint * point_in_joint`. Their names say both spaces,
//! and of a product the rightmost factor is applied first. Quaternions are x, y, z, w. Parents come before their children.
//!
//! Vertices have one order everywhere: measures are defined on the vertices of LOD 0, LOD 1 is the first 13,380 of them,
//! and LODs 2 and 3 are index lists over those.
//!
//! The same request gives the same bits on every machine and on any number of threads. Errors name the field or file,
//! what was expected and what was found; bad input never panics.

mod body;
pub mod clip;
pub mod condition;
mod error;
pub mod format;
pub mod math;
pub mod measure;
pub mod mesh;
pub mod model;
pub mod network;
pub mod pose;
pub mod random;
pub mod retarget;
pub mod scene;
mod side;
pub mod skeleton;
pub mod skin;
pub mod space;
#[cfg(test)]
mod testing;
pub mod text;

pub use body::Body;
pub use error::{Error, Infeasible, Result};
pub use side::Side;
