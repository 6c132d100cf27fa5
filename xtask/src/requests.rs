//! The requests of the goldens and the cross-boundary tests, as arguments of `anthronet generate`.

/// The README's first command, without its output.
pub(crate) const README: &[&str] = &["--sex", "female", "-m", "height=1.70"];

/// A motion file for another skeleton, from the repository's root: a few joints in centimetres, 25 frames a second.
pub(crate) const BVH: &str = "tests/data/bend.bvh";

/// A named request.
pub(crate) struct Person {
    /// File stem and key of the golden.
    pub(crate) name: &'static str,
    /// Arguments of `anthronet generate`.
    pub(crate) arguments: &'static [&'static str],
}

/// Both sexes, thin and heavy, short and tall, nothing given and random.
pub(crate) const PEOPLE: &[Person] = &[
    Person { name: "readme", arguments: README },
    Person { name: "man", arguments: &["--sex", "male"] },
    Person {
        name: "heavy_man",
        arguments: &["--sex", "male", "-m", "height=1.72", "-m", "waist_circumference=1.15", "--seed", "5"],
    },
    Person {
        name: "thin_tall_woman",
        arguments: &[
            "--sex",
            "female",
            "-m",
            "height=1.88",
            "-m",
            "waist_circumference=0.68",
            "-m",
            "hip_circumference=0.90",
            "--seed",
            "11",
        ],
    },
    Person {
        name: "uneven_arms",
        arguments: &["--sex", "male", "-m", "arm_length_left=0.34", "-m", "arm_length_right=0.33"],
    },
];
