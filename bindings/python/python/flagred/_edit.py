"""Editable parts of a model: every change is validated, and an invalid one changes nothing."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, MutableMapping, MutableSequence
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

from ._arrays import array
from ._core import RuleSet
from .errors import DataError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from ._model import Model

Document = dict[str, Any]


def plain(value: Any) -> Any:
    """Converts a value to JSON types: tuples become lists, and numbers of NumPy become numbers of Python."""
    if isinstance(value, (str, bool, int, float)) or value is None:
        return value
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    return [plain(item) for item in value]


def edit(model: RuleSet, change: Callable[[Document], None]) -> None:
    """Changes the document of a model."""
    document: Document = json.loads(model._json())
    change(document)
    try:
        changed = json.dumps(document, allow_nan=False)
    except ValueError:
        raise DataError("a number is NaN or infinite\n  help: numbers of a rule set must be finite") from None
    model._edit(changed)


def rule_lists(document: Document) -> list[list[Any]]:
    """The lists of rules: one, or one for each block."""
    if "blocks" in document:
        return [block["rules"] for block in document["blocks"].values()]
    return [document["rules"]]


def find(document: Document, index: int) -> tuple[list[Any], int]:
    """The list that contains a rule, and its index there."""
    for rules in rule_lists(document):
        if index < len(rules):
            return rules, index
        index -= len(rules)
    raise IndexError("there is no such rule")


class Rule:
    """A rule of a model. Setting an attribute changes the model."""

    __slots__ = ("_index", "_model")

    def __init__(self, model: RuleSet, index: int) -> None:
        self._model, self._index = model, index

    @property
    def index(self) -> int:
        """Its index in ``model.rules``, from 0."""
        return self._index

    @property
    def number(self) -> int:
        """Its rule number, from 1, as in findings and explanations."""
        return self._index + 1

    @property
    def text(self) -> str:
        """The rule: ``IF temperature IS hot THEN speed IS fast``."""
        return self._model._rule(self._index)[0]

    @text.setter
    def text(self, text: str) -> None:
        self._set("rule", text)

    @property
    def weight(self) -> float:
        """Its weight, in (0, 1]."""
        return self._model._rule(self._index)[1]

    @weight.setter
    def weight(self, weight: float) -> None:
        self._set("rule", RuleSet._weighted(self.text, float(weight)))

    @property
    def confidence(self) -> float | None:
        """The confidence of its source, in [0, 1]."""
        return self._model._rule(self._index)[2]

    @confidence.setter
    def confidence(self, confidence: float | None) -> None:
        self._set("confidence", confidence)

    @property
    def support(self) -> int | None:
        """The number of samples that support it."""
        return self._model._rule(self._index)[3]

    @property
    def note(self) -> str | None:
        """The author's note."""
        return self._model._rule(self._index)[4]

    @note.setter
    def note(self, note: str | None) -> None:
        self._set("note", note)

    def _set(self, key: str, value: Any) -> None:
        def change(document: Document) -> None:
            rules, at = find(document, self._index)
            rule = rules[at] if isinstance(rules[at], dict) else {"rule": rules[at]}
            rules[at] = {name: item for name, item in {**rule, key: plain(value)}.items() if item is not None}

        edit(self._model, change)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"Rule({self.number}: {self.text})"


class Rules(MutableSequence[Rule]):
    """The rules of a model, in their order. A text can be assigned to an index."""

    __slots__ = ("_model",)

    def __init__(self, model: RuleSet) -> None:
        self._model = model

    def __len__(self) -> int:
        return self._model._rule_count()

    def _index(self, index: int) -> int:
        known = range(len(self))
        try:
            return known[index]
        except IndexError:
            raise IndexError(f"there are {len(known)} rules") from None

    @overload
    def __getitem__(self, index: int) -> Rule: ...
    @overload
    def __getitem__(self, index: slice) -> list[Rule]: ...
    def __getitem__(self, index: int | slice) -> Rule | list[Rule]:
        if isinstance(index, slice):
            return [Rule(self._model, i) for i in range(len(self))[index]]
        return Rule(self._model, self._index(index))

    def __setitem__(self, index: Any, rule: Any) -> None:
        at = self._index(index)

        def change(document: Document) -> None:
            rules, place = find(document, at)
            rules[place] = plain(str(rule) if isinstance(rule, Rule) else rule)

        edit(self._model, change)

    def __delitem__(self, index: int | slice) -> None:
        chosen = range(len(self))[index] if isinstance(index, slice) else [self._index(index)]

        def change(document: Document) -> None:
            for at in sorted(chosen, reverse=True):
                rules, place = find(document, at)
                del rules[place]

        edit(self._model, change)

    def insert(self, index: int, rule: Any) -> None:
        """Inserts a rule before this index, or after the last rule."""
        at = range(len(self) + 1)[slice(index, None)]

        def change(document: Document) -> None:
            text = plain(str(rule) if isinstance(rule, Rule) else rule)
            if at and at[0] < len(self):
                rules, place = find(document, at[0])
                rules.insert(place, text)
            else:
                rule_lists(document)[-1].append(text)

        edit(self._model, change)

    def __repr__(self) -> str:
        return "\n".join(f"{rule.number}: {rule.text}" for rule in self)


def _key(name: str, doc: str) -> Any:
    """A property for a key of the rule-set format."""

    def get(self: Variable) -> Any:
        return self._document().get(name)

    def put(self: Variable, value: Any) -> None:
        self._set(name, value)

    return property(get, put, doc=doc)


