//! Makes `model/landmarks.json`: the points of the body that surveys and standards name, as points of the mesh.
//!
//! Where the skin shows a landmark (nipple, navel, chin, heel), it is that feature's vertex. Where only bone shows it
//! (trochanterion, tenth rib, iliac crest), it was chosen on the mean woman and the mean man at the height and breadth that
//! ANSUR II's means give, as shares of stature. The mesh carries the point over all other bodies.

use anthronet::Side;
use anthronet::measure::{Landmark, Point};

use crate::{Error, Result};

/// A landmark; of a pair, the left one.
struct Row {
    name: &'static str,
    sided: bool,
    /// Vertices of the cage whose mean it is.
    vertices: &'static [u32],
    place: &'static str,
}

const fn central(name: &'static str, vertices: &'static [u32], place: &'static str) -> Row {
    Row { name, sided: false, vertices, place }
}

const fn sided(name: &'static str, vertices: &'static [u32], place: &'static str) -> Row {
    Row { name, sided: true, vertices, place }
}

/// The acromion and the radiale of the left arm.
pub(crate) const ACROMION: [u32; 2] = [8_279, 8_289];
pub(crate) const RADIALE: u32 = 10_055;

/// From head to foot. Terms are those of the measurer's handbook of ANSUR II (Hotzman et al. 2011), which ISO 7250-1 and
/// ISO 8559-1 share.
#[rustfmt::skip]
const ROWS: &[Row] = &[
    central("vertex", &[881], "top of the head in the midline"),
    central("glabella", &[234], "foremost point of the forehead between the brow ridges"),
    central("sellion", &[132], "deepest point of the root of the nose"),
    central("menton", &[732], "lowest point of the chin in the midline"),
    sided("tragion", &[12_332], "notch above the small flap in front of the ear canal"),
    sided("zygion", &[11_845], "cheekbone where it is widest"),
    sided("gonion", &[7_460], "outer corner of the lower jaw"),
    central("infrathyroid", &[803], "front of the neck just below the Adam's apple"),
    sided("neck_side", &[8_188], "side of the base of the neck, on the edge of the trapezius"),
    central("cervicale", &[1_491], "spine of the seventh cervical vertebra"),
    central("suprasternale", &[1_524], "lowest point of the notch above the breastbone"),
    sided("acromion", &ACROMION, "outer edge of the shoulder blade's tip, above the shoulder joint"),
    sided("axilla", &[8_338], "hollow of the armpit"),
    sided("anterior_axillary_fold", &[8_097], "fold of the armpit towards the chest"),
    sided("posterior_axillary_fold", &[8_303], "fold of the armpit towards the back"),
    sided("bustpoint", &[8_452, 8_456, 8_460, 8_464], "centre of the nipple"),
    sided("tenth_rib", &[10_667], "lowest edge of the ribs at the side"),
    central("omphalion", &[4_121], "centre of the navel"),
    sided("iliocristale", &[10_717], "highest point of the iliac crest at the side"),
    sided("anterior_superior_iliac_spine", &[10_947, 10_950], "foremost point of the iliac crest"),
    sided("posterior_superior_iliac_spine", &[10_839], "rearmost point of the iliac crest, in the dimple of the back"),
    sided("buttock_point", &[10_854], "rearmost point of the buttock"),
    sided("trochanterion", &[10_932, 10_938], "top of the thigh bone's greater trochanter, at the side of the hip"),
    central("crotch", &[4_372], "lowest point between the legs in the midline"),
    sided("gluteal_fold", &[10_898], "crease between buttock and thigh"),
    sided("suprapatella", &[11_230], "upper edge of the kneecap"),
    sided("midpatella", &[11_249, 11_268], "centre of the kneecap"),
    sided("lateral_femoral_epicondyle", &[11_267], "outermost point of the thigh bone at the knee"),
    sided("medial_femoral_epicondyle", &[13_003], "innermost point of the thigh bone at the knee"),
    sided("tibiale", &[11_286, 11_305], "upper edge of the shin bone at the outer side of the knee"),
    sided("lateral_malleolus", &[11_444], "outermost point of the outer ankle"),
    sided("medial_malleolus", &[12_935], "innermost point of the inner ankle"),
    sided("pternion", &[12_464], "rearmost point of the heel"),
    sided("first_metatarsophalangeal", &[12_390], "innermost point of the ball of the foot"),
    sided("fifth_metatarsophalangeal", &[12_793], "outermost point of the ball of the foot"),
    sided("acropodion", &[11_624], "tip of the longest toe"),
    sided("radiale", &[RADIALE], "upper edge of the head of the radius, at the outer side of the elbow"),
    sided("olecranon", &[10_042], "point of the elbow"),
    sided("stylion", &[10_562], "tip of the radius at the thumb's side of the wrist"),
    sided("metacarpale_2", &[9_828], "outer edge of the knuckle of the index finger"),
    sided("metacarpale_5", &[9_876], "outer edge of the knuckle of the little finger"),
    sided("dactylion_3", &[8_790], "tip of the middle finger"),
];

/// All landmarks, from head to foot, left before right; `mirror` gives a cage vertex's mirror image.
///
/// # Errors
/// [`Error::Source`] when a vertex has no mirror image.
pub fn landmarks(mirror: &dyn Fn(u32) -> Option<u32>) -> Result<Vec<Landmark>> {
    let mut out = Vec::new();
    for row in ROWS {
        let weight = 1.0 / row.vertices.len() as f64;
        let mut add = |name: String, vertices: Vec<u32>| {
            let point = Point(vertices.into_iter().map(|v| (v, weight)).collect());
            out.push(Landmark { name, place: row.place.to_owned(), point });
        };
        if !row.sided {
            add(row.name.to_owned(), row.vertices.to_vec());
            continue;
        }
        for side in Side::ALL {
            let on_side = |&v: &u32| match side {
                Side::Left => Ok(v),
                Side::Right => mirror(v)
                    .ok_or_else(|| Error::Source(format!("hm08.mirror: vertex {v} has no mirror image"))),
            };
            let vertices = row.vertices.iter().map(on_side).collect::<Result<_>>()?;
            add(format!("{}{}", row.name, side.measure_suffix()), vertices);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sided_rows_come_in_pairs_of_mirror_images() {
        let list = landmarks(&|v| Some(v + 100_000)).unwrap();
        assert_eq!(list.len(), ROWS.iter().map(|row| 1 + usize::from(row.sided)).sum::<usize>());
        let of = |name: &str| &list.iter().find(|landmark| landmark.name == name).unwrap().point.0;
        assert_eq!(of("acromion_left"), &[(8_279, 0.5), (8_289, 0.5)]);
        assert_eq!(of("acromion_right"), &[(108_279, 0.5), (108_289, 0.5)]);
        assert_eq!(of("menton"), &[(732, 1.0)]);
        let error = landmarks(&|_| None).unwrap_err().to_string();
        assert!(error.contains("12332"), "{error}");
    }
}
