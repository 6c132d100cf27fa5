use anthronet_trainer::{assets::*, sampling::*, tpose::*};
use std::io::Write;
fn main() {
    let mut w = Wheel::open_or_fetch("target/anthronet".as_ref()).unwrap();
    let t = std::time::Instant::now();
    let mut a = Assets::load(&mut w).unwrap();
    eprintln!(
        "load {:?} targets {} modifiers {} joints {}",
        t.elapsed(),
        a.targets.len(),
        a.targets.modifiers.len(),
        a.rig.joints.len()
    );
    let s = Sampler::new(&mut a).unwrap();
    let tp = TPose::new(&a).unwrap();
    let cc = anthronet::mesh::Subdivision::new(&a.mesh.cage).unwrap();
    let n: u64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let t = std::time::Instant::now();
    let mut f = std::fs::File::create("/tmp/dump.bin").unwrap();
    for i in 0..n {
        let p = s.draw(&a, 1, i);
        let mut x = s.shape(&a, &p);
        if std::env::args().nth(2).is_none() {
            tp.apply(&a, &mut x);
        }
        let fine = cc.refine(&x[..13380]).unwrap();
        f.write_all(&(p.sex.index() as f32).to_le_bytes()).unwrap();
        for v in fine.iter().chain(&x[13380..]) {
            for c in v.to_array() {
                f.write_all(&c.to_le_bytes()).unwrap();
            }
        }
    }
    eprintln!("{:?} per body", t.elapsed() / n as u32);
    let mut q = std::fs::File::create("/tmp/dump_quads.bin").unwrap();
    for v in cc.refined().quads.iter().flatten() {
        q.write_all(&v.to_le_bytes()).unwrap();
    }
    for j in &a.rig.joints {
        eprint!("{} ", j.name);
    }
    eprintln!(
        "{:?}",
        a.mesh.accessories.iter().map(|x| (x.name, x.start, x.topology.vertex_count)).collect::<Vec<_>>()
    );
}