class Term:
    """A term of a variable. Calling it with values returns their degrees of membership."""

    __slots__ = ("_model", "_variable", "name")

    name: str
    """Its name in rules."""

    def __init__(self, model: RuleSet, variable: str, name: str) -> None:
        self._model, self._variable, self.name = model, variable, name

    @overload
    def __call__(self, value: float | None) -> float: ...
    @overload
    def __call__(self, value: ArrayLike) -> NDArray[np.float64]: ...
    def __call__(self, value: Any) -> Any:
        degrees = self._model._degrees(self._variable, self.name, array(value))
        return degrees if degrees.ndim else float(degrees)

    def __repr__(self) -> str:
        return f"Term({self._variable} IS {self.name})"


class Variable:
    """An input or output of a model. Setting an attribute changes the model.

    Its attributes are the keys of the rule-set format; missing ones are None. ``variable["hot"]`` is a term:
    called with a number or an array, it returns degrees of membership. Values outside the range have the degrees of its
    ends, and NaN has the degree NaN.

    Examples
    --------
    >>> import flagred
    >>> fan = flagred.Model("fan").input("heat", range=(0, 40), partition=["cool", "hot"])
    >>> fan.inputs["heat"]["hot"](10)
    0.25
    >>> fan.inputs["heat"]["hot"]([10, 20, 50])
    array([0.25, 0.5 , 1.  ])
    >>> list(fan.inputs["heat"])
    ['cool', 'hot']
    """

    __slots__ = ("_kind", "_model", "name")

    name: str
    """Its name in rules."""

    def __init__(self, model: RuleSet, kind: str, name: str) -> None:
        self._model, self._kind, self.name = model, kind, name

    def _document(self) -> Document:
        found: Document = json.loads(self._model._json())[self._kind][self.name]
        return found

    def __getitem__(self, term: str) -> Term:
        if term not in self:
            there = ", ".join(f"`{name}`" for name in self)
            raise KeyError(f"`{self.name}` has no term `{term}`; its terms are {there}")
        return Term(self._model, self.name, term)

    def __iter__(self) -> Iterator[str]:
        return iter(self._model._term_names(self.name))

    def __len__(self) -> int:
        return len(self._model._term_names(self.name))

    def __contains__(self, term: object) -> bool:
        return term in self._model._term_names(self.name)

    range: Any = _key("range", "The minimum and the maximum.")
    unit: Any = _key("unit", "The unit of its values, for readers.")
    description: Any = _key("description", "Its meaning.")
    partition: Any = _key("partition", "Adjacent terms: a list, or a dict of their peaks. Instead of ``terms``.")
    steps: Any = _key("steps", "Terms that divide the range: a dict of their limits, None for the last. Instead of ``terms``.")
    terms: Any = _key("terms", "The terms: a membership function for each name. Instead of ``partition``.")

    def _set(self, key: str, value: Any) -> None:
        def change(document: Document) -> None:
            variable = document[self._kind][self.name]
            if key in ("partition", "steps", "terms"):
                for form in ("partition", "steps", "terms"):
                    variable.pop(form, None)
            variable[key] = plain(value)
            if value is None:
                del variable[key]

        edit(self._model, change)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name}: {self._document()})"


class Output(Variable):
    """An output of a model."""

    __slots__ = ()

    defuzzifier: Any = _key("defuzzifier", "How the aggregated set becomes a number: ``centroid``, ``bisector``, ...")
    samples: Any = _key("samples", "Integrate by sampling, as other programs do: ``{'midpoint': 1000}``.")
    when_no_rule_fires: Any = _key(
        "when_no_rule_fires", "``undefined``, ``error``, ``previous``, ``{'value': 50}`` or ``{'previous': 50}``."
    )
    aggregation: Any = _key("aggregation", "How the consequents of this output are combined.")
    clamp: Any = _key("clamp", "Whether a value outside the range is clamped to it.")


_V = TypeVar("_V", bound=Variable)


class Variables(MutableMapping[str, _V], Generic[_V]):
    """The inputs or outputs of a model by their names, in their order.

    A dict with the keys of the rule-set format can be assigned to a name.
    """

    __slots__ = ("_kind", "_model", "_view")

    def __init__(self, model: Model, kind: str, view: type[_V]) -> None:
        self._model, self._kind, self._view = model, kind, view

    def _names(self) -> list[str]:
        return self._model._input_names() if self._kind == "inputs" else self._model._output_names()

    def __getitem__(self, name: str) -> _V:
        if name not in self._names():
            raise KeyError(name)
        return self._view(self._model, self._kind, name)

    def __setitem__(self, name: str, variable: Any) -> None:
        data = variable._document() if isinstance(variable, Variable) else plain(variable)
        edit(self._model, lambda document: document[self._kind].update({name: data}))

    def __delitem__(self, name: str) -> None:
        if name not in self._names():
            raise KeyError(name)
        edit(self._model, lambda document: document[self._kind].pop(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __len__(self) -> int:
        return len(self._names())

    def __repr__(self) -> str:
        return f"{self._kind.capitalize()}({', '.join(self._names())})"


class Operators(MutableMapping[str, str]):
    """The operators of all rules: ``and``, ``or``, ``implication`` and ``aggregation``."""

    __slots__ = ("_model",)

    def __init__(self, model: RuleSet) -> None:
        self._model = model

    def _document(self) -> dict[str, str]:
        found: dict[str, str] = json.loads(self._model._json())["operators"]
        return found

    def __getitem__(self, name: str) -> str:
        return self._document()[name]

    def __setitem__(self, name: str, operator: str) -> None:
        edit(self._model, lambda document: document["operators"].update({name: operator}))

    def __delitem__(self, name: str) -> None:
        edit(self._model, lambda document: document["operators"].pop(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._document())

    def __len__(self) -> int:
        return len(self._document())

    def __repr__(self) -> str:
        return f"Operators({self._document()})"
