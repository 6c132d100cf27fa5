use proptest::prelude::*;

use super::super::prior::QUANTILE_COUNT;
use super::super::request::Request;
use super::super::test_prior::sex_prior;
use super::*;
use crate::random::Random;

fn assess(pairs: &[(&str, f64)]) -> Feasibility {
    let mut request = Request::default();
    for (name, value) in pairs {
        request.set(name, *value).unwrap();
    }
    judge(&sex_prior(0.0, 0.0), &request.measures, &Limits::default())
}

fn judge(prior: &SexPrior, given: &GivenMeasures, limits: &Limits) -> Feasibility {
    Feasibility::assess([prior; 2], Population::Ansur2, Sex::Female, given, limits).unwrap()
}

fn names(conflict: &Conflict) -> Vec<&str> {
    conflict.measures.iter().map(|m| m.name).collect()
}

#[test]
fn ordinary_requests_pass_without_a_warning() {
    for pairs in [
        &[][..],
        &[("height", 1.75)],
        &[("height", 1.60), ("waist_circumference", 1.10), ("arm_length", 0.30)],
        &[("arm_length_left", 0.32), ("arm_length_right", 0.325)],
    ] {
        let found = assess(pairs);
        assert!(found.is_feasible() && found.warning().is_none(), "{found:?}");
        assert_eq!(found.infeasible().to_string(), "");
    }
}

#[test]
fn unusual_measures_give_a_warning() {
    let found = (90..120)
        .map(|hip| {
            let hip = f64::from(hip) / 100.0;
            assess(&[("height", 1.69), ("waist_circumference", 0.60), ("hip_circumference", hip)])
        })
        .find(|found| found.warning().is_some() || !found.is_feasible())
        .unwrap();
    // Between ordinary and infeasible there is unusual.
    assert!(found.is_feasible());
    let warning = found.warning().unwrap();
    assert!(warning.contains("unusual together") && warning.contains("female"), "{warning}");
}

#[test]
fn a_conflicting_pair_is_found_among_many() {
    let found = assess(&[
        ("height", 1.70),
        ("head_circumference", 0.54),
        ("foot_width", 0.095),
        ("calf_length", 0.42),
        ("waist_circumference", 0.55),
        ("hip_circumference", 1.38),
    ]);
    assert_eq!(found.conflicts.len(), 1, "{found:?}");
    assert_eq!(names(&found.conflicts[0]), ["waist_circumference", "hip_circumference"]);
    let [waist, hip] = found.conflicts[0].measures.as_slice() else { panic!() };
    assert!(waist.nearest > waist.asked && hip.nearest < hip.asked);
    let message = found.infeasible().to_string();
    let start = "waist_circumference 0.55 m and hip_circumference 1.38 m do not go together for a female: nearest feasible are ";
    assert!(message.starts_with(start), "{message}");
    assert_eq!(found.nearest[3], Some(1.70));
}

#[test]
fn sides_are_one_name_and_can_conflict_with_each_other() {
    let found = assess(&[("height", 1.69), ("arm_length_left", 0.26), ("arm_length_right", 0.38)]);
    assert_eq!(names(&found.conflicts[0]), ["arm_length_left", "arm_length_right"]);
    let found = assess(&[("height", 1.69), ("arm_length", 0.58)]);
    let message = found.infeasible().to_string();
    assert!(
        message.starts_with("arm_length 0.58 m is out of reach for a female: nearest feasible is 0."),
        "{message}"
    );
    let [left, right] = found.conflicts[0].measures.as_slice() else { panic!() };
    assert_eq!(left.nearest, right.nearest);
}

#[test]
fn a_conflict_of_many_is_found_by_greedy_removal() {
    // Independent measures, each two deviations off: the distance grows with the root of their number and the limit more
    // slowly, so that only more names than the exhaustive search tries exceed it.
    let limits = Limits { refuse_tail: 1e-4, slack: 1.0, ..Limits::default() };
    let n = MEASURE_COUNT;
    let covariance: Vec<_> = (0..n * n).map(|i| f64::from(u8::from(i % (n + 1) == 0))).collect();
    let p = SexPrior::new(&[10.0; MEASURE_COUNT], &covariance, &vec![10.0; n * QUANTILE_COUNT]).unwrap();
    let given = std::array::from_fn(|i| MeasureId::from_index(i)?.side().is_none().then_some(12.0));
    let found = judge(&p, &given, &limits);
    assert!(found.conflicts[0].measures.len() > FULL_SEARCH, "{found:?}");
    assert!(is_feasible(&p, &found.nearest, &limits));
}

fn is_feasible(p: &SexPrior, given: &GivenMeasures, limits: &Limits) -> bool {
    judge(p, given, limits).is_feasible()
}

#[test]
fn a_request_of_many_conflicts_gets_a_short_message() {
    let p = sex_prior(0.0, 0.0);
    let mut random = Random::new(1, 3);
    let given = std::array::from_fn(|i| {
        let deviation = p.covariance()[i * (MEASURE_COUNT + 1)].sqrt();
        Some(p.mean()[i] + 3.0 * deviation * random.normal())
    });
    let found = judge(&p, &given, &Limits::default());
    let last = &found.conflicts.last().unwrap().message;
    assert!(last.contains(" measures do not go together for a female, most of all "), "{last}");
    assert!(found.infeasible().to_string().len() < 1000, "{}", found.infeasible().to_string());
}

