use super::super::test_prior::{prior, priors, ranges};
use super::*;
use crate::measure::MeasureId;

fn prepare(request: &Request) -> Result<Prepared> {
    Prepared::new(request, &priors(), &ranges(), &Limits::default(), 10)
}

#[test]
fn an_empty_request_is_the_mean_woman() {
    let prepared = prepare(&Request::default()).unwrap();
    assert_eq!(prepared.sex, Sex::Female);
    assert_eq!(&prepared.filled, prior().of(Sex::Female).mean());
    assert_eq!(prepared.z, vec![0.0; 10]);
    assert_eq!(prepared.warnings, ["sex not given, nor any measure: female assumed"]);
}

#[test]
fn a_sex_that_was_not_given_is_inferred() {
    let prepared = prepare(&Request::default().with("height", 1.90).unwrap()).unwrap();
    assert_eq!(prepared.sex, Sex::Male);
    assert!(prepared.warnings[0].starts_with("sex not given: male is likelier ("), "{:?}", prepared.warnings);
    let female = Request { sex: Some(Sex::Female), ..Request::default() }.with("height", 1.90).unwrap();
    assert_eq!(prepare(&female).unwrap().sex, Sex::Female);
}

#[test]
fn given_measures_stay_and_intervals_hold_the_rest() {
    let request = Request::default().with("height", 1.60).unwrap().with("arm_length_left", 0.31).unwrap();
    let prepared = prepare(&request).unwrap();
    for id in MeasureId::all() {
        let i = id.index();
        assert!(prepared.low90[i] <= prepared.filled[i] && prepared.filled[i] <= prepared.high90[i]);
        assert_eq!(prepared.low90[i] == prepared.high90[i], request.measures[i].is_some());
        if let Some(asked) = request.measures[i] {
            assert_eq!((prepared.filled[i], prepared.given[i]), (asked, Some(asked)));
        }
        // A plausible vector is hardly moved by the projection.
        assert!((prepared.projected[i] - prepared.filled[i]).abs() < 0.003);
    }
}

#[test]
fn the_seed_chooses_the_sample() {
    let sample = |seed| {
        let request = Request { seed, fill: Fill::Sample, ..Request::default() };
        prepare(&request.with("height", 1.70).unwrap()).unwrap().filled
    };
    assert_eq!(sample(1), sample(1));
    assert_ne!(sample(1), sample(2));
    assert_eq!(sample(2)[3], 1.70);
}

#[test]
fn the_infeasible_is_refused_or_replaced() {
    let request = Request { sex: Some(Sex::Female), ..Request::default() }
        .with("waist_circumference", 0.55)
        .unwrap()
        .with("hip_circumference", 1.38)
        .unwrap();
    let error = prepare(&request).unwrap_err();
    let Error::Infeasible(infeasible) = &error else { panic!("{error}") };
    assert!(error.to_string().contains("do not go together"), "{error}");
    let [waist, hip] = infeasible.conflicts[0].measures.as_slice() else { panic!("{infeasible:?}") };
    assert_eq!((waist.name, hip.name), ("waist_circumference", "hip_circumference"));
    assert!(waist.nearest > waist.asked && hip.nearest < hip.asked);
    let prepared = prepare(&Request { nearest: true, ..request.clone() }).unwrap();
    assert_eq!(prepared.conflicts.len(), 1);
    assert!(prepared.warnings.iter().any(|w| w.contains("nearest feasible")));
    // The nearest feasible values are feasible as a request.
    let mut again = request;
    again.measures = prepared.given;
    assert_eq!(prepare(&again).unwrap().filled, prepared.filled);
}

#[test]
fn bad_fields_come_before_everything_else() {
    let error = prepare(&Request::default().with("height", 1700.0).unwrap()).unwrap_err();
    assert!(error.to_string().contains("did you mean 1.70 m (1700 mm)?"));
}
