use super::*;
use crate::export::synthetic::{arm, bent};

/// With a scene's clip.
fn moving(influences: usize) -> Scene {
    let mut scene = arm(influences);
    scene.clips = vec![bent(&scene)];
    scene
}

#[test]
fn dump() {
    std::fs::write("/tmp/usd-arm.usda", to_usda(&moving(4)).unwrap()).unwrap();
    std::fs::write("/tmp/usd-arm.usdc", to_usdc(&moving(4)).unwrap()).unwrap();
    std::fs::write("/tmp/usd-arm.usdz", to_usdz(&moving(4)).unwrap()).unwrap();
}