#[test]
fn huge_numbers_are_judged_too() {
    for value in [1e12, 1e200, f64::MAX, -f64::MAX] {
        let found = assess(&[("height", value), ("waist_circumference", 0.8)]);
        assert!(!found.is_feasible());
        assert!(is_feasible(&sex_prior(0.0, 0.0), &found.nearest, &Limits::default()));
    }
    let mut given = [None; MEASURE_COUNT];
    given[0] = Some(f64::NAN);
    let p = sex_prior(0.0, 0.0);
    let judged = Feasibility::assess([&p; 2], Population::Ansur2, Sex::Female, &given, &Limits::default());
    assert!(judged.is_err());
}

#[test]
fn what_people_are_not_but_bodies_are_gives_a_warning() {
    // Bodies whose girth is four deviations larger than people's.
    let (people, bodies) = (sex_prior(0.0, 0.0), sex_prior(0.0, 4.0));
    let assess = |waist: f64, hip: f64| {
        let mut given = [None; MEASURE_COUNT];
        for (name, value) in [("height", 1.69), ("waist_circumference", waist), ("hip_circumference", hip)] {
            given[MeasureId::from_name(name).unwrap().index()] = Some(value);
        }
        let priors = [&people, &bodies];
        Feasibility::assess(priors, Population::Ansur2, Sex::Female, &given, &Limits::default()).unwrap()
    };
    let heavy = assess(1.55, 1.50);
    assert!(heavy.is_feasible() && heavy.distance <= heavy.refuse * 2.0, "{heavy:?}");
    assert!(heavy.warning().unwrap().contains("female people of ANSUR II"), "{:?}", heavy.warning());
    // Contradicting both, it is moved to the nearer of them.
    let wrong = assess(1.75, 0.85);
    assert!(!wrong.is_feasible());
    let nearest = Feasibility::assess(
        [&people, &bodies],
        Population::Ansur2,
        Sex::Female,
        &wrong.nearest,
        &Limits::default(),
    );
    assert!(nearest.unwrap().is_feasible());
}

#[test]
fn numbers_have_thousands() {
    assert_eq!(thousands(12.0), "12");
    assert_eq!(thousands(1_200_000.0), "1,200,000");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn nearest_values_are_feasible_and_conflicts_are_minimal(
        seed in any::<u64>(),
        spread in 0.5..12.0f64,
        mask in prop::collection::vec(prop::bool::weighted(0.35), MEASURE_COUNT),
    ) {
        let (p, limits) = (sex_prior(0.0, 0.0), Limits::default());
        let mut random = Random::new(seed, 3);
        let mut given = [None; MEASURE_COUNT];
        for i in 0..MEASURE_COUNT {
            let deviation = p.covariance()[i * (MEASURE_COUNT + 1)].sqrt();
            given[i] = mask[i].then(|| p.mean()[i] + spread * deviation * random.normal());
        }
        let found = judge(&p, &given, &limits);
        prop_assert_eq!(found.is_feasible(), found.distance <= found.refuse);
        prop_assert!(is_feasible(&p, &found.nearest, &limits), "{:?}", found);
        prop_assert_eq!(found.nearest.map(|v| v.is_some()).to_vec(), mask.clone());
        let mut named: Vec<_> = found.conflicts.iter().flat_map(names).collect();
        let count = named.len();
        named.sort_unstable();
        named.dedup();
        prop_assert_eq!(named.len(), count);
        // Measures in no conflict keep their given values.
        for id in MeasureId::all() {
            if !found.conflicts.iter().any(|c| c.measures.iter().any(|m| m.name == id.name())) {
                prop_assert_eq!(found.nearest[id.index()], given[id.index()]);
            }
        }
        // The first conflict is infeasible by itself, and feasible without any one of its names.
        if let Some(first) = found.conflicts.first() {
            let values = |keep: &dyn Fn(&str) -> bool| {
                let mut values = [None; MEASURE_COUNT];
                for m in first.measures.iter().filter(|m| keep(stem(m.name))) {
                    values[MeasureId::from_name(m.name).unwrap().index()] = Some(m.asked);
                }
                values
            };
            prop_assert!(!is_feasible(&p, &values(&|_| true), &limits));
            let mut stems: Vec<_> = first.measures.iter().map(|m| stem(m.name)).collect();
            // The two sides of a measure are not beside each other.
            stems.sort_unstable();
            stems.dedup();
            for left_out in &stems {
                prop_assert!(is_feasible(&p, &values(&|s| s != *left_out), &limits), "{left_out} {:?}", first);
            }
            // Nor are there smaller ones: no name and no pair of names of the request, sides together.
            let mut all: Vec<_> =
                MeasureId::all().filter(|id| mask[id.index()]).map(|id| id.base_name()).collect();
            all.sort_unstable();
            all.dedup();
            let of = |names: &[&str]| {
                std::array::from_fn(|i| {
                    given[i].filter(|_| names.contains(&MeasureId::from_index(i).unwrap().base_name()))
                })
            };
            for (i, a) in all.iter().enumerate() {
                prop_assert!(stems.len() == 1 || is_feasible(&p, &of(&[a]), &limits), "{a}");
                for b in &all[..i] {
                    prop_assert!(stems.len() <= 2 || is_feasible(&p, &of(&[a, b]), &limits), "{a} {b}");
                }
            }
        }
    }
}

fn stem(name: &str) -> &str {
    MeasureId::from_name(name).unwrap().base_name()
}
