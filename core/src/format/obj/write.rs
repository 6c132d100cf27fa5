//! Wavefront OBJ: the bind pose, or the scene's pose, for programs without skeletons.
//!
//! One `o` object per mesh, the body first with its vertices in the scene's order and unsplit, quads kept, texture
//! coordinates with v upwards as in OBJ. Metres. Numbers have enough digits to restore the exact `f32`. Colours are
//! omitted: a program that needs them should read the glTF.

use std::fmt::Write;

use crate::Result;
use crate::scene::{Scene, SceneMesh, flip_v};

/// Number of elements written before a mesh.
#[derive(Default)]
struct Offsets {
    position: u32,
    uv: u32,
    normal: u32,
}

/// The scene's meshes as one OBJ file.
///
/// Its second line states the numbers of `v` and `f` lines that follow, so that truncation is detected.
///
/// # Errors
/// [`crate::Error::Invalid`] if the scene does not [validate](Scene::validate).
pub fn to_obj(scene: &Scene) -> Result<Vec<u8>> {
    scene.validate()?;
    let meshes = scene.standing_meshes()?;
    let count = |of: fn(&SceneMesh) -> usize| meshes.iter().map(of).sum::<usize>();
    let vertices = count(|m| m.positions.len());
    let faces = count(|m| faces(m).count());
    let mut text = String::with_capacity(80 * vertices + 60 * faces);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "# anthronet {}, metres, +Y up, +Z forward", env!("CARGO_PKG_VERSION"));
    let _ = writeln!(text, "{COUNTS} {vertices} {faces}");
    if scene.pose.is_some() {
        let _ = writeln!(text, "{POSED}");
    }
    let mut offsets = Offsets::default();
    for mesh in meshes.iter() {
        let _ = push_mesh(&mut text, mesh, &mut offsets);
    }
    Ok(text.into_bytes())
}

/// Comment in a file whose surface is posed, of which measures cannot be taken.
pub(crate) const POSED: &str = "# anthronet posed";

/// Comment before the numbers of `v` and `f` lines.
pub(crate) const COUNTS: &str = "# anthronet counts v f:";

fn push_mesh(text: &mut String, mesh: &SceneMesh, offsets: &mut Offsets) -> std::fmt::Result {
    writeln!(text, "o {}", mesh.name)?;
    for [x, y, z] in &mesh.positions {
        writeln!(text, "v {x} {y} {z}")?;
    }
    for [u, v] in mesh.uvs.iter().map(|uv| flip_v(*uv)) {
        writeln!(text, "vt {u} {v}")?;
    }
    for [x, y, z] in &mesh.normals {
        writeln!(text, "vn {x} {y} {z}")?;
    }
    for corners in faces(mesh) {
        text.push('f');
        for (position, uv) in corners {
            // OBJ indices start at 1.
            let position_in_file = offsets.position + position + 1;
            let (uv, normal) = (offsets.uv + uv + 1, offsets.normal + position + 1);
            match (mesh.uvs.is_empty(), mesh.normals.is_empty()) {
                (false, false) => write!(text, " {position_in_file}/{uv}/{normal}")?,
                (false, true) => write!(text, " {position_in_file}/{uv}")?,
                (true, false) => write!(text, " {position_in_file}//{normal}")?,
                (true, true) => write!(text, " {position_in_file}")?,
            }
        }
        text.push('\n');
    }
    offsets.position += mesh.positions.len() as u32;
    offsets.uv += mesh.uvs.len() as u32;
    offsets.normal += mesh.normals.len() as u32;
    Ok(())
}

/// The faces to write: without corners that repeat an earlier one, and without faces of fewer than three corners.
fn faces(mesh: &SceneMesh) -> impl Iterator<Item = Vec<(u32, u32)>> + '_ {
    let quads = mesh.quads.iter().map(|face| distinct(&face));
    let triangles = mesh.triangles.iter().map(|face| distinct(&face));
    quads.chain(triangles).filter(|face| face.len() >= 3)
}

fn distinct(face: &[(u32, u32)]) -> Vec<(u32, u32)> {
    let repeats = |i: usize| face[..i].iter().any(|earlier| earlier.0 == face[i].0);
    (0..face.len()).filter(|i| !repeats(*i)).map(|i| face[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::scene::arm;

    /// The values after a keyword, line by line.
    fn lines<'a>(text: &'a str, keyword: &str) -> Vec<Vec<&'a str>> {
        let of = text.lines().map(|l| l.split_ascii_whitespace().collect::<Vec<_>>());
        of.filter(|l| l.first() == Some(&keyword)).map(|l| l[1..].to_vec()).collect()
    }

    #[test]
    fn keeps_order_quads_and_every_bit_of_the_positions() {
        let mut scene = arm(4);
        scene.meshes[0].positions[0] = [1.0 / 3.0, -1.234_567_8e-7, 1e-40];
        let text = String::from_utf8(to_obj(&scene).unwrap()).unwrap();
        let positions: Vec<[f32; 3]> =
            lines(&text, "v").iter().map(|l| std::array::from_fn(|i| l[i].parse().unwrap())).collect();
        let expected: Vec<_> = scene.meshes.iter().flat_map(|m| m.positions.clone()).collect();
        assert_eq!(positions, expected);
        let faces = lines(&text, "f");
        assert_eq!(faces.len(), 11);
        assert_eq!(faces[0], ["1/1/1", "2/2/2", "7/8/7", "6/7/6"]);
        // Closes the ring: the first vertex again, with the texture coordinate across the seam.
        assert_eq!(faces[4], ["5/5/5", "1/6/1", "6/12/6", "10/11/10"]);
        assert_eq!(faces[10], ["16", "17", "18"]);
        assert_eq!(lines(&text, "o"), [["Sleeve"], ["Nail"]]);
        assert_eq!(lines(&text, "vt")[7], ["0.2", "0.5"], "v upwards again");
        assert!(text.contains("# anthronet counts v f: 18 11\n"));
    }

    #[test]
    fn a_scene_in_a_pose_has_the_posed_vertices_and_says_so() {
        let mut scene = arm(4);
        let mut pose = scene.skeleton.as_ref().unwrap().rest_pose().clone();
        pose.locals[0].translation.y += 0.5;
        scene.pose = Some(pose);
        let text = String::from_utf8(to_obj(&scene).unwrap()).unwrap();
        assert!(text.contains("\n# anthronet posed\n"));
        for (line, mesh) in lines(&text, "v").iter().zip(&scene.meshes[0].positions) {
            let height: f32 = line[1].parse().unwrap();
            assert!((height - mesh[1] - 0.5).abs() < 1e-5, "{line:?} of {mesh:?}");
        }
    }

    #[test]
    fn a_quad_with_a_repeated_corner_becomes_a_triangle() {
        let mut scene = arm(4);
        scene.meshes[0].quads.positions[0][3] = 0;
        scene.meshes[0].quads.positions[1] = [3; 4];
        let text = String::from_utf8(to_obj(&scene).unwrap()).unwrap();
        assert_eq!(lines(&text, "f")[0], ["1/1/1", "2/2/2", "7/8/7"]);
        assert!(text.contains("# anthronet counts v f: 18 10\n"));
    }
}
