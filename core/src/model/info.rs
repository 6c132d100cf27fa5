//! The JSON description of a model.

use serde_json::json;

use super::Model;
use crate::mesh::Lod;

impl Model {
    /// The JSON of `anthronet info --json`: measures with definitions, standards and ranges (metres), the
    /// turns from the T-pose to the standing body, landmarks, joints with
    /// parents, vertices per level of detail, versions and scores.
    pub fn info(&self) -> serde_json::Value {
        let (character, ranges) = (self.character(), self.ranges());
        let measures = self.definitions().iter().map(|(id, definition)| {
            let mut measure = json!({
                "name": definition.name,
                "kind": definition.kind,
                "stance": definition.stance,
                "points": definition.points,
                "normal": definition.normal.to_array(),
                "axis": definition.axis.map(|axis| axis.to_array()),
                "standard": definition.standard(),
                "min": ranges[id.index()].min,
                "max": ranges[id.index()].max,
            });
            if !definition.bones.is_empty() {
                measure["bones"] = json!(definition.bones);
            }
            if !definition.edges.is_empty() {
                measure["edges"] = json!(definition.edges);
            }
            measure
        });
        let skeleton = character.joint_tree();
        let joints = skeleton.names().iter().zip(skeleton.parents()).map(|(name, parent)| {
            let parent = parent.and_then(|p| skeleton.names().get(p as usize));
            json!({"name": name, "parent": parent})
        });
        let levels = Lod::ALL.map(|lod| character.vertex_count(lod));
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "measures": measures.collect::<Vec<_>>(),
            "standing": self.definitions().turns(),
            "landmarks": self.landmarks().iter().collect::<Vec<_>>(),
            "joints": joints.collect::<Vec<_>>(),
            "vertices_per_lod": levels,
            "latent_size": self.latent_size(),
            "measures_sha256": self.definitions().hash(),
            "model": self.provenance(),
        })
    }
}
