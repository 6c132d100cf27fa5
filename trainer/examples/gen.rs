//! temp
use anthronet_trainer::{corpus::*, dataset::*, landmarks};
fn main() {
    let c = Corpus::open("target/anthronet".as_ref()).unwrap();
    let t = std::time::Instant::now();
    if std::env::args().nth(1).is_some() {
        let m = &c.assets.mesh.mirror;
        let d = landmarks::definitions(&c, &|v| m.get(&v).copied()).unwrap();
        let s: Vec<String> = d.iter().map(|d| serde_json::to_string(d).unwrap()).collect();
        std::fs::write("model/measures.json", format!("[\n{}\n]\n", s.join(",\n"))).unwrap();
        for x in &d {
            println!("{} {:?} {} pts {} edges", x.name, x.kind, x.points.len(), x.edges.len());
        }
        println!("{:?}", t.elapsed());
        return;
    }
    let d = anthronet::measure::Definitions::embedded().unwrap();
    let ds = Dataset::load_or_make(&c, &d, "target/anthronet".as_ref(), &|w, a, b| {
        if a % 4800 == 0 {
            eprintln!("{:?} {w} {a}/{b}", t.elapsed())
        }
    })
    .unwrap();
    println!(
        "{} {} {} rejected {} {:?}",
        ds.train.len(),
        ds.validation.len(),
        ds.held_out.len(),
        ds.rejected,
        t.elapsed()
    );
    println!("std {:?}", &ds.basis.std[..5]);
    for (id, _) in d.iter() {
        let v: Vec<f64> = (0..ds.train.len()).map(|i| ds.train.measures(i)[id.index()] as f64).collect();
        let m = v.iter().sum::<f64>() / v.len() as f64;
        let s = (v.iter().map(|x| (x - m).powi(2)).sum::<f64>() / v.len() as f64).sqrt();
        println!(
            "{:28} {:.3} {:.3} {:.3} {:.3}",
            id.name(),
            m,
            s,
            v.iter().copied().fold(9.0, f64::min),
            v.iter().copied().fold(0.0, f64::max)
        );
    }
}
