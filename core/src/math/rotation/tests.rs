use glam::Vec3;
use sha2::{Digest, Sha256};

use super::Rotation;
use crate::random::Random;

/// Two random rotations, a vector, and an interpolation parameter from 0 to 1. Of eight pairs one is so close that slerp
/// interpolates linearly, and one is close with opposite signs.
fn case(random: &mut Random, number: usize) -> (Rotation, Rotation, Vec3, f32) {
    let mut component = || random.normal() as f32;
    let a = Rotation::from_xyzw(component(), component(), component(), component()).normalize();
    let b = Rotation::from_xyzw(component(), component(), component(), component()).normalize();
    let v = Vec3::new(component(), component(), component());
    let b = match number % 8 {
        0 => (Rotation::from_rotation_x(component() * 1e-4) * a).normalize(),
        4 => -(Rotation::from_rotation_z(component() * 1e-3) * a).normalize(),
        _ => b,
    };
    (a, b, v, random.uniform() as f32)
}

/// The bits of everything that glam computes in an order that depends on the processor.
fn results(a: Rotation, b: Rotation, v: Vec3, t: f32) -> Vec<u32> {
    let raw = Rotation::from_xyzw(a.x * 3.0, a.y * 3.0, a.z * 3.0, a.w * 3.0);
    let arc =
        Rotation::from_rotation_arc((a * Vec3::X).normalize_or_zero(), (b * Vec3::X).normalize_or_zero());
    let rotations = [raw.normalize(), a * b, a.slerp(b, t), arc].map(Rotation::to_array);
    let numbers = [a.dot(b), a.angle_between(b)];
    rotations.concat().into_iter().chain((a * v).to_array()).chain(numbers).map(f32::to_bits).collect()
}

#[test]
fn ten_thousand_results_are_these_on_every_processor() {
    let mut random = Random::new(2026, 0);
    let mut hash = Sha256::new();
    for number in 0..10_000 {
        let (a, b, v, t) = case(&mut random, number);
        for bits in results(a, b, v, t) {
            hash.update(bits.to_le_bytes());
        }
    }
    let hash: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(hash, "e69e84608a3e29bcbcff68a9bf3a08d2711f5c123e4be09cf5f6cadf77cc613d");
}

/// The goldens have the bits of glam's SSE2 code without fused multiplication and addition.
#[cfg(all(target_arch = "x86_64", not(target_feature = "fma")))]
#[test]
fn bits_equal_those_of_glam_on_x86_64() {
    use glam::{EulerRot, Quat};
    let bits = |q: Quat| q.to_array().map(f32::to_bits);
    let mut random = Random::new(7, 0);
    for number in 0..100_000 {
        let (a, b, v, t) = case(&mut random, number);
        let (p, q) = (Quat::from(a), Quat::from(b));
        let raw = Quat::from_xyzw(a.x * 3.0, a.y * 3.0, a.z * 3.0, a.w * 3.0);
        let arc =
            Quat::from_rotation_arc((p * Vec3::X).normalize_or_zero(), (q * Vec3::X).normalize_or_zero());
        let rotations = [raw.normalize(), p * q, p.slerp(q, t), arc].map(bits);
        let numbers = [p.dot(q), p.angle_between(q)].map(f32::to_bits);
        let glam: Vec<u32> = rotations
            .concat()
            .into_iter()
            .chain((p * v).to_array().map(f32::to_bits))
            .chain(numbers)
            .collect();
        assert_eq!(results(a, b, v, t), glam, "{a:?} {b:?} {v} {t}");
        let ours = [
            Rotation::from_scaled_axis(v),
            Rotation::from_rotation_x(v.x),
            Rotation::from_rotation_y(v.x),
            Rotation::from_rotation_z(v.x),
            Rotation::from_axis_angle(v.normalize_or(Vec3::X), t),
            Rotation::from_euler(EulerRot::ZXY, v.x, v.y, v.z),
        ];
        let theirs = [
            Quat::from_scaled_axis(v),
            Quat::from_rotation_x(v.x),
            Quat::from_rotation_y(v.x),
            Quat::from_rotation_z(v.x),
            Quat::from_axis_angle(v.normalize_or(Vec3::X), t),
            Quat::from_euler(EulerRot::ZXY, v.x, v.y, v.z),
        ];
        assert_eq!(ours.map(|r| r.to_array().map(f32::to_bits)), theirs.map(bits));
        assert_eq!(
            a.to_scaled_axis().to_array().map(f32::to_bits),
            p.to_scaled_axis().to_array().map(f32::to_bits)
        );
    }
}

#[test]
fn opposite_vectors_are_half_a_turn_apart() {
    let half = Rotation::from_rotation_arc(Vec3::Y, Vec3::NEG_Y);
    assert!((half * Vec3::Y).distance(Vec3::NEG_Y) < 1e-6);
    assert_eq!(Rotation::from_rotation_arc(Vec3::Y, Vec3::Y), Rotation::IDENTITY);
}
