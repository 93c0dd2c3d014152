"""Evaluates each rule set of a folder with PyIT2FLS at the points of the table beside it, and compares the values.

python pyit2fls_peer.py FOLDER: for each NAME.fcl, NAME.csv has a column for each input and output. PyIT2FLS integrates over
100 points.
"""

import csv
import pathlib
import sys

from pyit2fls.FCL import FCL

LARGEST = 0.02  # of an output's range


def compare(path):
    reader = FCL()
    _, variables, rules = reader.parse_fcl(path.read_text())
    system = reader.generate(variables, rules)
    worst = 0.0
    for row in csv.DictReader(path.with_suffix(".csv").open()):
        _, values = system.evaluate({name: float(row[name]) for name in variables["input"]})
        for name, output in variables["output"].items():
            width = output["domainright"] - output["domainleft"]
            difference = abs(float(values[name]) - float(row[name])) / width
            worst = max(worst, difference)
    return worst


paths = sorted(pathlib.Path(sys.argv[1]).glob("*.fcl"))
wrong = {path.stem: worst for path in paths if not (worst := compare(path)) <= LARGEST}
for name, worst in wrong.items():
    print(f"{name}: {worst:.3g} of the range")
print(f"{len(paths)} rule sets, {len(wrong)} with other values")
sys.exit(1 if wrong or not paths else 0)
