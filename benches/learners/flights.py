"""ROC areas of rule sets and of other learners, all on the inputs of rules/flagred.yaml, cross-validated over vehicles.

Critical means an attitude error over 5 degrees within the next 5 s. DATA is a folder of flight CSVs with attitudes and
vehicles.
"""

import csv
import io
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from sklearn.ensemble import HistGradientBoostingClassifier
from sklearn.linear_model import LogisticRegression
from sklearn.metrics import roc_auc_score
from sklearn.model_selection import GroupKFold

FLAGRED, DATA = sys.argv[1:]
INPUTS = ["unsteady_now", "unsteady_lately", "throttle_activity", "swing_per_room", "at_limit"]
CRITICAL_DEG = 5.0


def flagred(*arguments):
    done = subprocess.run([FLAGRED, *map(str, arguments)], capture_output=True, text=True)
    # Exit code 1: some rows were skipped or have no value.
    if done.returncode > 1:
        sys.exit(done.stderr)
    return list(csv.DictReader(io.StringIO(done.stdout)))


def write(path, names, columns):
    with open(path, "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(names)
        rows.writerows(columns.tolist())


def risks(model, x, folder):
    write(folder / "points.csv", INPUTS, x)
    return np.array([float(row["risk"]) for row in flagred("eval", model, folder / "points.csv")])


def tuned(x, y, folder):
    rows, model = folder / "rows.csv", folder / "tuned.yaml"
    write(rows, [*INPUTS, "risk"], np.column_stack([x, y]))
    options = ["--loss", "log", "--rule-weights", "--min-distance", "0.001", "--no-validation", "--force"]
    flagred("tune", "rules/flagred.yaml", rows, *options, "-o", model)
    return model


def main():
    flights = sorted(Path(DATA).glob("*.csv.gz"))
    rows = flagred("dataset", "--profile", "rules/profiles/multirotor.yaml", "--horizon", "5", *flights)
    rows = [row for row in rows if row["att_rmse_deg"]]
    number = lambda name, empty=0.0: np.array([float(row[name] or empty) for row in rows])
    x = np.column_stack([number(name) for name in INPUTS])
    y = (number("att_rmse_deg") > CRITICAL_DEG).astype(int)
    quiet = number("error_last_10_s_deg") <= CRITICAL_DEG
    wanted = np.array([row["kind"] != "manoeuvre" for row in rows])
    vehicles = np.array([row["vehicle"] for row in rows])
    logarithms = lambda x: np.log(x + 1e-3)
    trees = lambda rising: HistGradientBoostingClassifier(
        max_iter=150, max_leaf_nodes=8, learning_rate=0.06, min_samples_leaf=300, l2_regularization=5, monotonic_cst=rising
    )
    scores = {"rules/flagred.yaml, which knows all vehicles": None, "its 13 rules, tuned on the others by log loss": np.zeros(len(y))}
    learners = {
        "a logistic line over logarithms": lambda x, y: (lambda fit: lambda x: fit.decision_function(logarithms(x)))(
            LogisticRegression().fit(logarithms(x), y)
        ),
        "boosted trees that rise": lambda x, y: (lambda fit: lambda x: fit.predict_proba(x)[:, 1])(trees([1] * len(INPUTS)).fit(x, y)),
        "boosted trees": lambda x, y: (lambda fit: lambda x: fit.predict_proba(x)[:, 1])(trees(None).fit(x, y)),
    }
    scores.update({name: np.zeros(len(y)) for name in learners})
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        shipped, own, *_ = scores
        scores[shipped] = risks("rules/flagred.yaml", x, folder)
        for known, unknown in GroupKFold(7).split(x, groups=vehicles):
            known = known[wanted[known]]
            scores[own][unknown] = risks(tuned(x[known], y[known], folder), x[unknown], folder)
            for name, learn in learners.items():
                scores[name][unknown] = learn(x[known], y[known])(x[unknown])
    print(f"{len(set(vehicles))} vehicles, {wanted.sum()} steps without manoeuvres, of which {100 * y[wanted].mean():.1f} % became critical")
    print("\n| learner | ROC area | after 10 s of quiet |\n|---|---|---|")
    for name, score in scores.items():
        areas = [roc_auc_score(y[of], score[of]) for of in (wanted, wanted & quiet)]
        print(f"| {name} | {areas[0]:.3f} | {areas[1]:.3f} |")


main()
