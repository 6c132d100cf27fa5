//! The generated body, which [`Model::generate`] returns.

use std::sync::Arc;

use glam::Vec3;

use crate::Result;
use crate::condition::{Prepared, Report, Request, SolveOutcome};
use crate::measure::{MEASURE_COUNT, Mass, MeasureId, Measurements, Sex, enclosed_volume};
use crate::mesh::vertex_normals;
use crate::model::{Character, Model, Solved};
use crate::skeleton::Skeleton;

/// A person in the bind pose: a T-pose, standing on y = 0, facing +Z, the pelvis over the origin. Metres, model space.
#[derive(Clone)]
pub struct Body {
    character: Arc<Character>,
    coefficients: Vec<f64>,
    /// Vertices of LOD 0, then those of the accessories.
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    skeleton: Arc<Skeleton>,
    report: Report,
    measurements: Measurements,
    mass: Mass,
}

impl std::fmt::Debug for Body {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Body").field("report", &self.report).finish_non_exhaustive()
    }
}

impl Model {
    /// Generates the body of a request.
    ///
    /// # Errors
    /// [`crate::Error::Request`] for a wrong field, [`crate::Error::Infeasible`] for measures that no person has together.
    pub fn generate(&self, request: &Request) -> Result<Body> {
        let solved = self.solve(request)?;
        Body::new(self, request, &solved)
    }

    /// The body between two requests (the paper's Fig. 4): shape coefficients and measures are interpolated linearly, `t` in
    /// 0..=1, and the measures met exactly. Sex, seed and fill of the report are those of the nearer request, warnings and
    /// conflicts those of both.
    ///
    /// # Errors
    /// As [`generate`](Self::generate), and when `t` is not in 0..=1.
    pub fn interpolate(&self, from: &Request, to: &Request, t: f64) -> Result<Body> {
        if !(0.0..=1.0).contains(&t) {
            return Err(crate::Error::request("t", format!("expected 0 to 1, got {t}")));
        }
        let (a, b) = (self.solve(from)?, self.solve(to)?);
        let between =
            |x: &[f64], y: &[f64]| -> Vec<f64> { x.iter().zip(y).map(|(x, y)| x + (y - x) * t).collect() };
        let start = between(&a.outcome.coefficients, &b.outcome.coefficients);
        let measures = between(&a.outcome.obtained, &b.outcome.obtained);
        let measures: [Option<f64>; MEASURE_COUNT] = std::array::from_fn(|i| measures.get(i).copied());
        let outcome: SolveOutcome = self.solve_from(&start, &measures)?;
        let (nearer, request) = if t < 0.5 { (&a, from) } else { (&b, to) };
        let z = between(&a.prepared.z, &b.prepared.z);
        let prepared = Prepared { given: measures, z, warnings: Vec::new(), ..nearer.prepared.clone() };
        let mut body = Body::new(self, request, &Solved { prepared, decoded: start, outcome })?;
        body.report = body.report.interpolated([&a.prepared, &b.prepared]);
        Ok(body)
    }
}

impl Body {
    fn new(model: &Model, request: &Request, solved: &Solved) -> Result<Self> {
        let character = model.character().clone();
        let coefficients = solved.outcome.coefficients.clone();
        let surface = model.shape_space().body(&coefficients);
        let cage = character.cage().vertex_count;
        let mut points = character.subdivision().refine(&surface[..cage])?;
        let mut bones = model.joints_of(&coefficients);
        bones.straighten(character.joint_tree());

        // The lowest vertex of the body goes to y = 0, the root joint to the origin.
        let floor = points.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        points.extend_from_slice(&surface[cage..]);
        for p in points.iter_mut().chain(&mut bones.heads).chain(&mut bones.tails) {
            p.y -= floor;
        }
        if let Some(root) = bones.heads.first_mut() {
            *root = Vec3::ZERO;
        }
        let refined = character.subdivision().refined();
        let body = &points[..refined.vertex_count];
        let mut normals = vertex_normals(body, &refined.quads, character.faces_around());
        for accessory in character.accessories() {
            let start = refined.vertex_count + accessory.start - cage;
            let own = &points[start..start + accessory.topology.vertex_count];
            let around = crate::mesh::VertexFaces::new(own.len(), &accessory.topology.quads);
            normals.extend(vertex_normals(own, &accessory.topology.quads, &around));
        }
        let volume = enclosed_volume(|v| body[v as usize].as_dvec3(), &refined.quads);
        let measurements = solved.outcome.obtained;
        let mass = Mass::new(volume, measurements[MeasureId::HEIGHT.index()]);
        let report = Report::new(
            request,
            &solved.prepared,
            model.priors(),
            &solved.outcome,
            mass.mass_kg,
            mass.volume_m3,
        );
        let skeleton = Arc::new(bones.skeleton(character.joint_tree())?);
        Ok(Self { character, coefficients, points, normals, skeleton, report, measurements, mass })
    }

    /// The sex that the body was conditioned on.
    pub fn sex(&self) -> Sex {
        self.report.sex
    }

    /// The report on the request and the body.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// All measures, metres, in the order of [`MeasureId`].
    pub fn measurements(&self) -> &Measurements {
        &self.measurements
    }

    /// Volume, mass and body mass index.
    pub fn mass(&self) -> Mass {
        self.mass
    }

    /// Coefficients in the shape space, metres, one per component.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// What the body shares with all others: topology, joint tree, skin weights.
    pub fn character(&self) -> &Character {
        &self.character
    }

    /// The joint tree with this body's bind pose, which is also its rest pose.
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// Vertices of LOD 0, metres, in model order; the first ones are those of LOD 1.
    pub fn vertices(&self) -> &[Vec3] {
        &self.points[..self.character.subdivision().refined().vertex_count]
    }

    /// Unit normals of the vertices of LOD 0.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals[..self.vertices().len()]
    }

    /// Vertices (metres) and unit normals of an accessory, by its index in [`Character::accessories`]; `None` out of range.
    pub fn accessory(&self, index: usize) -> Option<(&[Vec3], &[Vec3])> {
        let accessory = self.character.accessories().get(index)?;
        let start = self.vertices().len() + accessory.start - self.character.cage().vertex_count;
        let range = start..start + accessory.topology.vertex_count;
        Some((&self.points[range.clone()], &self.normals[range]))
    }
}
