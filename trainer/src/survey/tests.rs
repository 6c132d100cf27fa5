use std::collections::BTreeMap;

use anthronet::measure::{Sex, expand_name};

use super::*;

/// Rows of NHANES with a gap, an empty sample weight aside.
const NHANES: &str = "\
age,bmxwt,bmxht,bmxhip,wtmecprp
40,80.5,175.0,100.0,2000
20,70.0,165.5,,1000
61,95,185,110.5,4000
";

#[test]
fn rows_are_read_in_metres_and_kilograms() {
    let rows = Rows::parse(NHANES, "n.csv", Sex::Male).unwrap();
    assert_eq!((rows.survey, rows.sex), (Survey::Nhanes, Sex::Male));
    assert_eq!(rows.columns, ["bmxwt", "bmxht", "bmxhip"]);
    assert_eq!(rows.people[1], [Some(70.0), Some(1.655), None]);
    assert_eq!(rows.weights, [2000.0, 1000.0, 4000.0]);
    let ansur2 = "subjectid,stature,interpupillarybreadth,weightkg,subjectsbirthlocation\n\
                  1,1750,635,815,\"Here, there\"\n2,1601,600,610,X\n";
    let rows = Rows::parse(ansur2, "a.csv", Sex::Female).unwrap();
    assert_eq!((rows.survey, rows.columns.len()), (Survey::Ansur2, 3));
    assert!((rows.people[0][1].unwrap() - 0.0635).abs() < 1e-12);
    assert!((rows.people[0][2].unwrap() - 81.5).abs() < 1e-12);
    assert_eq!(rows.weights, [1.0, 1.0]);
}

#[test]
fn what_is_no_survey_is_refused_by_name() {
    let refused = |text: &str| Rows::parse(text, "x.csv", Sex::Male).unwrap_err().to_string();
    assert!(refused("a,b\n1,2\n").contains("x.csv: expected a survey with the column weightkg or bmxwt"));
    let slip = NHANES.replace("165.5", "tall");
    assert!(refused(&slip).contains("x.csv: line 3, bmxht: expected a positive number, got \"tall\""));
    assert!(refused(&NHANES.replace("165.5", "-1")).contains("line 3, bmxht"));
    assert!(refused("bmxwt,bmxht\n70,170\n").contains("at least two people, got 1"));
}

/// People of two columns: y = 0.5 x + 0.3 + noise; of every third the y is not known, above all of those with a large x.
fn people(gaps: bool) -> Rows {
    let mut random = anthronet::random::Random::new(3, 1);
    let mut rows = Rows {
        survey: Survey::Nhanes,
        sex: Sex::Female,
        columns: vec!["bmxwt".into(), "bmxht".into()],
        people: Vec::new(),
        weights: Vec::new(),
    };
    for _ in 0..4_000 {
        let x = 2.0 + 0.2 * random.normal();
        let y = 0.5 * x + 0.3 + 0.05 * random.normal();
        let open = gaps && x > 2.0 && random.uniform() < 0.6;
        rows.people.push(vec![Some(x), (!open).then_some(y)]);
        rows.weights.push(1.0);
    }
    rows
}

#[test]
fn statistics_are_the_textbooks_and_gaps_do_not_bend_them() {
    for gaps in [false, true] {
        let rows = people(gaps);
        let statistics = SexStatistics::new(&rows).unwrap();
        assert_eq!(statistics.people, 4_000);
        let [x, y] = &statistics.columns[..] else { panic!("two columns") };
        // Five standard errors: 0.016 of a mean of x, 0.009 of y and more with gaps.
        assert!(
            (x.mean - 2.0).abs() < 0.016 && (y.mean - 1.3).abs() < 0.015,
            "{gaps}: {} {}",
            x.mean,
            y.mean
        );
        assert!((x.deviation - 0.2).abs() < 0.012 && (y.deviation - 0.1118).abs() < 0.01);
        let regression = statistics.regression(&[0], 1).unwrap();
        assert!((regression.slopes[0] - 0.5).abs() < 0.03, "{gaps}: {regression:?}");
        assert!((regression.predict(&[2.0]) - 1.3).abs() < 0.008);
    }
    // By hand: weights count people.
    let mut rows = Rows::parse(NHANES, "n.csv", Sex::Male).unwrap();
    for person in &mut rows.people {
        person.truncate(1);
    }
    rows.columns.truncate(1);
    let statistics = SexStatistics::new(&rows).unwrap();
    assert!((statistics.columns[0].mean - (2.0 * 80.5 + 70.0 + 4.0 * 95.0) / 7.0).abs() < 1e-4);
    let middle = statistics.columns[0].quantiles[50];
    assert!(80.5 < middle && middle < 95.0, "{middle}");
}

#[test]
fn slips_of_the_pen_do_not_count() {
    let mut rows = people(false);
    rows.people.push(vec![Some(20.0), Some(1.3)]);
    rows.weights.push(1.0);
    let statistics = SexStatistics::new(&rows).unwrap();
    assert_eq!(statistics.people, 4_000);
    assert!(statistics.columns[0].quantiles[100] < 3.0);
}

#[test]
fn the_committed_statistics_are_of_people() {
    let committed = committed().unwrap();
    let names: Vec<&str> = committed.keys().map(String::as_str).collect();
    assert_eq!(names, ["ansur2", "nhanes"]);
    for (survey, columns, people) in [(Survey::Ansur2, 93, 1_500), (Survey::Nhanes, 7, 3_000)] {
        for sex in Sex::ALL {
            let statistics = committed[survey.name()].of(sex);
            assert!(statistics.columns.len() == columns && statistics.people > people, "{survey:?} {sex}");
            for column in &statistics.columns {
                assert_eq!(column.quantiles.len(), QUANTILES);
                assert!(column.quantiles.windows(2).all(|q| q[0] <= q[1]), "{}", column.name);
                assert!(column.correlations.iter().all(|r| r.abs() < 1.0), "{}", column.name);
            }
            for mapping in survey.mappings() {
                statistics.column(mapping.column).unwrap();
                assert!(expand_name(mapping.measure).is_some());
            }
        }
    }
    // The README of the survey prints these.
    let of = |sex, name: &str| {
        let statistics = committed["nhanes"].of(sex);
        let column = &statistics.columns[statistics.column(name).unwrap()];
        (column.mean, column.deviation)
    };
    let stature: BTreeMap<&str, (f64, f64)> =
        Sex::ALL.iter().map(|sex| (sex.name(), of(*sex, "bmxht"))).collect();
    for (sex, mean, deviation) in [("female", 1.614, 0.069), ("male", 1.750, 0.072)] {
        assert!((stature[sex].0 - mean).abs() < 0.001 && (stature[sex].1 - deviation).abs() < 0.001);
    }
}
