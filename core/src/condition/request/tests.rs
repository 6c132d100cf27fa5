use proptest::prelude::*;

use super::super::test_prior::ranges;
use super::*;
use crate::testing::fuzz::{Input, fuzz};

fn message(request: &Request) -> String {
    request.check(&ranges(), 10).unwrap_err().to_string()
}

fn with(name: &str, value: f64) -> Request {
    Request::default().with(name, value).unwrap()
}

#[test]
fn reads_the_documented_json() {
    let request = Request::from_json(
        r#"{"sex": "female", "measures": {"arm_length_right": 0.34, "height": 1.70, "arm_length": 0.33, "head_height": null},
            "seed": 7, "z": [0, 1.5], "fill": "sample", "nearest": true}"#,
    )
    .unwrap();
    let given: Vec<_> = request.given().map(|(id, v)| (id.name(), v)).collect();
    assert_eq!(given, [("height", 1.70), ("arm_length_left", 0.33), ("arm_length_right", 0.34)]);
    assert_eq!((request.sex, request.seed, request.fill), (Some(Sex::Female), 7, Fill::Sample));
    assert_eq!((request.z.as_deref(), request.nearest), (Some([0.0, 1.5].as_slice()), true));
    assert_eq!(Request::from_json("{}").unwrap(), Request::default());
}

