//! temp
use anthronet::model::config::GeneratorConfig;
use anthronet_trainer::{basis, corpus::*, dataset::*, generator::*};
fn set(b: &Bodies) -> TrainingSet {
    TrainingSet {
        count: b.len(),
        k: basis::COMPONENTS,
        coefficients: b.coefficients.clone(),
        measures: b.measures.clone(),
        sex: b.sex.clone(),
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let c = Corpus::open("target/anthronet".as_ref()).unwrap();
    let d = anthronet::measure::Definitions::embedded().unwrap();
    let ds = Dataset::load_or_make(&c, &d, "target/anthronet".as_ref(), &|_, _, _| {}).unwrap();
    let q = basis::laplacian(&ds.basis, &c);

    let stats = ShapeStatistics {
        vertex_count: 13380,
        coefficient_std: ds.basis.std.clone(),
        laplacian: Some(QuadraticForm {
            matrix: q.matrix,
            vector: q.vector.iter().map(|v| 2.0 * v).collect(),
            constant: q.constant,
        }),
    };
    let mut config = GeneratorConfig::default();
    config.gamma = 1e-4;
    config.beta = a[3].parse().unwrap();
    config.width = a[4].parse().unwrap();
    let o = TrainingOptions {
        out_dir: a[1].clone().into(),
        epochs: a[2].parse().unwrap(),
        quiet: true,
        validate_every: 5,
        learning_rate: a.get(5).map_or(0.005, |x| x.parse().unwrap()),
        ..Default::default()
    };
    std::fs::create_dir_all(&a[1]).unwrap();
    let t = std::time::Instant::now();
    let r = train(&set(&ds.train), &set(&ds.validation), &stats, &config, &o).unwrap();
    for h in &r.history {
        println!(
            "{} {:?} rms {:.3} z0 {:.3} samp {:.3} div {:.2} lat {:?}",
            h.epoch,
            h.training,
            h.rms_mm,
            h.rms_z0_mm,
            h.rms_sampled_mm,
            h.divergence,
            h.latent_std.iter().map(|x| (x * 100.).round() / 100.).collect::<Vec<_>>()
        );
    }
    println!("{:?}", t.elapsed());
}
