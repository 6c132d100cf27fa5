//! Tables of human bones in VRM's extensions: `VRMC_vrm_animation` of motions, `VRMC_vrm` and `VRM` (0.x) of characters
//! (github.com/vrm-c/vrm-specification).

use gltf_json::Value;

use super::Result;
use super::document::Document;
use crate::error::{Fault, Within};
use crate::skeleton::RigJoint;
use crate::skeleton::humanoid::humanoid_bones;

/// The extensions with a table, the one that is about motion first.
const EXTENSIONS: [&str; 3] = ["VRMC_vrm_animation", "VRMC_vrm", "VRM"];

/// The joints of the rig and the nodes that a document's table names as such; empty without a table. Bones that the rig does not
/// have are left out.
pub(super) fn read(document: &Document) -> Result<Vec<(RigJoint, usize)>> {
    let extensions = document.root.extensions.as_ref().map(|extensions| &extensions.others);
    let found = EXTENSIONS.into_iter().find_map(|name| Some((name, extensions?.get(name)?)));
    let Some((name, extension)) = found else { return Ok(Vec::new()) };
    let place = format!("extensions.{name}.humanoid.humanBones");
    let nodes = document.root.nodes.len();
    let mut joints: Vec<(RigJoint, usize)> = Vec::new();
    for (bone, node) in rows(extension.pointer("/humanoid/humanBones")) {
        let Some(node) = node.and_then(Value::as_u64) else { continue };
        let node = usize::try_from(node).unwrap_or(usize::MAX);
        if node >= nodes {
            return Err(Fault::dangling("node", node, nodes).into()).within(format_args!("{place}: {bone}"));
        }
        if let Some(joint) = joint(bone, name == "VRM")
            && !joints.iter().any(|(other, taken)| *other == joint || *taken == node)
        {
            joints.push((joint, node));
        }
    }
    Ok(joints)
}

/// Bones and their nodes: members of an object, or of a list in VRM 0.x.
fn rows(table: Option<&Value>) -> Vec<(&str, Option<&Value>)> {
    match table {
        Some(Value::Object(bones)) => {
            bones.iter().map(|(bone, row)| (bone.as_str(), row.get("node"))).collect()
        }
        Some(Value::Array(rows)) => {
            rows.iter().filter_map(|row| Some((row.get("bone")?.as_str()?, row.get("node")))).collect()
        }
        _ => Vec::new(),
    }
}

/// The joint of a bone. VRM 0.x has Unity's names with a small first letter, which differ for the thumb.
fn joint(bone: &str, unity: bool) -> Option<RigJoint> {
    let is = |name: &str| match unity {
        true => name.eq_ignore_ascii_case(bone),
        false => name == bone,
    };
    humanoid_bones().iter().find(|row| is(if unity { &row.unity } else { &row.vrm })).map(|row| row.joint)
}
