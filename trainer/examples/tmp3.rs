//! temp
use anthronet::condition::*;
use anthronet::measure::*;
use anthronet::model::Model;
use anthronet::random::Random;
fn main() {
    let m = Model::embedded().unwrap();
    let s = m.shape_space().deviations();
    let v: Vec<f64> = s.iter().map(|s| s * s + 0.03 * 0.03).collect();
    for seed in 1..=150u64 {
        let other = m
            .generate(&Request {
                sex: Some(Sex::ALL[seed as usize % 2]),
                seed,
                fill: Fill::Sample,
                ..Request::default()
            })
            .unwrap();
        for step in [1000.0, 100.0] {
            let mut request = Request { sex: Some(other.sex()), seed: seed + 100, ..Request::default() };
            let mut random = Random::new(seed, 9);
            for (slot, value) in request.measures.iter_mut().zip(other.measurements()) {
                *slot = (random.uniform() < 0.7).then_some((step * value).round() / step);
            }
            let Ok(p) = Prepared::new(&request, m.prior(), m.ranges(), &Limits::default(), 10) else {
                continue;
            };
            let c = m.decode(&p.projected, p.sex, &p.z);
            let o = solve(m.measured_space(), &c, &v, &p.given, &SolveOptions::default()).unwrap();
            if o.move_distance > 8.0 {
                let m0 = m.measures_of(&c);
                println!(
                    "seed {seed} step {step} conv {} move {:.1} res {:.4}",
                    o.converged, o.move_distance, o.residual_max
                );
                // leave one out: which measure drives the move
                let mut eff: Vec<(f64, String)> = vec![];
                for (id, a) in request.given() {
                    let mut g = p.given;
                    g[id.index()] = None;
                    let o2 = solve(m.measured_space(), &c, &v, &g, &SolveOptions::default()).unwrap();
                    eff.push((
                        o2.move_distance,
                        format!("{} asked {:.3} start {:.4}", id.name(), a, m0[id.index()]),
                    ));
                }
                eff.sort_by(|a, b| a.0.total_cmp(&b.0));
                for e in &eff[..3] {
                    println!("   without {}: move {:.2}", e.1, e.0);
                }
            }
        }
    }
}
