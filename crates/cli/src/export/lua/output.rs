//! The closed forms of outputs: their coefficients, and the code that computes the values.

use flagred::board::table::{ClosedForm, Moment, Output, Table};

use super::{UnsupportedFeature, number};

/// The coefficients of the terms of all outputs, at the indices of their firing strengths.
#[derive(Default)]
pub(super) struct Coefficients {
    areas: Vec<String>,
    moments: Vec<String>,
    parts: Vec<String>,
}

impl Coefficients {
    /// Adds an output of a table, whose firing strengths begin at the index `first`. Returns the number of its firing
    /// strengths.
    pub(super) fn add(
        &mut self,
        table: &Table<'_>,
        (name, output): (&str, &Output),
        first: usize,
    ) -> Result<usize, UnsupportedFeature> {
        let range = output.first as usize..output.end as usize;
        let strengths = (output.end_strength - output.first_strength) as usize;
        match output.form() {
            ClosedForm::Moments => {
                let moments = table.moments.get(range).unwrap_or_default();
                // Tiny numbers, which are rounding errors, become 0.
                let moment = |m: &Moment| {
                    if m.moment.abs() < 1e-9 { 0.0 } else { m.moment }
                };
                self.areas.resize(first, "0.0".into());
                self.areas.extend(moments.iter().map(|m| number(m.area)));
                self.moments.resize(first, "0.0".into());
                let moments = moments.iter().map(|m| number(moment(m)));
                self.moments.extend(moments);
                Ok(strengths)
            }
            ClosedForm::Partition => {
                let pairs = table.pairs.get(range).unwrap_or_default();
                // A partition has one more strength, which stays 0: the last term has no neighbour to its right.
                let strengths = strengths.min(2 * pairs.len());
                let sides = pairs.iter().flat_map(|pair| [(pair, 0), (pair, 1)]);
                self.parts.resize(first, "  false,".into());
                for (pair, side) in sides.take(strengths) {
                    let [a, b] = pair.area.map(|of| of[side]);
                    let [c, d, e] = pair.moment.map(|of| of[side]);
                    let all = [a, b, c, d, e, pair.width[side], pair.middle[side]].map(number);
                    self.parts.push(format!("  {{{}}},", all.join(", ")));
                }
                Ok(strengths)
            }
            ClosedForm::WeightedAverage | ClosedForm::WeightedSum => Err(UnsupportedFeature::new(
                format!(
                    "output `{name}` is a Takagi-Sugeno output, which the script does not support"
                ),
                "the script supports the centroid, either with `implication: product` and `aggregation: sum`, or of a `partition` \
                 with `implication: minimum` and `aggregation: maximum`",
            )),
            _ => Err(UnsupportedFeature::new(
                format!(
                    "the script does not support the implication, aggregation or defuzzifier of output `{name}`"
                ),
                "choose the centroid, either with `implication: product` and `aggregation: sum`, or of a `partition` with \
                 `implication: minimum` and `aggregation: maximum`",
            )),
        }
    }

    /// Returns the lines of the script with all coefficients.
    pub(super) fn lines(&self) -> Vec<String> {
        let Coefficients {
            areas,
            moments,
            parts,
        } = self;
        let mut lines = Vec::new();
        if !areas.is_empty() {
            lines.push("-- The areas of the output's terms, and their moments about the middle of its range.".into());
            lines.push(format!("local AREAS = {{{}}}", areas.join(", ")));
            lines.push(format!("local MOMENTS = {{{}}}", moments.join(", ")));
        }
        if !parts.is_empty() {
            lines.push("-- The output's terms: area = a h + b h^2, moment about the middle of the range = c h + d h^2 + e h^3 at".into());
            lines.push(
                "-- firing strength h; width and middle of the overlap with the next term.".into(),
            );
            lines.push("local PARTS = {".into());
            lines.extend_from_slice(parts);
            lines.push("}".into());
        }
        lines
    }
}

/// Returns the code for the value of an output, from `strengths` firing strengths that begin at `first`. The code
/// stores the value in `x[place]`; without `place`, the output is the risk, and the code returns its value.
pub(super) fn defuzzify(
    output: &Output,
    (first, strengths): (usize, usize),
    place: Option<usize>,
) -> Vec<String> {
    let sum = match output.form() {
        ClosedForm::Partition => {
            "    local part, h = PARTS[term], strengths[term]
    local v = min(h, strengths[term + 1] or 0.0, 0.5)
    local common = part[6] * (v * (1 - v))
    area = area + h * (part[1] + h * part[2]) - common
    moment = moment + h * (part[3] + h * (part[4] + h * part[5])) - part[7] * common"
        }
        _ => {
            "    area = area + strengths[term] * AREAS[term]
    moment = moment + strengths[term] * MOMENTS[term]"
        }
    };
    let middle = output.low + 0.5 * (output.high - output.low);
    let value = format!(
        "max({}, min({}, {} + moment / area))",
        number(output.low),
        number(output.high),
        number(middle)
    );
    let fallback = number(output.default_value);
    let end = match place {
        None => format!(
            "  if area > 0 then\n    return {value}\n  end\n  return {fallback} -- no rule fires"
        ),
        Some(place) if output.default_value.is_nan() => format!(
            "  if area <= 0 then\n    coverage = 0.0\n    return nil -- no rule fires\n  end\n  x[{place}] = {value}"
        ),
        Some(place) => format!("  x[{place}] = area > 0 and {value} or {fallback}"),
    };
    let text = format!(
        "  area, moment = 0.0, 0.0\n  for term = {}, {} do\n{sum}\n  end\n{end}",
        first + 1,
        first + strengths
    );
    text.lines().map(str::to_owned).collect()
}
