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
# # A rule set from a DataFrame
#
# A greenhouse has logged its temperature, its humidity and how far the gardener opened the window. Which rules did the
# gardener follow? (`jupytext --to ipynb` converts this file to a notebook; Jupyter with jupytext opens it as one.)

# %%
import numpy as np
import pandas as pd

import flagred

random = np.random.default_rng(7)
days = pd.DataFrame({"temperature": random.uniform(5, 40, 300), "humidity": random.uniform(20, 95, 300)})
wish = 3 * (days.temperature - 18) + 0.5 * (days.humidity - 60)
days["window"] = (wish + random.normal(0, 5, 300)).clip(0, 100).round()
days.head()

# %% [markdown]
# We choose the names of the terms: a partition defines the terms of each variable.

# %%
variables = (
    flagred.Model("greenhouse", operators={"and": "product", "aggregation": "sum"})
    .input("temperature", range=(0, 45), unit="°C", partition={"cool": 12, "mild": 22, "hot": 34})
    .input("humidity", range=(0, 100), unit="%", partition={"dry": 35, "fair": 60, "damp": 85})
    .output("window", range=(0, 100), unit="%", partition=["shut", "ajar", "half", "wide", "open"])
)
variables

# %% [markdown]
# Each combination of terms gets the rule that its days support most. `validation` has the error on held-out days.

# %%
learned = flagred.learn(variables, days, resolve="mean")
for rule in learned.model.rules:
    print(rule.text, f"  ({rule.support} days)")
print(learned.validation)

# %% [markdown]
# For a frame, the rule set returns a frame. It also explains its outputs and lists the uncovered regions.

# %%
days["by_rules"] = learned.model(days)["window"]
error = days.window - days.by_rules
assert error.abs().mean() < 15
days.tail()

# %%
learned.model.explain(temperature=33, humidity=80)

# %%
learned.model.map(points=41)

# %%
for finding in learned.model.check(rising="temperature"):
    print(finding)

# %% [markdown]
# `learned.model.save("greenhouse.yaml")` writes it: for the command line, for Rust and C, or for editing by hand.
