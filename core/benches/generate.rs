//! Time to generate one body, on one thread.

use anthronet::Body;
use anthronet::condition::{Fill, Request};
use anthronet::format::gltf::to_glb;
use anthronet::measure::Sex;
use anthronet::model::Model;
use anthronet::scene::{Scene, SceneOptions};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

fn request() -> Request {
    let mut request = Request { sex: Some(Sex::Female), ..Request::default() };
    for (name, value) in [("height", 1.70), ("waist_circumference", 0.74), ("hip_circumference", 0.97)] {
        request.set(name, value).unwrap_or_else(|e| panic!("{e}"));
    }
    request
}

/// All measures given, to the millimetre.
fn full_request(model: &Model) -> Request {
    let body = body(model, &Request { seed: 3, fill: Fill::Sample, ..request() });
    let measures = body.measurements().map(|m| Some((1000.0 * m).round() / 1000.0));
    Request { sex: Some(Sex::Female), measures, ..Request::default() }
}

fn model() -> Model {
    Model::embedded().unwrap_or_else(|e| panic!("{e}"))
}

fn body(model: &Model, request: &Request) -> Body {
    model.generate(request).unwrap_or_else(|e| panic!("{e}"))
}

/// From three measures to vertices and normals of LOD 0.
#[divan::bench]
fn body_of_three_measures(bencher: Bencher<'_, '_>) {
    let (model, request) = (model(), request());
    bencher.bench_local(|| body(&model, black_box(&request)));
}

/// From all measures to vertices and normals of LOD 0.
#[divan::bench]
fn body_of_all_measures(bencher: Bencher<'_, '_>) {
    let model = model();
    let request = full_request(&model);
    bencher.bench_local(|| body(&model, black_box(&request)));
}

/// The coefficients only: checks, filling, decoder, exact solve.
#[divan::bench]
fn solve_of_all_measures(bencher: Bencher<'_, '_>) {
    let model = model();
    let request = full_request(&model);
    bencher.bench_local(|| model.solve(black_box(&request)));
}

/// Points of the cage and the accessories from coefficients.
#[divan::bench]
fn cage_of_coefficients(bencher: Bencher<'_, '_>) {
    let model = model();
    let body = body(&model, &request());
    bencher.bench_local(|| model.shape_space().body(black_box(body.coefficients())));
}

/// A body's scene of LOD 0 as .glb.
#[divan::bench]
fn glb_of_body(bencher: Bencher<'_, '_>) {
    let model = model();
    let body = body(&model, &request());
    bencher.bench_local(|| {
        Scene::from_body(black_box(&body), &SceneOptions::default()).and_then(|s| to_glb(&s))
    });
}

/// Opening the embedded model.
#[divan::bench]
fn open_model() -> Model {
    model()
}
