//! Landmarks: the points of the body that surveys and standards name, as data over the vertices of LOD 0.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::definition::{Point, SURFACE_VERTICES};
use crate::{Error, Result};

/// A point of the skin that surveys and standards name, such as the acromion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Landmark {
    /// Identifier, with its side: `acromion_left`.
    pub name: String,
    /// Where it lies, in words.
    pub place: String,
    /// Where it lies on the mesh.
    pub point: Point,
}

/// All landmarks, from head to foot, left before right.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmarks(Vec<Landmark>);

/// What errors are about.
const WHAT: &str = "landmarks";

impl Landmarks {
    /// The landmarks of this version of the library: `model/landmarks.json`.
    ///
    /// # Errors
    /// None for the file that the library is built with; a test reads it.
    pub fn embedded() -> Result<Self> {
        Self::from_json(include_str!("../../../model/landmarks.json"), SURFACE_VERTICES)
    }

    /// Parses landmarks over a surface of `vertex_count` vertices.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the landmark that comes twice or whose point is none of that surface.
    pub fn from_json(json: &str, vertex_count: usize) -> Result<Self> {
        let list: Vec<Landmark> =
            serde_json::from_str(json).map_err(|error| Error::invalid(WHAT, error.to_string()))?;
        for (i, landmark) in list.iter().enumerate() {
            let fail = |message: String| Error::invalid(WHAT, format!("{}: {message}", landmark.name));
            landmark.point.validate(vertex_count).map_err(fail)?;
            if list[..i].iter().any(|earlier| earlier.name == landmark.name) {
                return Err(fail("comes twice".into()));
            }
        }
        Ok(Self(list))
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Landmark> {
        self.0.iter()
    }

    /// The landmark of this name, with its side.
    pub fn find(&self, name: &str) -> Option<&Landmark> {
        self.0.iter().find(|landmark| landmark.name == name)
    }

    /// Positions of all landmarks on a body, in order; `at` gives the positions of vertices of LOD 0, in the same unit and
    /// space.
    pub fn positions(&self, at: impl Fn(u32) -> DVec3 + Copy) -> Vec<DVec3> {
        self.0.iter().map(|landmark| landmark.point.position(at)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_or_refused_by_landmark() {
        let one =
            |name: &str, point: &str| format!(r#"{{"name":"{name}","place":"at the chin","point":{point}}}"#);
        let read = |rows: &[String]| Landmarks::from_json(&format!("[{}]", rows.join(",")), 10);
        let good = read(&[one("menton", "[[3,0.5],[4,0.5]]"), one("vertex", "[[9,1.0]]")]).unwrap();
        assert_eq!(good.find("menton").unwrap().point.0, [(3, 0.5), (4, 0.5)]);
        assert_eq!(good.find("nose"), None);
        let positions = good.positions(|v| DVec3::X * f64::from(v));
        assert_eq!(positions, [DVec3::X * 3.5, DVec3::X * 9.0]);
        for (rows, expected) in [
            (vec![one("menton", "[[10,1.0]]")], "menton: vertex 10 of 10"),
            (vec![one("menton", "[[1,0.4]]")], "menton: weights of a point sum to 0.4, not 1"),
            (vec![one("menton", "[[1,1.0]]"), one("menton", "[[1,1.0]]")], "menton: comes twice"),
            (vec!["{}".to_owned()], "missing field"),
        ] {
            let message = read(&rows).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn the_librarys_own_come_in_pairs() {
        let landmarks = Landmarks::embedded().unwrap();
        for landmark in landmarks.iter() {
            let (base, side) = crate::Side::split_measure_name(&landmark.name);
            if let Some(side) = side {
                let other = format!("{base}{}", side.mirrored().measure_suffix());
                assert!(landmarks.find(&other).is_some(), "{other}");
            }
        }
        assert!(landmarks.iter().len() > 60);
    }
}
