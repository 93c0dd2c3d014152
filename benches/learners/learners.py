"""Cross-validation errors of rule sets and of other learners, on textbook data."""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from mlxtend.data import autompg_data
from sklearn.datasets import load_diabetes
from sklearn.ensemble import HistGradientBoostingRegressor, RandomForestRegressor
from sklearn.linear_model import LinearRegression
from xgboost import XGBRegressor

FLAGRED = sys.argv[1]
SPLITS = 10


def cars():
    """Fuel consumption of 392 cars (Quinlan 1993), without their names."""
    x, y = autompg_data()
    return np.asarray(x[:, :7], float), y, ["cylinders", "displacement", "horsepower", "weight", "acceleration", "year", "origin"]


def patients():
    """The progress of a disease in 442 patients (Efron and others 2004)."""
    data = load_diabetes(scaled=False)
    return data.data, data.target, list(data.feature_names)


def series():
    """Four values of a chaotic series (Mackey and Glass 1977), six steps apart, to predict the value six steps later, as for
    ANFIS (Jang 1993)."""
    step, delay = 0.1, 170
    x = [1.2]
    slope = lambda x, past: 0.2 * past / (1 + past**10) - 0.1 * x
    for i in range(12_000):
        begin, end = (x[at - delay] if at >= delay else 0.0 for at in (i, i + 1))
        middle = (begin + end) / 2
        k1 = slope(x[i], begin)
        k2 = slope(x[i] + step / 2 * k1, middle)
        k3 = slope(x[i] + step / 2 * k2, middle)
        k4 = slope(x[i] + step * k3, end)
        x.append(x[i] + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    x = np.array(x[::10])
    t = np.arange(118, 1118)
    return np.column_stack([x[t - lag] for lag in (18, 12, 6, 0)]), x[t + 6], ["x18", "x12", "x6", "x0"]


def bells(x, names):
    """The initial rule set of ANFIS: two bells for each input, and a rule with a linear consequent for each combination."""
    low, high = x.min() - 0.1, x.max() + 0.1
    bell = lambda center: f"{{bell: {{center: {center}, width: {(high - low) / 2}, slope: 2}}}}"
    inputs = "".join(f"  {name}: {{range: [{low}, {high}], terms: {{low: {bell(low)}, high: {bell(high)}}}}}\n" for name in names)
    line = "{linear: {" + ", ".join(f"{name}: 0" for name in names) + ", constant: 0}}"
    cells = range(2 ** len(names))
    terms = "".join(f"      line_{cell}: {line}\n" for cell in cells)
    word = lambda cell, i: "high" if cell >> i & 1 else "low"
    rules = "".join(
        "  - IF " + " AND ".join(f"{name} IS {word(cell, i)}" for i, name in enumerate(names)) + f" THEN y IS line_{cell}\n"
        for cell in cells
    )
    return (
        f"fuzzy: 1\nname: bells\ninputs:\n{inputs}outputs:\n  y:\n    range: [{low}, {high}]\n    defuzzifier: weighted_average\n"
        f"    terms:\n{terms}operators: {{and: product}}\nrules:\n{rules}"
    )


def table(path, names, columns):
    with open(path, "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(names)
        rows.writerows(map(float, row) for row in columns)


def flagred(*arguments):
    done = subprocess.run([FLAGRED, *map(str, arguments)], capture_output=True, text=True)
    # Exit code 1: some rows have no value.
    if done.returncode > 1:
        sys.exit(done.stderr)
    return done.stdout


def rule_sets(folder, names, known, unknown, start=None):
    """The predictions of rule sets, and their numbers of rules."""
    data, points = folder / "known.csv", folder / "unknown.csv"
    table(data, [*names, "y"], np.column_stack(known))
    table(points, names, unknown)
    ways = {"partitions": [], "partitions, lines": ["--lines"], "clusters": ["--clusters"], "clusters, lines": ["--clusters", "--lines"]}
    for way, options in ways.items():
        found, tuned = folder / "found.yaml", folder / "tuned.yaml"
        flagred("identify", data, "--target", "y", *options, "--no-validation", "--force", "-o", found)
        flagred("tune", found, data, "--no-validation", "--iterations", 20, "--force", "-o", tuned)
        for name, model in ((way, found), (f"{way}, tuned", tuned)):
            yield name, predictions(model, points), model.read_text().count("IF ")
    if start:
        begin, tuned = folder / "bells.yaml", folder / "tuned.yaml"
        begin.write_text(start)
        flagred("tune", begin, data, "--no-validation", "--force", "-o", tuned)
        yield "bells, lines, tuned (ANFIS)", predictions(tuned, points), begin.read_text().count("IF ")


def predictions(model, points):
    rows = csv.DictReader(flagred("eval", model, points).splitlines())
    values = [row["y"] for row in rows]
    return np.array([float(value) if value not in ("", "NA") else np.nan for value in values])


def main():
    print("| data | learner | cross-validation error (RMS) | of that of a line | rules |\n|---|---|---|---|---|")
    for what, (x, y, names), random in (("cars", cars(), True), ("patients", patients(), True), ("series", series(), False)):
        errors, rules = {}, {}
        for split in range(SPLITS if random else 1):
            order = np.random.default_rng(split).permutation(len(y)) if random else np.arange(len(y))
            cut = len(y) * 7 // 10 if random else 500
            known, unknown = order[:cut], order[cut:]
            others = {
                "line": LinearRegression(),
                "random forest": RandomForestRegressor(random_state=0),
                "scikit-learn, boosted trees": HistGradientBoostingRegressor(random_state=0),
                "XGBoost": XGBRegressor(n_estimators=200, learning_rate=0.05, max_depth=4, random_state=0),
            }
            found = [(name, learner.fit(x[known], y[known]).predict(x[unknown]), 0) for name, learner in others.items()]
            with tempfile.TemporaryDirectory() as folder:
                start = None if random else bells(x[known], names)
                found += rule_sets(Path(folder), names, (x[known], y[known]), x[unknown], start)
            for name, predicted, count in found:
                # Where no rule fires there is no value; it is replaced by the mean, so that gaps count for every method.
                predicted = np.where(np.isfinite(predicted), predicted, y[known].mean())
                errors.setdefault(name, []).append(np.sqrt(np.mean((predicted - y[unknown]) ** 2)))
                rules.setdefault(name, []).append(count)
        line = np.mean(errors["line"])
        for name, all_errors in errors.items():
            count = f"{np.mean(rules[name]):.0f}" if rules[name][0] else ""
            print(f"| {what} | {name} | {np.mean(all_errors):.4g} | {100 * np.mean(all_errors) / line:.0f} % | {count} |")


main()
