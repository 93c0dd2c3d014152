"""Times scikit-fuzzy and simpful on the system (bw): peers.py FOLDER

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


for peer in (scikit_fuzzy, simpful_):
    try:
        peer()
    except Exception as error:  # The error of a peer is printed, and the others continue.
        print(f"bw,{peer.__name__} failed,nan,nan")
        print(f"{peer.__name__}: {type(error).__name__}: {error}", file=sys.stderr)
