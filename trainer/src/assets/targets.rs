//! MakeHuman's blend shapes ("targets") and the modifiers that pair them, reduced to the points in use.

use std::collections::{BTreeMap, HashMap};

use glam::Vec3;
use serde::Deserialize;

use super::{BaseMesh, METRES_PER_UNIT, Rig, Wheel};
use crate::{Error, Result};

/// Displacements of some points, metres at weight one.
#[derive(Clone, Debug, Default)]
pub struct Target {
    /// Points that move.
    pub points: Vec<u32>,
    /// Displacement of each.
    pub deltas: Vec<Vec3>,
}

impl Target {
    /// Adds the blend shape at a weight.
    pub fn add_to(&self, points: &mut [Vec3], weight: f32) {
        for (&p, &delta) in self.points.iter().zip(&self.deltas) {
            points[p as usize] += delta * weight;
        }
    }
}

/// A slider of MakeHuman: a negative and a positive target, for the whole body or for each side.
#[derive(Clone, Debug)]
pub struct Modifier {
    /// MakeHuman's name with its group, such as `head-fat-decr-incr|head`.
    pub name: String,
    /// The group alone.
    pub group: String,
    /// Targets for negative and positive values, one pair, or one pair per side (left first).
    pub pairs: Vec<[Option<usize>; 2]>,
}

/// All targets and modifiers.
pub struct TargetSet {
    targets: Vec<Target>,
    numbers: BTreeMap<String, usize>,
    /// Sliders other than the macro ones (age, weight, …), sorted by name.
    pub modifiers: Vec<Modifier>,
}

#[derive(Deserialize)]
struct Group {
    categories: Vec<Category>,
}

#[derive(Deserialize)]
struct Category {
    name: String,
    has_left_and_right: bool,
    #[serde(default)]
    opposites: BTreeMap<String, String>,
    targets: Vec<String>,
}

impl TargetSet {
    /// Reads every target that shapes bodies; expressions, genitals and asymmetries are left out.
    ///
    /// # Errors
    /// [`Error::Source`] naming the file and line.
    pub fn read(wheel: &mut Wheel, mesh: &BaseMesh, rig: &Rig) -> Result<Self> {
        let reduce = Reduction::new(mesh, rig);
        let mut set = Self { targets: Vec::new(), numbers: BTreeMap::new(), modifiers: Vec::new() };
        for name in wheel.names("targets/", ".target.gz") {
            let key = name.trim_start_matches("targets/").trim_end_matches(".target.gz").to_owned();
            if ["expression/", "genitals/", "asym/"].iter().any(|left_out| key.starts_with(left_out))
                || ["-baby", "-child"].iter().any(|age| key.contains(age))
            {
                continue;
            }
            let target = reduce.apply(&parse(&wheel.read_text(&name)?, &name, mesh.raw_positions.len())?);
            set.numbers.insert(key, set.targets.len());
            set.targets.push(target);
        }
        let groups: BTreeMap<String, Group> = serde_json::from_str(&wheel.read_text("targets/target.json")?)
            .map_err(|e| Error::Source(format!("target.json: {e}")))?;
        for (group, content) in &groups {
            for category in &content.categories {
                set.modifiers.extend(set.modifier(group, category));
            }
        }
        set.modifiers.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(set)
    }

    /// The number of a target, such as `macrodetails/african-female-old`; `None` when MakeHuman has none,
    /// which it treats as no displacement.
    pub fn number(&self, key: &str) -> Option<usize> {
        self.numbers.get(key).copied()
    }

    /// The target with this number.
    pub fn get(&self, number: usize) -> &Target {
        &self.targets[number]
    }

    /// Number of targets.
    pub fn len(&self) -> usize {
        self.targets.len()
    }

