//! Morph targets: displacements of a surface to other shapes, and their weights over the clips.

use super::scene::{Scene, SceneMesh, fault};
use crate::{Error, Result};

/// Displacements of a surface to another shape, also called shape key or blend shape, in model space. Multiplied by the
/// target's weight, they are added to the bind pose before skinning; at rest all weights are 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    /// Name, unique among those of the mesh.
    pub name: String,
    /// `(V, 3)`, metres, to be added to the positions.
    pub positions: Vec<[f32; 3]>,
    /// `(V, 3)`, to be added to the normals, which are normalised afterwards; or empty for none.
    pub normals: Vec<[f32; 3]>,
}

/// The weight of one morph target over one clip. A target without a track has weight 0.
#[derive(Clone, Debug, PartialEq)]
pub struct MorphTrack {
    /// Index in [`Scene::clips`].
    pub clip: u32,
    /// Index in [`Scene::meshes`].
    pub mesh: u32,
    /// Index in the mesh's [`morph_targets`](SceneMesh::morph_targets).
    pub target: u32,
    /// One per frame of the clip, usually in 0..=1, but any finite number is valid.
    pub weights: Vec<f32>,
}

impl Scene {
    /// Removes all clips with their weights of morph targets.
    pub fn clear_clips(&mut self) {
        self.clips.clear();
        self.morph_tracks.clear();
    }

    /// The tracks of one clip.
    pub(crate) fn morph_tracks_of(&self, clip: usize) -> impl Iterator<Item = &MorphTrack> {
        self.morph_tracks.iter().filter(move |track| track.clip as usize == clip)
    }

    pub(super) fn validate_morph_tracks(&self) -> Result<()> {
        let mut seen = std::collections::BTreeSet::new();
        for (i, MorphTrack { clip, mesh, target, weights }) in self.morph_tracks.iter().enumerate() {
            let fault = |message: String| Err(Error::invalid("morph track", format!("{i}: {message}")));
            let Some(of_clip) = self.clips.get(*clip as usize) else {
                return fault(format!("clip {clip} of {}", self.clips.len()));
            };
            let Some(of_mesh) = self.meshes.get(*mesh as usize) else {
                return fault(format!("mesh {mesh} of {}", self.meshes.len()));
            };
            let targets = of_mesh.morph_targets.len();
            if *target as usize >= targets {
                return fault(format!("target {target} of {targets} of mesh `{}`", of_mesh.name));
            }
            let frames = of_clip.frame_count();
            if weights.len() != frames {
                return fault(format!("expected {frames} weights, one per frame, got {}", weights.len()));
            }
            if let Some(frame) = weights.iter().position(|weight| !weight.is_finite()) {
                return fault(format!("weight of frame {frame} is not finite: {}", weights[frame]));
            }
            if !seen.insert((clip, mesh, target)) {
                return fault(format!("a second one for clip {clip}, mesh {mesh}, target {target}"));
            }
        }
        Ok(())
    }
}

/// Checks the targets of a mesh: names, numbers of rows, finite offsets.
pub(super) fn validate_targets(mesh: &SceneMesh) -> Result<()> {
    let mut names = std::collections::BTreeSet::new();
    for MorphTarget { name, positions, normals } in &mesh.morph_targets {
        let fault = |message: String| Err(fault(mesh, format_args!("morph target {name:?}: {message}")));
        if name.is_empty() || name.chars().any(char::is_control) {
            return fault("its name is empty or holds control characters".into());
        }
        if !names.insert(name) {
            return fault("there are two of that name".into());
        }
        if positions.len() != mesh.positions.len() {
            let (expected, got) = (mesh.positions.len(), positions.len());
            return fault(format!("expected {expected} position offsets, got {got}"));
        }
        if !normals.is_empty() && normals.len() != mesh.normals.len() {
            let (expected, got) = (mesh.normals.len(), normals.len());
            return fault(format!("expected {expected} normal offsets or none, got {got}"));
        }
        for (what, offsets) in [("position", positions), ("normal", normals)] {
            if let Some(i) = offsets.iter().position(|o| !o.iter().all(|v| v.is_finite())) {
                return fault(format!("{what} offset {i} is not finite: {:?}", offsets[i]));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::scene::{arm, bent, bulging};

    #[test]
    fn the_synthetic_targets_are_valid_and_tracks_are_cleared_with_the_clips() {
        let mut scene = bulging(arm(4));
        scene.validate().unwrap();
        scene.clear_clips();
        assert!(scene.clips.is_empty() && scene.morph_tracks.is_empty());
        scene.validate().unwrap();
    }

    #[test]
    fn names_what_is_wrong() {
        type Case = (&'static str, fn(&mut Scene));
        let cases: &[Case] = &[
            ("`Cushion`: morph target \"\": its name", |s| s.meshes[2].morph_targets[0].name.clear()),
            ("morph target \"bulge\": there are two", |s| s.meshes[2].morph_targets[1].name = "bulge".into()),
            ("expected 6 position offsets, got 5", |s| {
                s.meshes[2].morph_targets[0].positions.pop();
            }),
            ("expected 6 normal offsets or none, got 5", |s| {
                s.meshes[2].morph_targets[0].normals.pop();
            }),
            ("position offset 2 is not finite", |s| {
                s.meshes[2].morph_targets[1].positions[2][0] = f32::NAN;
            }),
            ("normal offset 1 is not finite", |s| {
                s.meshes[2].morph_targets[0].normals[1][0] = f32::INFINITY;
            }),
            ("0: clip 7 of 2", |s| s.morph_tracks[0].clip = 7),
            ("0: mesh 3 of 3", |s| s.morph_tracks[0].mesh = 3),
            ("0: target 2 of 2 of mesh `Cushion`", |s| s.morph_tracks[0].target = 2),
            ("1: expected 3 weights, one per frame, got 2", |s| {
                s.morph_tracks[1].weights.pop();
            }),
            ("1: weight of frame 0 is not finite", |s| s.morph_tracks[1].weights[0] = f32::NAN),
            ("a second one for clip 0, mesh 2, target 0", |s| s.morph_tracks[1] = s.morph_tracks[0].clone()),
        ];
        for (expected, spoil) in cases {
            let mut scene = arm(4);
            scene.clips.push(bent(&scene));
            let mut scene = bulging(scene);
            spoil(&mut scene);
            let message = scene.validate().unwrap_err().to_string();
            assert!(message.contains(expected), "expected `{expected}` in `{message}`");
        }
    }
}
