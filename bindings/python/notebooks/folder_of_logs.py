# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # A folder of logs
#
# How close was each flight to losing control, and when? Put the folder of your own logs here: ArduPilot `.bin`, PX4 `.ulg`,
# MAVLink `.tlog` or flight CSV.

# %%
from pathlib import Path

import pandas as pd

import flagred

folder = Path("../../../examples/flights")

# %% [markdown]
# A damaged log is read as far as possible, and reports the damage. A file that is not a log is an error, which does not stop
# the others.

# %%
assessments, rows = {}, []
for path in sorted(folder.iterdir()):
    try:
        assessment = flagred.assess(path)
    except flagred.LogError as error:
        rows.append({"log": path.name, "verdict": "NA", "finding": str(error)})
        continue
    assessments[path.name] = assessment
    gravest = assessment.findings[0] if assessment.findings else ""
    flight = assessment.flight
    rows.append(
        {
            "log": path.name,
            "vehicle": flight.vehicle.kind,
            "motors": len(flight.motors),
            "in_air_s": flight.in_air and flight.in_air.duration_s,
            "verdict": assessment.verdict,
            "finding": str(gravest),
        }
    )
assert assessments, f"no log in {folder.resolve()}"
pd.DataFrame(rows)

# %% [markdown]
# The risk over time is a table, which pandas, polars and pyarrow can read.

# %%
name, assessment = next(iter(assessments.items()))
steps = pd.DataFrame(dict(assessment.steps))
steps[["t_s", "risk", "margin", "spread"]].describe()

# %%
print(assessment)

# %% [markdown]
# Signals have their own times. Here are the commands of the ten seconds around the highest risk.

# %%
flight = assessment.flight
at = steps.t_s[steps.risk.idxmax()]
commands = pd.DataFrame(dict(flight.commands_table))
around = commands[(commands.t_s - at).abs() < 5]
assert len(around) > 0
around.describe()

# %% [markdown]
# `assessment` alone, as the last line of a cell, shows the whole report; `assessment.html()` is the page as text.
