use super::*;

fn area(outline: &Outline) -> f64 {
    const ROWS: u32 = 4000;
    let (low, high) = (outline.min().y, outline.max().y);
    let row = |i: u32| low + (high - low) * ((i as f32 + 0.5) / ROWS as f32);
    let lengths = (0..ROWS).flat_map(|i| outline.spans(row(i))).map(|(from, to)| f64::from(to - from));
    lengths.sum::<f64>() * f64::from(high - low) / f64::from(ROWS)
}

/// Sound outlines of such areas.
fn check(cases: &[(&str, f64)], tolerance: f64) {
    for &(data, expected) in cases {
        let outline = Outline::from_svg_path(data).unwrap_or_else(|error| panic!("{data:?}: {error}"));
        assert_eq!(outline.check(), Ok(()), "{data:?}");
        assert!(
            (area(&outline) / expected - 1.0).abs() < tolerance,
            "{data:?}: {} {expected}",
            area(&outline)
        );
    }
}

#[test]
fn every_way_to_say_a_square() {
    let square = [
        "m1 1 4 0 0 4-4 0z",
        "M1,1 5,1 5,5 1,5Z",
        "M1 1h2 2v2 2h-4z",
        "M 1\n1 H5V5H1Z",
        "M 1 1 h 4\u{c}v 4 h-4z",
        "\t M1 1 l 4,0 , 0,4 -4,0 z ",
        "M.5.5 4.5.5 4.5 4.5.5 4.5z",
        "M1e0 1E0h4e+0v40e-1h-4z",
        "M1 1h4v4h-4",
        "m1 1h4v4h-4z m0 0",
        "M1 1H5V5H1V1M9 9",
        "M1 1 h4 v4 h-4 z z",
        "M01 01h04v04h-04z",
        "M1 1h+4v+4h-4z",
        "M1.0.0h4v4h-4z",
        "M0 0 4 0 4 4 +0 4z",
        // Back at the start, but for rounding.
        "M0 0h4v4h-4v-4z",
        "M0 0h4v4h-4v-3.99999988z",
        "M0 0h4v4h-4v-4.0000005z",
        // After z a line goes on from the start.
        "M0 0h4v4h-4zl0 0",
    ];
    check(&square.map(|data| (data, 16.0)), 1e-3);
    check(&[("m 1000.1 1000.1 .3 0 0 .3 -.3 0 0 -.3 z", 0.09), ("M0 0h4v4", 8.0)], 2e-3);
}

#[test]
fn arcs_are_read_as_they_are_written() {
    let circle = std::f64::consts::PI;
    let circles = [
        ("M0 0a2 2 0 104 0 2 2 0 10-4 0z", 4.0 * circle),
        ("M0 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0z", 4.0 * circle),
        ("M0,0A2,2,0,1,0,4,0,2,2,0,1,0,0,0", 4.0 * circle),
        ("M0 0a-2-2 0 104 0a-2-2 0 10-4 0z", 4.0 * circle),
        ("M0 0a.1.1 0 104 0a.1.1 0 10-4 0z", 4.0 * circle),
        ("M0 0a2 2 45 104 0a2 2 45 10-4 0z", 4.0 * circle),
        ("M0 0a3 1 0 106 0 3 1 0 10-6 0", 3.0 * circle),
        ("M0 0a3 1 30 105.19615242 3 3 1 30 10-5.19615242 -3", 3.0 * circle),
        ("M0 0a200 200 0 1040000 0z", 0.5 * circle * 20_000.0 * 20_000.0),
        ("M0 0a.05.05 0 10.1 0 .05.05 0 10-.1 0z", circle * 0.0025),
        ("M0 0a1 1 0 011 1h-1z", 0.25 * circle),
        ("M1 0a1 1 0 10 1 1h-1z", 0.75 * circle),
    ];
    check(&circles, 0.005);
    check(&[("M0 0a0 2 0 014 0v4h-4z", 16.0), ("M0 0a2 2 0 0 0 0 0h4v4h-4z", 16.0)], 1e-3);
}

