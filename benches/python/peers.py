"""A million rows of the tipper, compared with scikit-fuzzy, simpful and pyfuzzylite; `run` creates their environment.

Each is called in its own way, with arrays if it supports them. Slow peers get fewer rows; ratios are per row.
The cache of scikit-fuzzy is off, because repeated inputs would not be measured.
"""

import sys
import time
import warnings

import numpy as np

import flagred

warnings.filterwarnings("ignore")
ROWS = 1_000_000
service, food = np.random.default_rng(1).uniform(0, 10, (2, ROWS))
model = flagred.load("rules/tipper.yaml")
TERMS = {
    "service": {"poor": 0, "good": 5, "excellent": 10},
    "food": {"rancid": [-1, 0, 1, 3], "delicious": [7, 9, 10, 11]},
    "tip": {"cheap": [0, 5, 10], "average": [10, 15, 20], "generous": [20, 25, 30]},
}


def seconds(run, times=5):
    taken = []
    for _ in range(times):
        begun = time.perf_counter()
        run()
        taken.append(time.perf_counter() - begun)
    return min(taken)


def ours():
    yield "flagred, arrays, 1 thread", ROWS, lambda: model(service, food, threads=1)
    yield "flagred, arrays, 2 threads", ROWS, lambda: model(service, food, threads=2)
    calls = 200_000
    for name, ask in {
        "flagred, a call by place": lambda: model(8.0, 9.0),
        "flagred, a call by name": lambda: model(service=8.0, food=9.0),
        "flagred, evaluate by name": lambda: model.evaluate(service=8.0, food=9.0),
    }.items():
        yield name, calls, lambda ask=ask: [ask() for _ in range(calls)]
    import importlib

    for library in ("pandas", "polars"):
        try:
            frame = importlib.import_module(library).DataFrame({"service": service, "food": food})
        except ImportError:
            continue
        yield f"flagred, {library}, 1 thread", ROWS, lambda frame=frame: model(frame, threads=1)


def pyfuzzylite():
    import fuzzylite as fl

    variables = [
        fl.InputVariable("service", minimum=0, maximum=10, terms=[fl.Gaussian(n, c, 1.5) for n, c in TERMS["service"].items()]),
        fl.InputVariable("food", minimum=0, maximum=10, terms=[fl.Trapezoid(n, *p) for n, p in TERMS["food"].items()]),
    ]
    tip = fl.OutputVariable(
        "tip",
        minimum=0,
        maximum=30,
        aggregation=fl.Maximum(),
        defuzzifier=fl.Centroid(),
        terms=[fl.Triangle(n, *p) for n, p in TERMS["tip"].items()],
    )
    rules = [fl.Rule.create(rule.text.replace("IF", "if").replace("IS", "is").replace("THEN", "then").replace("OR", "or")) for rule in model.rules]
    block = fl.RuleBlock("", disjunction=fl.Maximum(), conjunction=fl.Minimum(), implication=fl.Minimum(), activation=fl.General(), rules=rules)
    engine = fl.Engine("tipper", input_variables=variables, output_variables=[tip], rule_blocks=[block])

    def arrays(rows):
        variables[0].value, variables[1].value = service[:rows], food[:rows]
        engine.process()
        return np.asarray(tip.value)

    yield "pyfuzzylite, arrays", 20_000, lambda: arrays(20_000)
    yield "pyfuzzylite, a call", 300, lambda: [arrays(1) for _ in range(300)]


def scikit_fuzzy():
    import skfuzzy as sk
    from skfuzzy import control

    places = {"service": np.linspace(0, 10, 101), "food": np.linspace(0, 10, 101), "tip": np.linspace(0, 30, 301)}
    s, f = (control.Antecedent(places[name], name) for name in ("service", "food"))
    t = control.Consequent(places["tip"], "tip")
    for name, centre in TERMS["service"].items():
        s[name] = sk.gaussmf(places["service"], centre, 1.5)
    for name, points in TERMS["food"].items():
        f[name] = sk.trapmf(places["food"], points)
    for name, points in TERMS["tip"].items():
        t[name] = sk.trimf(places["tip"], points)
    rules = [
        control.Rule(s["poor"] | f["rancid"], t["cheap"]),
        control.Rule(s["good"], t["average"]),
        control.Rule(s["excellent"] | f["delicious"], t["generous"]),
    ]

    # A simulation accepts arrays of one length, or numbers.
    def ask(simulation, first, second):
        simulation.input["service"], simulation.input["food"] = first, second
        simulation.compute()
        return simulation.output["tip"]

    many, one = (control.ControlSystemSimulation(control.ControlSystem(rules), cache=False) for _ in range(2))
    yield "scikit-fuzzy, arrays", 2_000, lambda: ask(many, service[:2_000], food[:2_000])
    yield "scikit-fuzzy, a call", 300, lambda: [ask(one, float(service[i]), float(food[i])) for i in range(300)]


def simpful():
    import simpful as sf

    system = sf.FuzzySystem(show_banner=False)
    sets = {
        "service": [sf.GaussianFuzzySet(centre, 1.5, name) for name, centre in TERMS["service"].items()],
        "food": [sf.TrapezoidFuzzySet(*points, term=name) for name, points in TERMS["food"].items()],
        "tip": [sf.TriangleFuzzySet(*points, term=name) for name, points in TERMS["tip"].items()],
    }
    for name, high in (("service", 10), ("food", 10), ("tip", 30)):
        system.add_linguistic_variable(name, sf.LinguisticVariable(sets[name], universe_of_discourse=[0, high]))
    system.add_rules(
        [
            "IF (service IS poor) OR (food IS rancid) THEN (tip IS cheap)",
            "IF (service IS good) THEN (tip IS average)",
            "IF (service IS excellent) OR (food IS delicious) THEN (tip IS generous)",
        ]
    )

    def ask(i):
        system.set_variable("service", service[i])
        system.set_variable("food", food[i])
        return system.Mamdani_inference(["tip"])["tip"]

    yield "simpful, a call", 100, lambda: [ask(i) for i in range(100)]


def main():
    each = []
    for library in (ours, pyfuzzylite, scikit_fuzzy, simpful):
        try:
            for name, rows, run in library():
                run()
                each.append((name, seconds(run) / rows))
        except ImportError as error:
            print(f"not measured: {error}", file=sys.stderr)
    unit = each[0][1]
    print(f"| how | time for a row | times `{each[0][0]}` |")
    print("|---|---|---|")
    for name, taken in each:
        print(f"| {name} | {taken * 1e6:.3f} us | {taken / unit:,.1f} |")


main()
