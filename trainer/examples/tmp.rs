//! temp
use anthronet::condition::*;
use anthronet::measure::*;
use anthronet::model::Model;
use anthronet::random::Random;
use anthronet_trainer::{corpus::*, dataset::*};
fn main() {
    let m = Model::embedded().unwrap();
    let c = Corpus::open("target/anthronet".as_ref()).unwrap();
    let d = Definitions::embedded().unwrap();
    let ds = Dataset::load_or_make(&c, &d, "target/anthronet".as_ref(), &|_, _, _| {}).unwrap();
    let lim = Limits::default();
    for keep in [1.0, 0.5, 0.2] {
        let mut r: Vec<f64> = (0..ds.held_out.len())
            .map(|i| {
                let mut rnd = Random::new(i as u64, 5);
                let mut g = [None; 36];
                for (s, v) in g.iter_mut().zip(ds.held_out.measures(i)) {
                    if rnd.uniform() < keep {
                        *s = Some((f64::from(*v) * 100.).round() / 100.);
                    }
                }
                let sex = ds.held_out.sex(i);
                let f = Feasibility::assess(m.prior().of(sex), sex, &g, &lim).unwrap();
                let cs = f.distance;
                cs / f.warn
            })
            .collect();
        r.sort_by(f64::total_cmp);
        println!(
            "keep {keep}: distance/warn 50% {:.2} 99% {:.2} 99.9% {:.2} max {:.2}",
            r[r.len() / 2],
            r[r.len() * 99 / 100],
            r[r.len() * 999 / 1000],
            r[r.len() - 1]
        );
    }
    for n in [1usize, 2, 3, 6, 12, 24, 36] {
        println!("n {n} warn {:.2} refuse {:.2}", lim.warn(n), lim.refuse(n));
    }
    let v: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string("tests/data/paper_vectors.json").unwrap()).unwrap();
    let list: Vec<serde_json::Value> = if let Some(a) = v.as_array() {
        a.clone()
    } else {
        v.as_object().unwrap().values().filter(|x| x.is_object()).cloned().collect()
    };
    for e in list {
        let mut e = e.as_object().unwrap().clone();
        e.retain(|k, _| k == "sex" || k == "measures");
        let r = Request::from_json(&serde_json::Value::Object(e).to_string()).unwrap();
        let sex = r.sex.unwrap();
        let f = Feasibility::assess(m.prior().of(sex), sex, &r.measures, &lim).unwrap();
        let s = m.solve(&r).map(|s| (s.outcome.iterations, s.outcome.residual_max, s.outcome.move_distance));
        println!("paper: distance {:.2} warn {:.2} refuse {:.2} {:?}", f.distance, f.warn, f.refuse, s);
    }
    // rounding
    let mut bad = 0;
    for i in 0..600 {
        for step in [1000.0, 100.0] {
            let mut rnd = Random::new(i as u64, 5);
            let mut r = Request { sex: Some(ds.held_out.sex(i)), seed: i as u64, ..Default::default() };
            for (s, v) in r.measures.iter_mut().zip(ds.held_out.measures(i)) {
                if rnd.uniform() < 0.7 {
                    *s = Some((f64::from(*v) * step).round() / step);
                }
            }
            match m.solve(&r) {
                Ok(s) => {
                    if !s.outcome.converged {
                        bad += 1;
                        if bad < 12 {
                            println!(
                                "{i} step {step} it {} res {:.6} move {:.1}",
                                s.outcome.iterations, s.outcome.residual_max, s.outcome.move_distance
                            )
                        }
                    }
                }
                Err(e) => println!("{i} {e}"),
            }
        }
    }
    println!("not converged {bad} of 1200");
}
