//! temp
use anthronet_trainer::corpus::*;
use rayon::prelude::*;
fn main() {
    let c = Corpus::open("target/anthronet".as_ref()).unwrap();
    let d = anthronet::measure::Definitions::embedded().unwrap();
    let g = Gauge::new(&d, &c.subdivision);
    let all: Vec<_> = (0..4000u64)
        .into_par_iter()
        .map(|n| {
            let s = c.specimen(n);
            (s.sex, g.read(&s.points))
        })
        .collect();
    let ok: Vec<_> = all.iter().filter(|x| plausible(&x.1)).collect();
    println!("kept {} of {}", ok.len(), all.len());
    for (id, _) in d.iter().take(24) {
        let v: Vec<f64> = ok.iter().map(|x| x.1[id.index()]).collect();
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
