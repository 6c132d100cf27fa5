//! temp
use anthronet::condition::*;
use anthronet::measure::*;
use anthronet::model::Model;
use anthronet::random::Random;
fn main() {
    let m = Model::embedded().unwrap();
    let s = m.shape_space().deviations();
    println!("{:?}", [0, 10, 20, 50, 100, 150, 200, 250, 299].map(|i| s[i]));
    let mut cases = vec![];
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
            cases.push((step, m.decode(&p.projected, p.sex, &p.z), p.given));
        }
    }
    for floor in [0.0, 0.005, 0.01, 0.02, 0.04] {
        let v: Vec<f64> = s.iter().map(|s| s * s + floor * floor).collect();
        for step in [1000.0, 100.0] {
            let (mut bad, mut its, mut worst, mut mv, mut disp) = (0, 0, 0f64, vec![], vec![]);
            for c in cases.iter().filter(|c| c.0 == step) {
                let o = solve(m.measured_space(), &c.1, &v, &c.2, &SolveOptions::default()).unwrap();
                if !o.converged {
                    bad += 1;
                }
                its += o.iterations;
                worst = worst.max(o.residual_max);
                mv.push(o.move_distance);
                disp.push(
                    (o.coefficients.iter().zip(&c.1).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / 13380.0)
                        .sqrt()
                        * 1e3,
                );
            }
            mv.sort_by(f64::total_cmp);
            disp.sort_by(f64::total_cmp);
            println!(
                "floor {floor} step {step}: bad {bad} its {:.2} worst {worst:.5} move median {:.2} max {:.2}; rms displacement mm median {:.2} max {:.2}",
                its as f64 / 150.0,
                mv[mv.len() / 2],
                mv[mv.len() - 1],
                disp[disp.len() / 2],
                disp[disp.len() - 1]
            );
        }
    }
}