/// The control point of S is the current point after anything but C and S, that of T after anything but Q and T.
#[test]
fn smooth_curves_mirror_their_own_kind_alone() {
    let same = [
        ("M0 0Q2 2 4 0S8 -2 8 0L8 5L0 5z", "M0 0Q2 2 4 0C4 0 8 -2 8 0L8 5L0 5z"),
        ("M0 0C1 2 3 2 4 0T8 0L8 5L0 5z", "M0 0C1 2 3 2 4 0Q4 0 8 0L8 5L0 5z"),
        ("M0 0C1 2 3 2 4 0S7 -2 8 0L8 5L0 5z", "M0 0C1 2 3 2 4 0C5 -2 7 -2 8 0L8 5L0 5z"),
        ("M0 0q2 2 4 0t4 0L8 5L0 5z", "M0 0Q2 2 4 0Q6 -2 8 0L8 5L0 5z"),
        ("M0 0c1 2 3 2 4 0l0 0s3 -2 4 0L8 5L0 5z", "M0 0C1 2 3 2 4 0C4 0 7 -2 8 0L8 5L0 5z"),
    ];
    for (short, long) in same {
        let [short, long] = [short, long].map(|data| Outline::from_svg_path(data).expect("a path"));
        assert_eq!(short, long);
    }
}

#[test]
fn holes_follow_the_rule() {
    let cases = [
        ("M0 0h4v4h-4zM1 1v2h2v-2z", 12.0),
        ("M0 0h4v4h-4zM1 1h2v2h-2z", 16.0),
        ("M0 0h4v4h-4zM2 2h4v4h-4z", 28.0),
        ("M0 0h4v4h-4zM1 1v2h2v-2zM1.5 1.5h1v1h-1z", 13.0),
        ("M0 0h4v4h-4zM4 0h4v4h-4z", 32.0),
        // Two squares that begin in one point are two.
        ("M0 0h2v2h-2zM0 0h-2v-2h2z", 8.0),
        ("M0 0h2v2h-2z h-2v-2h2z", 8.0),
    ];
    check(&cases, 1e-3);
}

#[test]
fn what_crosses_itself_is_mended() {
    let star = "M0,-5 2.9389,4.0451 -4.7553,-1.5451 4.7553,-1.5451 -2.9389,4.0451z";
    check(&[(star, 28.065), ("M0 0L4 4L4 0L0 4z", 8.0)], 1e-3);
    // A corner on a side, and a side that comes back.
    check(&[("M0 0h4v4l-2-4-2 4z", 8.0), ("M0 0h4h-2v3h-2z", 6.0), ("M0 0h4v4h-4zh2v2h-2z", 16.0)], 1e-3);
    let even = star.replace('M', r#"<svg xmlns="http://www.w3.org/2000/svg"><path fill-rule="evenodd" d="M"#)
        + r#""/></svg>"#;
    let shapes = Outline::from_svg(&even).expect("a star");
    assert!(shapes[0].check().is_ok() && !shapes[0].contains(Vec2::ZERO));
    // Its middle, a pentagon, is empty.
    assert!((area(&shapes[0]) - 19.39).abs() < 0.05, "{}", area(&shapes[0]));
}

#[test]
fn what_is_no_path_is_refused() {
    let bad = [
        "",
        "   ",
        "M",
        "M0",
        "M0 0",
        "L0 0 4 0 4 4z",
        "z",
        "M0 0L4",
        "M0 0h4v4h-",
        "M0 0hNaN",
        "M0 0hinfv4h-4z",
        "M0 0h1e400v4h-4z",
        "M0 0b4v4z",
        "M0 0h4pxv4h-4z",
        "M0 0h4e",
        "M0 0h4e+",
        "M0 0h.v4z",
        "M0 0h--4v4z",
        "M0 0h0x10v4z",
        "<path d=\"M0 0h4v4z\"/>",
        "M0 0 h 4 v 4 h -4 z // done",
        "\u{feff}M0 0h4v4h-4z",
        "M0 0 L4 0 L4 4 L\u{2212}4 4z",
        "M0 0 4 0 4 4; 0 4z",
        "M0 0 4 0 4 4,,0 4z",
        "M0 0 4 0 4 4 #0 4z",
        "M0 0h4v4h-4z%garbage",
        "M0 0a2 2 0 2 0 4 0z",
        "M 1 x",
        "nonsense",
        "M0 0h1e308v1e308h1e308z",
    ];
    for data in bad {
        let error = Outline::from_svg_path(data).expect_err(data);
        assert_eq!(error.parameter, "Outline.path", "{data:?}");
    }
    // Not to be seen before it is put to use.
    for data in ["M0 0h4h-4z", "M0 0h0v0z", "M0 0h1e39v1e39h-1e39z", "M0 0h1e308v1e307h-1e308z"] {
        assert!(Outline::from_svg_path(data).map_or(true, |outline| outline.check().is_err()), "{data:?}");
    }
}

fn document(content: &str) -> Result<Vec<Outline>, ParameterError> {
    Outline::from_svg(&format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 100 100">{content}</svg>"#
    ))
}

