//! Every chart is well-formed, shows what it was given, and never fails on its numbers.

use translucid_laboratory::{Axis, Chart, Ink, Mark, Series};
use translucid_profile::Model;

/// A chart with every kind of mark.
fn chart() -> Chart {
    let line: Vec<[f64; 2]> = (1..=50).map(f64::from).map(|x| [x, (-x / 9.0).exp()]).collect();
    let points: Vec<[f64; 2]> = line.iter().step_by(7).copied().collect();
    let errors = vec![0.05; points.len()];
    let words = (0..points.len()).map(|i| format!("point {i} <&>")).collect();
    Chart::new(
        "all",
        "All <marks> & \"words\"",
        Axis::linear("r <x>", "ℓ"),
        Axis::logarithmic("R & more", "ℓ⁻²"),
    )
    .with_caption("What is <seen> & why.")
    .with(Series::new("band <1>", Ink::Guide, Mark::Band(vec![0.5; 50]), line.clone()))
    .with(Series::new("line & more", Ink::Model(Model::NormalizedDiffusion), Mark::Line, line.clone()))
    .with(Series::new("dashes \"x\"", Ink::Model(Model::Dipole), Mark::Line, line))
    .with(Series::new("costs $5 or $6", Ink::Fit, Mark::Steps, points.clone()))
    .with(Series::new("errors", Ink::Reference, Mark::PointsWithErrors(errors), points.clone()))
    .with(Series::new("words", Ink::Talk, Mark::LabelledPoints(words), points))
}

/// The texts of an SVG, which has to be well-formed.
fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).expect("an SVG is XML");
    assert_eq!(document.root_element().tag_name().name(), "svg");
    let texts =
        document.descendants().filter(|node| matches!(node.tag_name().name(), "text" | "title" | "desc"));
    let words = |node: roxmltree::Node<'_, '_>| {
        node.descendants().filter_map(|inner| inner.text()).next().map(str::to_owned)
    };
    texts.filter_map(words).collect()
}

#[test]
fn svg_has_every_word() {
    let chart = chart();
    let texts = texts(&chart.svg());
    let mut words = vec![chart.title.clone(), chart.caption.clone(), chart.x.caption(), chart.y.caption()];
    words.extend(chart.series.iter().map(|series| series.label.clone()));
    words.extend((0..8).map(|i| format!("point {i} <&>")));
    for word in words {
        assert!(texts.contains(&word), "\"{word}\" is not in {texts:?}");
    }
    assert!(texts.iter().any(|text| text.starts_with("10⁻")), "no power of ten in {texts:?}");
}

#[test]
fn svg_is_the_same_every_time() {
    let chart = chart();
    assert_eq!(chart.svg(), chart.svg());
}

#[test]
fn gaps_of_data_are_gaps_of_lines() {
    let with_gap = vec![
        [0.0, 1.0],
        [1.0, 2.0],
        [2.0, f64::NAN],
        [3.0, 1.0],
        [4.0, 2.0],
        [5.0, f64::INFINITY],
        [6.0, 1.0],
    ];
    let count =
        |points: Vec<[f64; 2]>| {
            let chart = Chart::new("gap", "", Axis::linear("x", ""), Axis::linear("y", ""))
                .with(Series::new("", Ink::Reference, Mark::Line, points));
            // The reference's color, which only its lines have
            chart.svg().matches("stroke=\"#000000\"").count()
        };
    assert_eq!(count(with_gap), 2);
    assert_eq!(count(vec![[0.0, 1.0], [1.0, 2.0]]), 1);
    assert_eq!(count(vec![[0.0, 1.0]]), 0);
}

#[test]
fn no_numbers_make_a_chart_fail() {
    let extremes = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1.0 + 1e-15,
        1e-300,
        1e300,
        -1e300,
        5e-324,
        f64::MAX,
        f64::MIN,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];
    let pairs = || extremes.iter().flat_map(|&a| extremes.iter().map(move |&b| [a, b]));
    let mut lists: Vec<Vec<[f64; 2]>> = vec![Vec::new(), pairs().collect()];
    lists.extend(pairs().map(|pair| vec![pair]));
    lists.extend(pairs().map(|[a, b]| vec![[a, b], [b, a]]));
    let axes =
        [Axis::linear("x", "°"), Axis::logarithmic("x", ""), Axis::linear("", "").between(0.0, 1e-300)];
    let words = |count: usize| vec![String::from("w"); count];
    for points in &lists {
        let count = points.len();
        let ys: Vec<f64> = points.iter().map(|point| point[0]).collect();
        for (i, x) in axes.iter().enumerate() {
            let y = &axes[(i + count) % axes.len()];
            let mut chart = Chart::new("x", "", x.clone(), y.clone());
            let too_short = vec![1.0; count / 2];
            let marks = [
                Mark::Line,
                Mark::Points,
                Mark::PointsWithErrors(ys.clone()),
                Mark::LabelledPoints(words(count)),
                Mark::Steps,
                Mark::Band(ys.clone()),
                Mark::PointsWithErrors(too_short.clone()),
                Mark::LabelledPoints(words(count / 2)),
                Mark::Band(too_short),
            ];
            for (n, mark) in marks.into_iter().enumerate() {
                chart.series.push(Series::new("l", Ink::Numbered(n), mark, points.clone()));
            }
            let svg = chart.svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{points:?} on {x:?} and {y:?}");
            let _ = texts(&svg);
        }
    }
}

#[test]
fn strange_words_stay_words() {
    let strange = "a\u{0}b\u{7}\u{fffe}]]>\u{202e}$\\frac{1}{0}$ \\$ <script>alert(1)</script> &amp; 字";
    let chart = Chart::new("../x", strange, Axis::linear(strange, strange), Axis::linear(strange, ""))
        .with_caption(strange)
        .with(Series::new(
            strange,
            Ink::Reference,
            Mark::LabelledPoints(vec![strange.into()]),
            vec![[1.0, 1.0]],
        ));
    let svg = chart.svg();
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert!(document.descendants().all(|node| node.tag_name().name() != "script"));
}