    /// Whether there are no targets.
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty()
    }

    /// Adds a sided modifier of our own, left first, that moves by the targets in both directions.
    pub fn add_procedural(&mut self, name: &str, group: &str, sides: [Target; 2]) {
        let pairs = sides
            .into_iter()
            .map(|target| {
                let number = self.targets.len();
                let deltas = target.deltas.iter().map(|d| -*d).collect();
                let negative = Target { points: target.points.clone(), deltas };
                self.targets.extend([target, negative]);
                [Some(number + 1), Some(number)]
            })
            .collect();
        self.modifiers.push(Modifier { name: format!("{name}|{group}"), group: group.to_owned(), pairs });
        self.modifiers.sort_by(|a, b| a.name.cmp(&b.name));
    }

    fn modifier(&self, group: &str, category: &Category) -> Option<Modifier> {
        let find = |key: &str| -> Option<usize> {
            let name = category.opposites.get(key).filter(|n| !n.is_empty())?;
            self.number(&format!("{group}/{name}"))
        };
        let pairs = if category.has_left_and_right {
            ["left", "right"]
                .map(|side| [find(&format!("negative-{side}")), find(&format!("positive-{side}"))])
                .to_vec()
        } else if category.opposites.is_empty() || category.targets.len() == 1 {
            vec![[None, self.number(&format!("{group}/{}", category.targets.first()?))]]
        } else {
            vec![[find("negative-unsided"), find("positive-unsided")]]
        };
        pairs.iter().flatten().any(Option::is_some).then(|| Modifier {
            name: format!("{}|{group}", category.name),
            group: group.to_owned(),
            pairs,
        })
    }
}

fn parse(text: &str, name: &str, vertex_count: usize) -> Result<Vec<(u32, Vec3)>> {
    let mut out = Vec::new();
    for (n, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let mut words = line.split_whitespace();
        let parsed = (|| {
            let v: u32 = words.next()?.parse().ok()?;
            let mut d = [0.0_f32; 3];
            for value in &mut d {
                *value = words.next()?.parse().ok()?;
            }
            ((v as usize) < vertex_count).then_some((v, Vec3::from(d) * METRES_PER_UNIT))
        })();
        out.push(
            parsed.ok_or_else(|| Error::Source(format!("{name} line {}: cannot read `{line}`", n + 1)))?,
        );
    }
    Ok(out)
}

/// Which points a raw vertex moves, and by how much: its own surface point, and joints it is averaged into.
struct Reduction {
    points_of_raw: HashMap<u32, Vec<(u32, f32)>>,
}

impl Reduction {
    fn new(mesh: &BaseMesh, rig: &Rig) -> Self {
        let mut points_of_raw: HashMap<u32, Vec<(u32, f32)>> = HashMap::new();
        for (p, &raw) in mesh.raw_of_surface.iter().enumerate() {
            points_of_raw.entry(raw).or_default().push((p as u32, 1.0));
        }
        let joints = rig.heads.iter().chain(&rig.tails);
        for (point, vertices) in (mesh.raw_of_surface.len() as u32..).zip(joints) {
            for &raw in vertices {
                points_of_raw.entry(raw).or_default().push((point, 1.0 / vertices.len() as f32));
            }
        }
        Self { points_of_raw }
    }

