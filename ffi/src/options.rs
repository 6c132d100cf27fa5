//! Descriptors and enumerations: from numbers of the caller's to the core's types.
//!
//! A descriptor begins with its size as the caller compiled it. Fields beyond that are 0, and 0 stands for the default
//! in every field, so that older callers work with newer libraries and newer callers with older ones.

use anthronet::mesh::Lod;
use anthronet::skeleton::humanoid::JointNames;
use anthronet::skin::SkinMethod;
use anthronet::space::Space;

use crate::pointer::{MAX_LIST, at_most, usable};
use crate::status::{ANTHRONET_ERROR_ENUM, Fault, Outcome};

/// Right-handed, +Y up, the character faces +Z and has its left at +X: glTF, USD, the library's own.
pub const ANTHRONET_SPACE_GLTF: u32 = 0;
/// Right-handed, +Z up, the character faces −Y and has its left at +X: Blender. The axes of joints stay the same.
pub const ANTHRONET_SPACE_BLENDER: u32 = 1;
/// Left-handed, +Y up, the character faces +Z and has its left at −X: Unity. Triangles have the opposite
/// winding, and the axes of joints are mirrored at X too.
pub const ANTHRONET_SPACE_UNITY: u32 = 2;

/// The rig's own names, such as `upperarm_l`.
pub const ANTHRONET_NAMES_NATIVE: u32 = 0;
/// Unity's `HumanBodyBones`, such as `LeftUpperArm`.
pub const ANTHRONET_NAMES_UNITY: u32 = 1;
/// Mixamo's, such as `mixamorig:LeftArm`.
pub const ANTHRONET_NAMES_MIXAMO: u32 = 2;
/// VRM 1.0's, such as `leftUpperArm`.
pub const ANTHRONET_NAMES_VRM: u32 = 3;
/// Blender's, such as `upper_arm.L`.
pub const ANTHRONET_NAMES_BLENDER: u32 = 4;

/// Linear blend skinning: what glTF, UsdSkel and game engines do.
pub const ANTHRONET_SKIN_LINEAR: u32 = 0;
/// Dual quaternions: Blender's "Preserve Volume".
pub const ANTHRONET_SKIN_DUAL_QUATERNION: u32 = 1;
/// The paper's formula: joints move vertices but do not turn them.
pub const ANTHRONET_SKIN_JOINT_TRANSLATION: u32 = 2;

/// A descriptor: plain numbers and pointers, all of them valid when 0, with `struct_size: u32` in front.
///
/// # Safety
/// Only for `repr(C)` types whose first field is the `u32` of their size and for which zeros are a value.
pub(crate) unsafe trait Descriptor: Copy {}

fn size_fault<T>(what: &str, got: u32) -> Fault {
    let expected = size_of::<T>();
    Fault::size(what, format_args!("expected a struct_size of 4 to 4096, such as {expected}, got {got}"))
}

/// The size that a descriptor of the caller's says it has.
fn said_size<T: Descriptor>(pointer: *const T, what: &str) -> Outcome<usize> {
    usable(pointer, what)?;
    // SAFETY: not NULL, aligned, and begins with a u32.
    let size = unsafe { pointer.cast::<u32>().read() };
    if !(4..=4096).contains(&size) {
        return Err(size_fault::<T>(what, size));
    }
    Ok(size as usize)
}

/// Reads a descriptor; all of NULL is the default.
pub(crate) fn described<T: Descriptor>(pointer: *const T, what: &str) -> Outcome<T> {
    // SAFETY: zeros are a value, by the trait's contract.
    let mut whole: T = unsafe { std::mem::zeroed() };
    if pointer.is_null() {
        return Ok(whole);
    }
    let size = said_size(pointer, what)?.min(size_of::<T>());
    // SAFETY: that many bytes are there, by the caller's word, and fit.
    unsafe { std::ptr::copy_nonoverlapping(pointer.cast::<u8>(), (&raw mut whole).cast(), size) };
    Ok(whole)
}

/// A list of descriptors, all of the size that the first one says.
pub(crate) fn described_list<T: Descriptor>(pointer: *const T, count: u32, what: &str) -> Outcome<Vec<T>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    if pointer.is_null() {
        return Err(Fault::null(what));
    }
    at_most(what, "entries", MAX_LIST, count.into())?;
    let size = said_size(pointer, what)?;
    if !size.is_multiple_of(align_of::<T>()) {
        return Err(size_fault::<T>(what, size as u32));
    }
    (0..count as usize)
        .map(|i| {
            // SAFETY: within the list, by the caller's word.
            let element = unsafe { pointer.byte_add(i * size) };
            if said_size(element, what)? != size {
                let message = format_args!("expected the struct_size of the first, {size}");
                return Err(Fault::size(&format!("{what} {i}"), message));
            }
            described(element, what)
        })
        .collect()
}

/// Where a descriptor is written for the caller, only as far as the caller's own reaches.
pub(crate) struct DescriptorOut<T> {
    pointer: *mut T,
    size: usize,
}

impl<T: Descriptor> DescriptorOut<T> {
    pub(crate) fn new(pointer: *mut T, what: &str) -> Outcome<Self> {
        Ok(Self { pointer, size: said_size(pointer, what)? })
    }

    /// `value` holds anything for its own size.
    pub(crate) fn write(self, value: &T) {
        let head = size_of::<u32>();
        let size = self.size.min(size_of::<T>());
        // SAFETY: so many bytes are there, by the caller's word; the first four, the size, stay.
        unsafe {
            let from = (&raw const *value).cast::<u8>().add(head);
            std::ptr::copy_nonoverlapping(from, self.pointer.cast::<u8>().add(head), size - head);
        }
    }
}

fn unknown(what: &str, highest: u32, got: u32) -> Fault {
    Fault::new(ANTHRONET_ERROR_ENUM, format!("{what}: expected 0 to {highest}, got {got}"))
}

/// The element of `all` that a number stands for.
pub(crate) fn choice<T: Copy>(all: &[T], number: u32, what: &str) -> Outcome<T> {
    all.get(number as usize).copied().ok_or_else(|| unknown(what, all.len() as u32 - 1, number))
}

/// A number that 0 stands in for where the default is asked for.
pub(crate) fn given(number: f64) -> Option<f64> {
    (number != 0.0).then_some(number)
}

/// 0 or 1.
pub(crate) fn flag(number: u32, what: &str) -> Outcome<bool> {
    choice(&[false, true], number, what)
}

pub(crate) fn space(number: u32) -> Outcome<Space> {
    choice(&[Space::Gltf, Space::Blender, Space::Unity], number, "space")
}

pub(crate) fn joint_names(number: u32) -> Outcome<JointNames> {
    use JointNames::{Blender, Mixamo, Native, Unity, Vrm};
    choice(&[Native, Unity, Mixamo, Vrm, Blender], number, "joint_names")
}

pub(crate) fn skin_method(number: u32) -> Outcome<SkinMethod> {
    use SkinMethod::{DualQuaternion, JointTranslation, Linear};
    choice(&[Linear, DualQuaternion, JointTranslation], number, "method")
}

pub(crate) fn lod(number: u32) -> Outcome<Lod> {
    choice(&Lod::ALL, number, "lod")
}
