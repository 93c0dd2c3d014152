"""Evaluates each rule set of a folder with fuzzylite at the points of the table beside it, and compares the values.

python fuzzylite_peer.py FOLDER: for each NAME.fll, NAME.csv has a column for each input and output.
"""

import csv
import math
import pathlib
import sys

import fuzzylite

LARGEST = 1e-9  # of an output's range


def number(value):
    return float(getattr(value, "item", lambda: value)())


def compare(path):
    engine = fuzzylite.FllImporter().from_string(path.read_text())
    worst = 0.0
    for row in csv.DictReader(path.with_suffix(".csv").open()):
        for variable in engine.input_variables:
            variable.value = float(row[variable.name])
        engine.process()
        for variable in engine.output_variables:
            ours, theirs = row[variable.name], number(variable.value)
            if ours == "NA":
                worst = max(worst, 0.0 if math.isnan(theirs) else math.inf)
            else:
                difference = abs(theirs - float(ours)) / (variable.maximum - variable.minimum)
                worst = max(worst, math.inf if math.isnan(difference) else difference)
    return worst


paths = sorted(pathlib.Path(sys.argv[1]).glob("*.fll"))
wrong = {path.stem: worst for path in paths if (worst := compare(path)) > LARGEST}
for name, worst in wrong.items():
    print(f"{name}: {worst:.3g} of the range")
print(f"{len(paths)} rule sets, {len(wrong)} with other values")
sys.exit(1 if wrong or not paths else 0)
