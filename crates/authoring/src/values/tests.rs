use super::*;
use crate::starter;

const TYPE2: &str = "fuzzy: 1
name: dinner
inputs:
  food:
    range: [0, 10]
    terms:
      bad: {upper: {left_shoulder: [2, 6]}, lower: {left_shoulder: [1, 5], height: 0.5}}
      good: {triangle: [4, 8, 10], blur: 0.1}
      odd:
        gaussian: # bell-shaped
          mean: 5 # in the middle
          sd: 1
        height: 0.9
  time: {range: [0, 24], steps: {early: 8, late: }}
outputs:
  tip: {range: [0, 30], partition: [small, large]}
rules:
  - IF food IS bad THEN tip IS small
";

fn after(
    text: &str,
    edits: impl FnOnce(&Document) -> Result<Vec<Edit>, String>,
) -> Result<String, String> {
    Ok(edited(text, &edits(&Document::new(text, |_| None))?))
}

fn starter() -> String {
    starter::rules("fan")
}

#[test]
fn a_range_is_changed_in_place() {
    let text = after(&starter(), |d| set_range(d, 0, (-5.0, 40.0)));
    assert_eq!(text.unwrap(), starter().replace("[0, 40] #", "[-5, 40] #"));
    let refused = |ends| after(&starter(), |d| set_range(d, 0, ends)).unwrap_err();
    assert!(refused((3.0, 3.0)).contains("smaller one first"));
    assert!(refused((f64::NAN, 3.0)).contains("two numbers"));
    // The peak of `hot` is 30.
    assert!(
        refused((0.0, 25.0)).contains("30"),
        "{}",
        refused((0.0, 25.0))
    );
}

#[test]
fn a_unit_is_added_changed_and_removed() {
    let text = after(&starter(), |d| set_unit(d, 0, " K "));
    assert_eq!(text.unwrap(), starter().replace("unit: °C #", "unit: K #"));
    let text = after(&starter(), |d| set_unit(d, 1, ""));
    let without = starter().replace(
        "    unit: \"%\"\n    range: [0, 100]\n    # Terms",
        "    range: [0, 100]\n    # Terms",
    );
    assert_eq!(text.unwrap(), without);
    let text = after(&without, |d| set_unit(d, 1, "%"));
    assert_eq!(text.unwrap(), starter());
    let text = after(TYPE2, |d| set_unit(d, 2, "no: #"));
    let text = text.unwrap();
    assert!(
        text.contains("tip: {unit: \"no: #\", range: [0, 30], "),
        "{text}"
    );
    assert_eq!(after(TYPE2, |d| set_unit(d, 0, "")).unwrap(), TYPE2);
}

#[test]
fn parameters_are_changed_in_place() {
    let text = after(&starter(), |d| set_parameters(d, (1, 0), "35, 60"));
    assert_eq!(
        text.unwrap(),
        starter().replace("[40, 60]} # 1", "[35, 60]} # 1")
    );
    let text = after(&starter(), |d| set_parameters(d, (0, 1), "22.5"));
    assert_eq!(text.unwrap(), starter().replace("mild: 20", "mild: 22.5"));
    let text = after(&starter(), |d| set_parameters(d, (2, 1), "45"));
    assert_eq!(
        text.unwrap(),
        starter().replace("constant: 50", "constant: 45")
    );
    let text = after(TYPE2, |d| set_parameters(d, (0, 2), "6, 1.5"));
    assert_eq!(
        text.unwrap(),
        TYPE2
            .replace("mean: 5 #", "mean: 6 #")
            .replace("sd: 1\n", "sd: 1.5\n")
    );
    let text = after(TYPE2, |d| set_parameters(d, (2, 0), "10"));
    assert_eq!(
        text.unwrap(),
        TYPE2.replace("[small, large]", "{small: 10, large: 30}")
    );
    let text = after(TYPE2, |d| set_parameters(d, (1, 0), "9"));
    assert_eq!(text.unwrap(), TYPE2.replace("early: 8", "early: 9"));
}

#[test]
fn wrong_parameters_are_refused_with_the_reason() {
    let refused = |place, to| after(&starter(), |d| set_parameters(d, place, to)).unwrap_err();
    assert_eq!(refused((0, 1), "warm"), "`warm` is not a number");
    assert_eq!(
        refused((0, 1), "35"),
        "the peak of `mild` must be between its neighbours and in the range, but is 35"
    );
    assert!(
        refused((1, 0), "35") == "the left_shoulder takes 2 numbers, not 1: top, foot",
        "{}",
        refused((1, 0), "35")
    );
    assert!(
        refused((1, 0), "60, 40").contains("60"),
        "{}",
        refused((1, 0), "60, 40")
    );
    assert!(
        refused((1, 0), "x, 40").contains('x'),
        "{}",
        refused((1, 0), "x, 40")
    );
    assert!(!refused((1, 0), "40, 60], height: 0.5, x: [1").is_empty());
    assert!(!refused((1, 0), "40, 60]}\n      more: {triangle: [1, 2, 3").is_empty());
}

#[test]
fn a_term_gets_another_shape_at_the_same_place() {
    let text = after(&starter(), |d| set_shape(d, (1, 0), "gaussian")).unwrap();
    assert_eq!(
        text,
        starter().replace("left_shoulder: [40, 60]", "gaussian: {mean: 20, sd: 21}")
    );
    for shape in SHAPES {
        let text = after(&starter(), |d| set_shape(d, (1, 1), shape)).unwrap();
        let document = Document::new(text.as_str(), |_| None);
        assert_eq!(fields(&document, 1, 1).unwrap().shape, shape);
        assert!(
            !document.findings().has_errors(),
            "{text}\n{}",
            document.findings()
        );
        // The term can be changed back to a shoulder.
        let back = after(&text, |d| set_shape(d, (1, 1), "right_shoulder")).unwrap();
        assert_eq!(
            fields(&Document::new(back, |_| None), 1, 1).unwrap().shape,
            "right_shoulder"
        );
    }
    let refused = after(&starter(), |d| set_shape(d, (1, 1), "circle")).unwrap_err();
    assert!(refused.starts_with("`circle` is not one of the shapes triangle,"));
    let refused = after(&starter(), |d| set_shape(d, (0, 1), "gaussian")).unwrap_err();
    assert_eq!(refused, "a term of this kind (peak) is edited in the text");
    // The height does not change.
    let text = after(TYPE2, |d| set_shape(d, (0, 2), "triangle")).unwrap();
    assert!(text.contains("\n        height: 0.9\n"), "{text}");
}

#[test]
fn terms_of_type_2_are_listed_but_not_editable() {
    let document = Document::new(TYPE2, |_| None);
    let bad = fields(&document, 0, 0).unwrap();
    assert_eq!(
        bad.parameters,
        "upper left_shoulder: [2, 6]; lower left_shoulder: [1, 5], height: 0.5"
    );
    for place in [(0, 0), (0, 1), (1, 1)] {
        assert!(!fields(&document, place.0, place.1).unwrap().is_editable);
        assert!(set_parameters(&document, place, "1, 2").is_err());
        assert!(set_shape(&document, place, "triangle").is_err());
    }
    let odd = fields(&document, 0, 2).unwrap();
    assert_eq!(
        (odd.parameters.as_str(), odd.names),
        ("5, 1", vec!["mean", "sd"])
    );
    assert_eq!(fields(&document, 0, 3), None);
}
