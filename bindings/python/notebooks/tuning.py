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
# # Tuning
#
# An expert knows the rules, and data determine the numbers. The capacity of a battery is lower in the cold: the rules express
# that, but where does "cold" begin?

# %%
import numpy as np

import flagred

battery = (
    flagred.Model("battery", operators={"and": "product", "implication": "product", "aggregation": "sum"})
    .input("temperature", range=(-20, 40), unit="°C", partition={"cold": -15, "mild": 20})
    .input("load", range=(0, 10), unit="C", partition={"light": 1, "heavy": 9})
    .output("capacity", range=(0, 100), unit="%", terms={"small": {"singleton": 30}, "fair": {"singleton": 60}, "full": {"singleton": 90}})
    .rule("IF temperature IS mild AND load IS light THEN capacity IS full")
    .rule("IF temperature IS mild AND load IS heavy THEN capacity IS fair")
    .rule("IF temperature IS cold AND load IS light THEN capacity IS fair")
    .rule("IF temperature IS cold AND load IS heavy THEN capacity IS small")
)
battery.plot()

# %% [markdown]
# Measurements of six batteries, each a little better or worse than the others.

# %%
random = np.random.default_rng(3)
rows = 240
which = np.arange(rows) % 6
temperature, load = random.uniform(-20, 40, rows), random.uniform(0.5, 9.5, rows)
warmth = np.clip((temperature + 5) / 20, 0, 1)
capacity = 55 + 35 * warmth - 2.5 * load + random.normal(0, 1, 6)[which] + random.normal(0, 2, rows)
measured = {"temperature": temperature, "load": load, "capacity": capacity.clip(0, 100), "battery": which}

# %% [markdown]
# The capacity must not fall with the temperature, and must not rise with the load. Whole batteries are held out in the
# cross-validation.

# %%
tuned = flagred.tune(
    battery, measured, rising=["temperature"], falling=["load"], group_by="battery", folds=6, digits=3
)
for moved in tuned.moved:
    print(f"{moved.of:18} {moved.name:5} {moved.before:g} -> {moved.after:g}")
worth = tuned.validation
print(f"error on left-out batteries: {worth.before.value:.2f} before, {worth.after.value:.2f} after,")
print(f"gain {worth.gain.value:.2f} [{worth.gain.low:.2f}, {worth.gain.high:.2f}]")
assert worth.gain.low > 0

# %% [markdown]
# The rules are those of the expert; only the numbers changed.

# %%
assert [rule.text for rule in tuned.model.rules] == [rule.text for rule in battery.rules]
tuned.model.plot()

# %%
tuned.model.map(points=31)

# %% [markdown]
# Without an expert, `flagred.sklearn.FuzzyRegressor` derives partitions and rules from the data.

# %%
from sklearn.model_selection import GroupKFold, cross_val_score

from flagred.sklearn import FuzzyRegressor

features = np.column_stack((temperature, load))
estimator = FuzzyRegressor(monotonic_cst=[1, -1])
scores = cross_val_score(estimator, features, measured["capacity"], groups=which, cv=GroupKFold(6))
assert scores.mean() > 0.8
scores.round(2)