    fn apply(&self, raw: &[(u32, Vec3)]) -> Target {
        let mut sums: BTreeMap<u32, Vec3> = BTreeMap::new();
        for (vertex, delta) in raw {
            for &(point, weight) in self.points_of_raw.get(vertex).map_or(&[][..], Vec::as_slice) {
                *sums.entry(point).or_default() += *delta * weight;
            }
        }
        Target { points: sums.keys().copied().collect(), deltas: sums.values().copied().collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_read_or_refused_by_line() {
        let read = parse("# a comment\n\n3 1 0 -2\n0 .5 0 0\n", "fat.target", 4).unwrap();
        // Decimetres in the file, metres here.
        assert_eq!(read, [(3, Vec3::new(0.1, 0.0, -0.2)), (0, Vec3::new(0.05, 0.0, 0.0))]);
        for bad in ["4 0 0 0", "1 0 0", "x 0 0 0", "1 0 0 z"] {
            let message = parse(&format!("0 0 0 0\n{bad}"), "fat.target", 4).unwrap_err().to_string();
            assert!(message.contains("fat.target line 2") && message.contains(bad), "{message}");
        }
    }

    #[test]
    fn joints_move_by_the_mean_of_their_vertices() {
        // Raw vertex 5 is surface point 0; vertices 5 and 6 make the joint that is point 1; vertex 7 is a helper.
        let points_of_raw = HashMap::from([(5, vec![(0, 1.0), (1, 0.5)]), (6, vec![(1, 0.5)])]);
        let reduction = Reduction { points_of_raw };
        let target = reduction.apply(&[(6, Vec3::X * 4.0), (7, Vec3::Y), (5, Vec3::X * 2.0)]);
        assert_eq!(target.points, [0, 1]);
        assert_eq!(target.deltas, [Vec3::X * 2.0, Vec3::X * 3.0]);
        let mut points = [Vec3::ZERO, Vec3::ONE];
        target.add_to(&mut points, 0.5);
        assert_eq!(points, [Vec3::X, Vec3::new(2.5, 1.0, 1.0)]);
    }

    fn set() -> TargetSet {
        let numbers = [
            "head/fat-decr",
            "head/fat-incr",
            "arms/l-decr",
            "arms/l-incr",
            "arms/r-decr",
            "arms/r-incr",
            "nose/hump",
        ];
        TargetSet {
            targets: vec![Target::default(); numbers.len()],
            numbers: numbers.iter().enumerate().map(|(i, name)| ((*name).to_owned(), i)).collect(),
            modifiers: Vec::new(),
        }
    }

    #[test]
    fn modifiers_pair_their_targets() {
        let category = |json: &str| -> Category { serde_json::from_str(json).unwrap() };
        let fat = category(
            r#"{"name": "fat", "has_left_and_right": false, "targets": ["a", "b"],
                "opposites": {"negative-unsided": "fat-decr", "positive-unsided": "fat-incr"}}"#,
        );
        let fat = set().modifier("head", &fat).unwrap();
        assert_eq!((fat.name.as_str(), fat.pairs), ("fat|head", vec![[Some(0), Some(1)]]));
        let arms = category(
            r#"{"name": "arms", "has_left_and_right": true, "targets": ["a", "b"],
                "opposites": {"negative-left": "l-decr", "positive-left": "l-incr",
                              "negative-right": "r-decr", "positive-right": ""}}"#,
        );
        assert_eq!(set().modifier("arms", &arms).unwrap().pairs, [[Some(2), Some(3)], [Some(4), None]]);
        let hump = category(r#"{"name": "hump", "has_left_and_right": false, "targets": ["hump"]}"#);
        assert_eq!(set().modifier("nose", &hump).unwrap().pairs, [[None, Some(6)]]);
        // Nothing that MakeHuman has no target for.
        assert!(set().modifier("mouth", &hump).is_none());
    }

    #[test]
    fn a_slider_of_our_own_goes_both_ways() {
        let mut set = set();
        let side = |x: f32| Target { points: vec![1], deltas: vec![Vec3::X * x] };
        set.add_procedural("toe", "feet", [side(1.0), side(2.0)]);
        let modifier = &set.modifiers[0];
        assert_eq!((modifier.name.as_str(), modifier.pairs.len()), ("toe|feet", 2));
        for (pair, x) in modifier.pairs.iter().zip([1.0, 2.0]) {
            let [negative, positive] = pair.map(|n| set.get(n.unwrap()).deltas[0].x);
            assert_eq!((negative, positive), (-x, x));
        }
        assert_eq!((set.len(), set.number("head/fat-incr"), set.number("toe")), (11, Some(1), None));
    }
}