#[test]
fn documents_are_read_as_they_are_drawn() {
    let heart = "M5 9 C-3 3 2 -1 5 2 C8 -1 13 3 5 9Z";
    let hidden = ["defs", "clipPath", "mask", "marker", "symbol", "pattern"];
    for name in hidden {
        let content = format!(r#"<{name} id="c"><path d="M0 0h1v90h-1z"/></{name}><path d="{heart}"/>"#);
        let shapes = document(&content).expect("a heart");
        assert_eq!((shapes.len(), shapes[0].check()), (1, Ok(())), "{name}");
        assert!(shapes[0].max().x > 9.0, "{name}");
    }
    let areas = [
        (r#"<rect x="1" y="1" width="4" height="3"/>"#, 12.0),
        (r#"<circle cx="20" cy="20" r="2"/>"#, 12.5664),
        (r#"<ellipse cx="20" cy="20" rx="2" ry="5"/>"#, 31.416),
        (r#"<polygon points="0,0 4,0 4,4 0,4"/>"#, 16.0),
        (r#"<polyline points="0,0 4,0 4,4 0,4"/>"#, 16.0),
        (
            r#"<g transform="scale(2)"><path transform="rotate(30) translate(3 4)" d="M0 0h4v4h-4z"/></g>"#,
            64.0,
        ),
        (r#"<path d="M0 0h4v4h-4zM1 1h2v2h-2z" style="fill-rule:evenodd"/>"#, 12.0),
        (r#"<path d="M0 0h4v4h-4zM1 1h2v2h-2z"/>"#, 16.0),
        (r#"<g fill-rule="evenodd"><path d="M0 0h4v4h-4zM1 1h2v2h-2z"/></g>"#, 12.0),
        (r#"<path fill="none" stroke="black" d="M0 0h4v4h-4z"/>"#, 16.0),
        (r##"<defs><rect id="r" width="2" height="3"/></defs><use xlink:href="#r" x="4"/>"##, 6.0),
        (
            r#"<path display="none" d="M0 0h9v9h-9z"/><path visibility="hidden" d="M0 0h9v9h-9z"/><rect width="1" height="2"/>"#,
            2.0,
        ),
    ];
    for (content, expected) in areas {
        let shapes = document(content).unwrap_or_else(|error| panic!("{content}: {error}"));
        assert_eq!((shapes.len(), shapes[0].check()), (1, Ok(())), "{content}");
        assert!((area(&shapes[0]) / expected - 1.0).abs() < 0.01, "{content}: {}", area(&shapes[0]));
    }
    let millimetres = r#"<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="30mm"><rect width="10mm" height="1in"/></svg>"#;
    let shape = &Outline::from_svg(millimetres).expect("a drawing")[0];
    assert!((shape.max() - shape.min() - Vec2::new(37.795, 96.0)).abs().max_element() < 0.01);
}

#[test]
fn what_is_no_drawing_is_refused() {
    let refused = |text: &str, has: &str| {
        let error = Outline::from_svg(text).expect_err(text).to_string();
        assert!(error.starts_with("Outline.svg is ") && error.contains(has), "{error}");
    };
    refused("", "no XML");
    refused("<svg", "no XML");
    refused("<html/>", "");
    assert!(document("<text>A</text>").is_err() && document("").is_err());
    assert!(document(r#"<clipPath id="c"><path d="M0 0h1v9h-1z"/></clipPath>"#).is_err());
    let cut =
        document("<g>\n<path d=\"M0 0h4v4h-4z;M0 0h9\"/></g>").expect_err("a path cut short").to_string();
    assert!(cut.contains("a path at line 2"), "{cut}");
    // An entity that grows without end.
    let mut bomb = String::from("<!DOCTYPE svg [<!ENTITY a \"aaaaaaaaaa\">");
    for (this, last) in ('b'..='z').zip('a'..) {
        let entity = format!("<!ENTITY {this} \"{}\">", format!("&{last};").repeat(10));
        bomb += &entity;
    }
    refused(&(bomb + "]><svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"&z;\"/></svg>"), "");
}
