use super::super::feasibility::Limits;
use super::super::solve::{MeasuredShape, SolveOptions, solve};
use super::super::test_prior::{priors, ranges};
use super::*;
use crate::measure::{MEASURE_COUNT, Measurements};

/// A body whose coefficients are its measures.
struct Identity;

impl MeasuredShape for Identity {
    fn dim(&self) -> usize {
        MEASURE_COUNT
    }

    fn measure(&self, c: &[f64], jacobian: Option<&mut [f64]>) -> Measurements {
        if let Some(jacobian) = jacobian {
            for (i, value) in jacobian.iter_mut().enumerate() {
                *value = f64::from(u8::from(i % (MEASURE_COUNT + 1) == 0));
            }
        }
        std::array::from_fn(|i| c[i])
    }
}

fn report(request: &Request) -> Report {
    let prepared = Prepared::new(request, &priors(), &ranges(), &Limits::default(), 2).unwrap();
    let variances = [1.0; MEASURE_COUNT];
    let options = SolveOptions::default();
    let outcome = solve(&Identity, &prepared.projected, &variances, &prepared.given, &options).unwrap();
    Report::new(request, &prepared, &priors(), &outcome, 65.0, 0.066)
}

fn request() -> Request {
    let request = Request { sex: Some(Sex::Female), seed: 7, ..Request::default() };
    request.with("height", 1.72).unwrap().with("arm_length", 0.33).unwrap()
}

#[test]
fn json_has_the_documented_fields() {
    let report = report(&request());
    let json: serde_json::Value = serde_json::from_str(&report.to_json()).unwrap();
    let measures = json["measures"].as_array().unwrap();
    assert_eq!(measures.len(), MEASURE_COUNT);
    let height = &measures[3];
    assert_eq!(
        (&height["name"], &height["asked"], &height["given"]),
        (&"height".into(), &1.72.into(), &true.into())
    );
    assert!(height["residual"].as_f64().unwrap().abs() <= 1e-7);
    assert_eq!(
        (&height["low90"], &height["high90"], &height["filled"]),
        (&1.72.into(), &1.72.into(), &"given".into())
    );
    let waist = &measures[0];
    assert!(waist["asked"].is_null() && waist["residual"].is_null() && waist["given"] == false);
    assert_eq!(waist["filled"], "prior mean");
    let number = |key: &str| waist[key].as_f64().unwrap();
    assert!(number("low90") < number("obtained") && number("obtained") < number("high90"));
    assert!((0.0..=100.0).contains(&number("percentile")));
    assert_eq!((&json["seed"], &json["sex"]), (&7.into(), &"female".into()));
    assert_eq!(json["z"].as_array().unwrap().len(), 2);
    assert_eq!(json["mass_kg"], 65.0);
    assert!((json["bmi"].as_f64().unwrap() - 65.0 / (1.72 * 1.72)).abs() < 1e-6);
    assert!(
        json["warnings"].as_array().unwrap().is_empty() && json["conflicts"].as_array().unwrap().is_empty()
    );
}

#[test]
fn the_table_shows_what_was_asked_and_the_main_measures() {
    let text = report(&request()).to_string();
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines[0], "female, 65.0 kg, BMI 22.0, seed 7");
    let starts: Vec<_> = lines[2..].iter().map(|l| l.split(' ').next().unwrap()).collect();
    assert_eq!(
        starts,
        ["waist_circumference", "chest_circumference", "hip_circumference", "height", "arm_length"]
    );
    assert!(lines[5].contains("1.720 m   1.720 m   0.00 mm"), "{text}");
    assert!(lines[2].contains(" to ") && !lines[5].contains(" to "), "{text}");
}

#[test]
fn a_replaced_request_says_so() {
    let request = Request { sex: Some(Sex::Female), nearest: true, ..Request::default() };
    let request = request.with("waist_circumference", 0.55).unwrap().with("hip_circumference", 1.38).unwrap();
    let report = report(&request);
    assert_eq!(report.conflicts.len(), 1);
    let waist = &report.measures[0];
    assert_eq!(waist.asked, Some(0.55));
    assert!(waist.residual.unwrap() > 0.01);
    assert!(report.solve_residual <= 1e-7 && report.converged);
    let text = report.to_string();
    assert!(
        text.contains("warning: the request is infeasible") && text.contains("conflict: waist"),
        "{text}"
    );
}

#[test]
fn a_refused_request_is_reported_with_its_conflicts() {
    let request = Request { sex: Some(Sex::Female), seed: 3, ..Request::default() };
    let request = request.with("waist_circumference", 0.55).unwrap().with("hip_circumference", 1.38).unwrap();
    let error = Prepared::new(&request, &priors(), &ranges(), &Limits::default(), 2).unwrap_err();
    let crate::Error::Infeasible(why) = &error else { panic!("{error}") };
    let json: serde_json::Value = serde_json::from_str(&refusal_json(&request, why)).unwrap();
    let measures = json["measures"].as_array().unwrap();
    assert_eq!(measures.len(), MEASURE_COUNT);
    assert_eq!((&measures[0]["asked"], &measures[0]["given"]), (&0.55.into(), &true.into()));
    assert!(measures[0]["obtained"].is_null() && measures[1]["asked"].is_null());
    let conflict = &json["conflicts"][0]["measures"];
    assert_eq!(conflict[0]["name"], "waist_circumference");
    assert!(conflict[0]["nearest"].as_f64().unwrap() > 0.55);
    assert_eq!((&json["seed"], &json["sex"]), (&3.into(), &"female".into()));
    assert_eq!(json["error"], error.to_string());
    // A body's report has every one of its fields.
    let whole = serde_json::to_value(report(&self::request())).unwrap();
    for (key, _) in measures[0].as_object().unwrap() {
        assert!(!whole["measures"][0][key].is_null() || key == "asked" || key == "residual", "{key}");
    }
}
