use super::*;

#[test]
fn lengths_in_every_unit() {
    for (text, metres) in [
        ("1.7", 1.7),
        ("1.7m", 1.7),
        (" 1.7 m ", 1.7),
        ("170cm", 1.7),
        ("170 CM", 1.7),
        ("1700mm", 1.7),
        ("0.815", 0.815),
        ("67in", 67.0 * 0.0254),
        ("67\"", 67.0 * 0.0254),
        ("5ft7in", 5.0 * 0.3048 + 7.0 * 0.0254),
        ("5ft 7", 5.0 * 0.3048 + 7.0 * 0.0254),
        ("5'7\"", 5.0 * 0.3048 + 7.0 * 0.0254),
        ("5′7.5″", 5.0 * 0.3048 + 7.5 * 0.0254),
        ("5.5ft", 5.5 * 0.3048),
        ("1700", 1700.0),
    ] {
        let got = parse_length(text).unwrap();
        assert!((got - metres).abs() < 1e-12, "{text}: {got}");
    }
    assert_eq!(parse_length("170cm"), parse_length("1.7"));
    assert_eq!(parse_length("1700mm"), parse_length("1.7"));
}

#[test]
fn invalid_lengths_are_refused() {
    for text in [
        "", "m", "NaN", "inf", "-inf", "1e999", "tall", "1.7.0", "5ft13in", "5ftx", "5.5ft3in", "1.7kg",
        "0x10",
    ] {
        let message = parse_length(text).unwrap_err().to_string();
        assert!(message.contains(&format!("got `{text}`")), "{text}: {message}");
    }
    assert!(parse_length("-1.7").unwrap_err().to_string().contains("above zero"));
    assert!(parse_length("0").unwrap_err().to_string().contains("above zero"));
    assert!(parse_length("1,70").unwrap_err().to_string().contains("point"));
}

/// Feet and inches in metres.
fn imperial(feet: f64, inches: f64) -> f64 {
    feet * 0.3048 + inches * 0.0254
}

#[test]
fn feet_and_inches_with_hyphens_words_and_typographic_marks() {
    for text in [
        "5'-7\"",
        "5' -7\"",
        "5' - 7\"",
        "5ft-7in",
        "5ft -7in",
        "5-ft-7-in",
        "5-foot-7",
        "5 ft 7",
        "5 foot 7",
        "5 ft. 7 in.",
        "5 feet 7 inches",
        "5 feet, 7 inches",
        "5 Feet and 7 Inches",
        "5'7''",
        "5’7”",
        "5′ 7″",
        "5′7′′",
        "5´7´´",
        "5'–7\"",
        "5'\u{2011}7\"",
        "5\u{a0}ft\u{202f}7\u{a0}in",
        "5'7",
        "05'07\"",
        "5' 7in",
        "5ft7\"",
    ] {
        let got = parse_length(text).unwrap();
        assert!((got - imperial(5.0, 7.0)).abs() < 1e-12, "{text}: {got}");
    }
}

#[test]
fn fractions() {
    for (text, metres) in [
        ("5' 7 1/2\"", imperial(5.0, 7.5)),
        ("5'-7-1/2\"", imperial(5.0, 7.5)),
        ("5'7½\"", imperial(5.0, 7.5)),
        ("5 ft 7 3⁄4 in", imperial(5.0, 7.75)),
        ("38 1/2 in", imperial(0.0, 38.5)),
        ("38-1/2\"", imperial(0.0, 38.5)),
        ("38½in", imperial(0.0, 38.5)),
        ("5 1/2 ft", imperial(5.5, 0.0)),
        ("3/4 m", 0.75),
    ] {
        let got = parse_length(text).unwrap();
        assert!((got - metres).abs() < 1e-12, "{text}: {got}");
    }
    for text in ["38 1/0 in", "38 3/2 in", "38.5 1/2 in", "1/2/3 in", "38 1/ in", "/2 in", "1/2.5 in"] {
        assert!(parse_length(text).unwrap_err().to_string().contains("got `"), "{text}");
    }
    assert!(parse_length("38 1/2").unwrap_err().to_string().contains("a unit after a fraction"));
}

#[test]
fn metres_and_centimetres() {
    for text in
        ["1m70", "1 m 70", "1m70cm", "1 m, 70 cm", "1m 700mm", "170 centimetres", "1.7 meters", "170cm 0mm"]
    {
        assert_eq!(parse_length(text), Ok(1.7), "{text}");
    }
    assert_eq!(parse_length("1m7cm"), parse_length("1.07"));
    assert_eq!(parse_length("170cm 5mm"), parse_length("170.5cm"));
    for text in ["1m7", "1m705", "1m70.5"] {
        assert!(parse_length(text).unwrap_err().to_string().contains("two digits"), "{text}");
    }
}

#[test]
fn what_may_mean_another_number_is_refused() {
    for text in [
        "5'12\"",
        "1m100cm",
        "1.5m70",
        "3'--2\"",
        "3'+2\"",
        "3\"2'",
        "5\"7",
        "5 ft 7 ft",
        "1 m 3 in",
        "5 7",
        "1 700 mm",
        "1'700 mm",
        "5'7\"8",
        "5'7\" tall",
        "5-7",
        "and 5",
        "5 and 7",
        "5 ft/7 in",
        "170,5 cm",
        "1,700 mm",
        "5,7'",
        "5'7,5\"",
        "1.7.0 m",
        "٥ ft",
        "5'7\"-",
        "--1.7",
        "1.7 m -",
        "five feet",
        "m70",
    ] {
        let message = parse_length(text).unwrap_err().to_string();
        assert!(message.contains(&format!("got `{text}`")), "{text}: {message}");
    }
    for text in ["-1.7", "−1.7 m", "-5'7\"", "- 170cm", "0'0\""] {
        assert!(parse_length(text).unwrap_err().to_string().contains("above zero"), "{text}");
    }
}