#[test]
fn wrong_json_names_the_field() {
    for (text, words) in [
        (r#"{"measures": {"hieght": 1.7}}"#, "hieght: is not a measure: did you mean height?"),
        (r#"{"measures": {"waist": 0.7}}"#, "did you mean waist_circumference?"),
        (r#"{"measures": {"left arm length": 0.3}}"#, "did you mean arm_length_left?"),
        (r#"{"measures": {"weight": 70}}"#, "cannot be set"),
        (r#"{"measures": {"Stature": 1.7}}"#, "did you mean height?"),
        (r#"{"measures": {"height": "1.70 m"}}"#, "height: expected a number of metres, got \"1.70 m\""),
        (r#"{"measures": {"height": 1.7, "height": 1.8}}"#, "`height` is given twice"),
        (r#"{"measures": {"height": 1e999}}"#, "out of range"),
        (r#"{"mesures": {}}"#, "unknown field `mesures`"),
        (r#"{"measures": [1]}"#, "an object of measures"),
        (r#"{"sex": "femal"}"#, "sex: expected `female` or `male`, got `femal`"),
        (r#"{"seed": -1}"#, "-1"),
        (r#"{"fill": "median"}"#, "median"),
        ("", "expected a JSON object"),
        ("{", "EOF"),
        ("[]", "expected a JSON object"),
    ] {
        let message = Request::from_json(text).unwrap_err().to_string();
        assert!(message.contains(words), "{text}: {message}");
    }
}

#[test]
fn units_are_guessed() {
    let hint = |name: &str, value: f64, words: &str| {
        let message = message(&with(name, value));
        assert!(message.starts_with(name) && message.contains(words), "{message}");
    };
    hint("height", 1700.0, "1700 m is outside 1.20–2.31 m: did you mean 1.70 m (1700 mm)?");
    hint("height", 170.0, "did you mean 1.70 m (170 cm)?");
    hint("height", 66.5, "did you mean 1.6891 m (66.5 in)?");
    hint("height", 5.5, "did you mean 1.6764 m (5.5 ft)?");
    hint("arm_length", 33.0, "did you mean 0.33 m (33 cm)?");
    hint("height", 9.0, "9.00 m is outside 1.20–2.31 m");
    hint("height", -1.7, "a measure is positive");
    hint("height", 0.0, "a measure is positive");
    hint("height", f64::NAN, "expected 1.20–2.31 m, got NaN");
    hint("arm_length", f64::INFINITY, "got inf");
    hint("arm_length_left", 1e300, "1e300 m is outside");
    assert!(!message(&with("height", 9.0)).contains("did you mean"));
}

#[test]
fn contradictions_are_named() {
    let wide = [MeasureRange { min: 0.01, max: 3.0 }; MEASURE_COUNT];
    for (a, b, words) in [
        (
            ("height", 1.30),
            ("waist_circumference", 1.40),
            "waist_circumference: 1.40 m contradicts height 1.30 m",
        ),
        (
            ("heel_to_ball_length", 0.25),
            ("heel_to_toe_length", 0.24),
            "heel_to_ball_length_left: 0.25 m contradicts",
        ),
        (("foot_width_right", 0.12), ("heel_to_toe_length_right", 0.12), "foot_width_right"),
        (("thigh_circumference", 0.70), ("hip_circumference", 0.60), "thigh_circumference_left"),
        (("neck_circumference", 0.55), ("chest_circumference", 0.45), "neck_circumference"),
    ] {
        let request = with(a.0, a.1).with(b.0, b.1).unwrap();
        let message = request.check(&wide, 10).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
    let legs =
        with("height", 1.30).with("thigh_length_left", 0.69).unwrap().with("calf_length", 0.59).unwrap();
    let legs = legs.with("head_height", 0.27).unwrap();
    let message = legs.check(&wide, 10).unwrap_err().to_string();
    assert!(
        message.contains("thigh_length_left, calf_length_left and head_height are 1.55 m together"),
        "{message}"
    );
}

#[test]
fn latent_vectors_are_checked_and_seeded() {
    let z = |z: Vec<f64>| Request { z: Some(z), ..Request::default() };
    assert!(message(&z(vec![0.0; 9])).contains("z: expected 10 numbers, got 9"));
    assert!(message(&z([vec![0.0; 9], vec![f64::NAN]].concat())).contains("got NaN at place 9"));
    for bad in [1e300, 40.0, -6.1, f64::INFINITY] {
        let expected = format!("z: expected numbers from -6 to 6, got {bad} at place 2");
        assert_eq!(message(&z(vec![0.0, -6.0, bad, 6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])), expected);
    }
    assert_eq!(z(vec![1.0; 10]).latent(10), vec![1.0; 10]);
    assert_eq!(Request::default().latent(3), vec![0.0; 3]);
    let seeded = |seed| Request { seed, ..Request::default() }.latent(10);
    assert_eq!(seeded(5), seeded(5));
    assert_ne!(seeded(5), seeded(6));
}

#[test]
fn a_plausible_request_passes() {
    let request =
        with("height", 1.70).with("arm_length", 0.33).unwrap().with("waist_circumference", 0.7).unwrap();
    request.check(&ranges(), 10).unwrap();
    Request::default().check(&ranges(), 10).unwrap();
}

#[test]
fn mutated_requests_are_read_or_refused() {
    let json = r#"{"sex": "female", "measures": {"height": 1.7, "arm_length": 0.7, "arm_length_left": 0.71,
        "waist_circumference": null}, "seed": 7, "z": [0.5, -1e-3], "fill": "sample", "nearest": true}"#;
    fuzz(vec![Input::plain("request.json", json)], |bytes, _| {
        let Ok(text) = std::str::from_utf8(bytes) else { return false };
        let request = Request::from_json(text);
        request.is_ok_and(|request| Request::from_json(&request.to_json()).unwrap() == request)
    });
}

proptest! {
    #[test]
    fn json_round_trips(
        values in prop::collection::vec(prop::option::of(0.01..3.0f64), MEASURE_COUNT),
        same in any::<bool>(),
        seed in any::<u64>(),
        z in prop::option::of(prop::collection::vec(-3.0..3.0f64, 0..12)),
        sex in prop::option::of(prop::sample::select(Sex::ALL.to_vec())),
    ) {
        let mut request = Request { sex, seed, z, ..Request::default() };
        for id in MeasureId::all() {
            let source = if same && id.mirrored() < id { id.mirrored() } else { id };
            request.measures[id.index()] = values[source.index()];
        }
        prop_assert_eq!(Request::from_json(&request.to_json()).unwrap(), request);
    }

    #[test]
    fn nothing_panics(name in ".{0,80}", value in any::<f64>(), text in ".{0,80}") {
        let mut request = Request::default();
        if let Err(e) = request.set(&name, value) {
            prop_assert!(!e.to_string().is_empty());
        }
        for id in MeasureId::all() {
            let mut request = Request::default();
            request.measures[id.index()] = Some(value);
            let _ = request.check(&ranges(), 10);
            let _ = request.to_json();
        }
        let _ = Request::from_json(&text);
    }
}
