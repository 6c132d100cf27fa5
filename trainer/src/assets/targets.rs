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
    /// How far each moves.
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

/// A slider of MakeHuman's: a negative and a positive target, for the whole body or for each side.
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
    /// Reads every target that a body is made of; expressions, genitals and asymmetries are left out.
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
