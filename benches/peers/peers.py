"""Times scikit-fuzzy and simpful on the system (bw), and PyIT2FLS on (b2): peers.py FOLDER

Prints `system,program,ns per call,largest error in % of the range`.
"""
import importlib.metadata
import sys
import time
import warnings

import numpy as np

warnings.filterwarnings("ignore")
rows = [[float(x) for x in line.split()] for line in open(sys.argv[1] + "/bw.points")][:128]
rules = [line.split(": ", 1)[1].split() for line in open(sys.argv[1] + "/bw.fll") if line.strip().startswith("rule:")]
# if margin is M and spread is S then risk is R with W
rules = [(w[3], w[7], w[11], float(w[13])) for w in rules]
MARGIN = {"very_low": (0, 0, 0.1), "low": (0, 0.1, 0.2), "medium": (0.1, 0.2, 0.3), "high": (0.2, 0.3, 0.5, 0.5)}
SPREAD = {"low": (0, 0, 0.1), "medium": (0, 0.1, 0.2), "high": (0.1, 0.2, 0.5, 0.5)}
RISK = {"very_low": (0, 0, 25), "low": (0, 25, 50), "medium": (25, 50, 75), "high": (50, 75, 100), "very_high": (75, 100, 100)}


def report(program, evaluate):
    best, worst = float("inf"), 0.0
    for _ in range(3):
        begun = time.perf_counter()
        values = [evaluate(row[0], row[1]) for row in rows]
        best = min(best, time.perf_counter() - begun)
    for row, value in zip(rows, values):
        if value is not None and row[2] == row[2]:
            worst = max(worst, abs(value - row[2]))
    print(f"bw,{program},{best * 1e9 / len(rows):.0f},{worst:.2g}")


def scikit_fuzzy():
    import skfuzzy
    from skfuzzy import control

    def variable(kind, name, high, terms):
        variable = kind(np.linspace(0, high, 101), name)
        for term, corners in terms.items():
            shape = skfuzzy.trimf if len(corners) == 3 else skfuzzy.trapmf
            variable[term] = shape(variable.universe, corners)
        return variable

    margin = variable(control.Antecedent, "margin", 0.5, MARGIN)
    spread = variable(control.Antecedent, "spread", 0.5, SPREAD)
    risk = variable(control.Consequent, "risk", 100, RISK)
    made = [control.Rule(margin[m] & spread[s], risk[r] % w) for m, s, r, w in rules]
    simulation = control.ControlSystemSimulation(control.ControlSystem(made), cache=False)

    def evaluate(m, s):
        simulation.input["margin"], simulation.input["spread"] = m, s
        try:
            simulation.compute()
            return float(simulation.output["risk"])
        except (KeyError, ValueError):
            return None

    report(f"scikit-fuzzy {importlib.metadata.version('scikit-fuzzy')} (Python) 101 points", evaluate)


def simpful_():
    import simpful

    system = simpful.FuzzySystem(show_banner=False)

    def variable(name, high, terms):
        sets = []
        for term, corners in terms.items():
            shape = simpful.TriangleFuzzySet if len(corners) == 3 else simpful.TrapezoidFuzzySet
            sets.append(shape(*corners, term=term))
        system.add_linguistic_variable(name, simpful.LinguisticVariable(sets, universe_of_discourse=[0, high]))

    variable("margin", 0.5, MARGIN)
    variable("spread", 0.5, SPREAD)
    variable("risk", 100, RISK)
    system.add_rules([f"IF (margin IS {m}) AND (spread IS {s}) THEN (risk IS {r}) WEIGHT {w}" for m, s, r, w in rules])

    def evaluate(m, s):
        system.set_variable("margin", m)
        system.set_variable("spread", s)
        try:
            return float(system.Mamdani_inference(["risk"], subdivisions=100, ignore_warnings=True)["risk"])
        except ZeroDivisionError:
            return None

    report(f"simpful {importlib.metadata.version('simpful')} (Python) 100 points", evaluate)


def pyit2fls_():
    import pyit2fls

    points = [[float(x) for x in line.split()] for line in open(sys.argv[1] + "/b2.points")]
    points = [point for point in points if len(point) == 5][:128]

    def variable(high, by, terms):
        domain, sets = np.linspace(0, high, 101), {}
        for term, corners in terms.items():
            if len(corners) == 3:
                peak, step = corners[1], high / 4 if high == 100 else 0.1
                if corners[0] == corners[1]:
                    corners = (peak - step, peak, peak + step)
                if corners[1] == corners[2]:
                    corners = (peak - step, peak, peak + step)
                left, peak, right = corners
                function, upper, lower = pyit2fls.tri_mf, [left - by, peak, right + by, 1.0], [left + by, peak, right - by, 0.9]
            else:
                left, top = corners[:2]
                function = pyit2fls.trapezoid_mf
                upper, lower = [left - by, top, high, 1.2 * high + by, 1.0], [left + by, top, high, 1.2 * high - by, 0.9]
            sets[term] = pyit2fls.IT2FS(domain, function, upper, function, lower)
        return sets

    margin, spread, risk = variable(0.5, 0.01, MARGIN), variable(0.5, 0.01, SPREAD), variable(100, 2.5, RISK)
    for algorithm in ("KM", "EIASC", "NT", "WM"):
        system = pyit2fls.IT2Mamdani(pyit2fls.min_t_norm, pyit2fls.max_s_norm, method="Centroid", algorithm=algorithm)
        system.add_input_variable("margin")
        system.add_input_variable("spread")
        system.add_output_variable("risk")
        for m, s, r, _ in rules:
            system.add_rule([("margin", margin[m]), ("spread", spread[s])], [("risk", risk[r])])
        best, worst = float("inf"), 0.0
        for _ in range(3):
            begun = time.perf_counter()
            found = [system.evaluate({"margin": point[0], "spread": point[1]})[1]["risk"] for point in points]
            best = min(best, time.perf_counter() - begun)
        for point, ends in zip(points, found):
            if algorithm in ("KM", "EIASC"):
                worst = max(worst, abs(ends[0] - point[3]), abs(ends[1] - point[4]))
        error = f"{worst:.2g}" if algorithm in ("KM", "EIASC") else ""
        version = importlib.metadata.version("pyit2fls")
        print(f"b2,PyIT2FLS {version} (Python) 101 points {algorithm},{best * 1e9 / len(points):.0f},{error}")


for peer in (scikit_fuzzy, simpful_, pyit2fls_):
    try:
        peer()
    except Exception as error:  # The error of a peer is printed, and the others continue.
        print(f"bw,{peer.__name__} failed,nan,nan")
        print(f"{peer.__name__}: {type(error).__name__}: {error}", file=sys.stderr)
