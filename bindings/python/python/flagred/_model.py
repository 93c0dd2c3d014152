"""Rule sets."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping, Sequence
from typing import IO, Any, Literal

from ._core import RuleSet, _built_in
from ._edit import Document, Operators, Output, Rules, Variable, Variables, edit, plain, rule_lists
from .errors import DataError, RuleSetError
from ._picture import Picture, plot_surface

__all__ = ["Model", "load", "loads"]


Partition = Sequence[str] | Mapping[str, float]
Steps = Mapping[str, float | None]
Terms = Mapping[str, Mapping[str, Any]]

_ENDINGS: dict[str, Literal["yaml", "fis", "fll", "fcl", "fml", "rust", "c"]] = {
    ".yaml": "yaml",
    ".yml": "yaml",
    ".fis": "fis",
    ".t2fis": "fis",
    ".fll": "fll",
    ".fcl": "fcl",
    ".fml": "fml",
    ".xml": "fml",
    ".rs": "rust",
    ".c": "c",
    ".h": "c",
}

_EMPTY = "fuzzy: 1\nname: model\ninputs: {}\noutputs: {}\nrules: []\n"


class Model(RuleSet):
    """A fuzzy rule set: inputs and outputs with their terms, and rules between them.

    :func:`load` and :func:`loads` read one. A model is called like a function. It is compiled at its first use,
    can be used by many threads at once, and can be pickled and copied.

    Parameters
    ----------
    name
        The name of a new rule set, to be extended by :meth:`input`, :meth:`output` and :meth:`rule`.
    description
        Its purpose.
    operators
        ``and``, ``or``, ``implication``, ``aggregation``; by default those of the rule-set format.

    Examples
    --------
    >>> import flagred
    >>> fan = (
    ...     flagred.Model("fan")
    ...     .input("temperature", range=(0, 40), unit="°C", partition={"cold": 10, "hot": 30})
    ...     .output("speed", range=(0, 9), partition=["slow", "fast"])
    ...     .rule("IF temperature IS cold THEN speed IS slow", "IF temperature IS hot THEN speed IS fast")
    ... )
    >>> fan(20)
    4.5
    >>> fan.rules[1].weight = 0.5
    >>> fan.rules[1].text
    'IF temperature IS hot THEN speed IS fast WITH 0.5'
    >>> flagred.loads(fan.to_yaml()) == fan
    True
    """

    __slots__ = ()

    def __new__(
        cls, name: str, description: str | None = None, *, operators: Mapping[str, str] | None = None
    ) -> Model:
        model: Model = super().__new__(cls, _EMPTY, "<model>", True)

        def fill(document: Document) -> None:
            document["name"] = name
            document["operators"].update(operators or {})
            if description is not None:
                document["description"] = description

        edit(model, fill)
        return model

    def input(
        self,
        name: str,
        *,
        range: Sequence[float],
        partition: Partition | None = None,
        steps: Steps | None = None,
        terms: Terms | None = None,
        unit: str | None = None,
        description: str | None = None,
    ) -> Model:
        """Adds an input.

        Parameters
        ----------
        name
            Its name in rules.
        range
            Its minimum and maximum.
        partition
            Adjacent terms: their names, evenly spaced over the range, or the peak of each.
        terms
            Instead of a partition, a membership function for each term: ``{"hot": {"right_shoulder": [20, 30]}}``.
        steps
            Instead of a partition, the limit below which each term ends, and ``None`` for the last: ``{"low": 36, "high":
            None}``.
        unit
            The unit of its values, for readers.
        description
            Its meaning.

        Returns
        -------
        Model
            The model itself.
        """
        return self._add("inputs", name, locals())

    def output(
        self,
        name: str,
        *,
        range: Sequence[float],
        partition: Partition | None = None,
        steps: Steps | None = None,
        terms: Terms | None = None,
        unit: str | None = None,
        description: str | None = None,
        defuzzifier: str | None = None,
        samples: Mapping[str, int] | None = None,
        when_no_rule_fires: str | Mapping[str, float] | None = None,
        aggregation: str | None = None,
        clamp: bool | None = None,
    ) -> Model:
        """Adds an output. :meth:`input` describes the common parameters.

        Parameters
        ----------
        defuzzifier
            How the aggregated set becomes a number; by default ``centroid``.
        samples
            Integrate by sampling, as other programs do: ``{"midpoint": 1000}``.
        when_no_rule_fires
            ``undefined`` (the default), ``error``, ``previous``, ``{"value": 50}`` or ``{"previous": 50}``.
        aggregation
            How the consequents of this output are combined; by default as in ``operators``.
        clamp
            Whether a value outside the range is clamped to it.

        Returns
        -------
        Model
            The model itself.
        """
        return self._add("outputs", name, locals())

    def rule(self, *texts: str) -> Model:
        """Adds rules.

        Parameters
        ----------
        texts
            ``IF temperature IS hot AND NOT humidity IS low THEN speed IS very fast WITH 0.8``

        Returns
        -------
        Model
            The model itself.
        """
        edit(self, lambda document: rule_lists(document)[-1].extend(texts))
        return self

    def _add(self, kind: str, name: str, given: dict[str, Any]) -> Model:
        if name in (*self._input_names(), *self._output_names()):
            raise DataError(f"the name `{name}` is already used by a variable\n  help: `model.{kind}['{name}'] = ...` replaces it")
        keys = {key: plain(value) for key, value in given.items() if key not in ("self", "name") and value is not None}
        edit(self, lambda document: document[kind].update({name: keys}))
        return self

    @property
    def inputs(self) -> Variables[Variable]:
        """The inputs by their names, in the order of their values. They can be changed."""
        return Variables(self, "inputs", Variable)

    @property
    def outputs(self) -> Variables[Output]:
        """The outputs by their names. They can be changed."""
        return Variables(self, "outputs", Output)

    @property
    def rules(self) -> Rules:
        """The rules, in their order. They can be changed."""
        return Rules(self)

    @property
    def operators(self) -> Operators:
        """The operators of all rules. They can be changed."""
        return Operators(self)

    @property
    def name(self) -> str:
        """The name of the rule set."""
        return self._name()

    @name.setter
    def name(self, name: str) -> None:
        edit(self, lambda document: document.update(name=name))

    @property
    def description(self) -> str | None:
        """The purpose of the rule set, in the author's words."""
        return self._description()

    @description.setter
    def description(self, description: str | None) -> None:
        def change(document: Document) -> None:
            document.pop("description", None)
            if description is not None:
                document["description"] = description

        edit(self, change)

    def to_dict(self) -> dict[str, Any]:
        """The rule set as a document, with the keys of the rule-set format.

        Inputs, outputs, terms and blocks are lists of entries with a ``name``, because their order has a meaning, also after
        ``json.dumps(..., sort_keys=True)``. :func:`loads` reads the JSON of the document.
        """
        found: dict[str, Any] = json.loads(self._json_lists())
        return found

    @property
    def text(self) -> str:
        """The text that was read; after edits, YAML with the comments of the unchanged lines."""
        return self._text()[0]

    def to_text(
        self, format: Literal["yaml", "fis", "fll", "fcl", "fml", "rust", "c"] = "yaml", *, lossy: bool = False
    ) -> str:
        """The rule set as text, as :meth:`save` writes it.

        Parameters
        ----------
        format
            ``yaml``; ``fis`` for MATLAB and Octave; ``fll`` for fuzzylite; ``fcl`` for programs of IEC 61131-7; ``fml`` for
            programs of IEEE 1855; ``rust`` and ``c`` for firmware. :meth:`Profile.to_code` also writes Lua.
        lossy
            Drop what the format cannot express, with a warning; results may differ.

        Returns
        -------
        str
            In the original format, the text that was read, with its comments. Edits change the YAML where they apply and
            keep the comments of other lines where possible.

        Raises
        ------
        RuleSetError
            The format cannot express the rule set.

        Examples
        --------
        >>> import flagred
        >>> model = flagred.load("flagred")
        >>> model.to_text("fll").splitlines()[0]
        'Engine: flagred'
        """
        if format not in _ENDINGS.values():
            known = ", ".join(f"`{known}`" for known in dict.fromkeys(_ENDINGS.values()))
            raise DataError(f"`{format}` is not a format of rule sets\n  help: write one of {known}")
        text, dropped = self._to_text(format, lossy)
        for message in dropped:
            warnings.warn(message, stacklevel=2)
        return text

    def save(self, path: str | os.PathLike[str], *, lossy: bool = False) -> None:
        """Writes the rule set to a file, in the format of the file's extension.

        Parameters
        ----------
        path
            The file: ``.yaml``, ``.yml``, ``.fis``, ``.fll``, ``.fcl``, ``.fml``, ``.xml``, ``.rs``,
            ``.c`` or ``.h``.
        lossy
            As for :meth:`to_text`.

        Raises
        ------
        DataError
            The file has another extension.
        RuleSetError
            The format cannot express the rule set.
        """
        ending = os.path.splitext(os.fspath(path))[1].lower()
        if ending not in _ENDINGS:
            known = ", ".join(f"`{known}`" for known in _ENDINGS)
            raise DataError(f"`{os.fspath(path)}` does not have the extension of a rule set\n  help: the extensions are {known}")
        text = self.to_text(_ENDINGS[ending], lossy=lossy)
        # Keeps the line breaks of the text that was read.
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(text)

    def surface(
        self, ax: Any | None = None, *, points: int = 31, output: str | None = None, **fixed: float
    ) -> Any:
        """Draws a three-dimensional surface of an output over two inputs.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes of matplotlib with ``projection="3d"`` to draw on.
        points, output, fixed
            As for :meth:`map`. A model with more than two inputs needs values for the others.

        Returns
        -------
        Picture or matplotlib.axes.Axes
            The axes; without ``ax`` a picture in SVG, which does not require matplotlib.

        Examples
        --------
        >>> import flagred
        >>> model = flagred.load("flagred-paper")
        >>> str(model.surface())[:4]
        '<svg'
        """
        return plot_surface(self.map(points=points, output=output, threads=None, **fixed), ax)

    def plot(self) -> Picture:
        """Draws the terms of all variables.

        Returns
        -------
        Picture
            Shown by Jupyter; ``str()`` is the SVG.
        """
        return Picture(self._variables_svg())

    def _repr_svg_(self) -> str:
        return self._variables_svg()

    def __repr__(self) -> str:
        return f"Model({self.name}: {', '.join(self._input_names())} -> {', '.join(self._output_names())})"

    def __eq__(self, other: object) -> bool:
        return self._equals(other) if isinstance(other, Model) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return _read, self._text()

    def __copy__(self) -> Model:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Model:
        return self.copy()

    def copy(self) -> Model:
        """An equal but independent model: editing one does not change the other."""
        other = Model(self.name)
        other._share(self)
        return other


def _read(text: str, file: str) -> Model:
    return RuleSet.__new__(Model, text, file, file == "<model>")


def _decoded(data: bytes, name: str) -> str:
    encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        raise RuleSetError(f"`{name}` is not UTF-8: byte {error.start} is {data[error.start]:02X}") from None


def loads(text: str | bytes) -> Model:
    """Reads a rule set from its text.

    Parameters
    ----------
    text
        A rule set in YAML, or in a format of another program: FIS (MATLAB), FLL (fuzzylite), FCL or FML. Bytes are UTF-8.

    Raises
    ------
    RuleSetError
        The text is not a valid rule set. ``findings`` contains all mistakes.

    Examples
    --------
    >>> import flagred
    >>> model = flagred.loads('''
    ... fuzzy: 1
    ... name: tip
    ... inputs:
    ...   service: {range: [0, 10], partition: [poor, good, excellent]}
    ...   food: {range: [0, 10], partition: [rancid, delicious]}
    ... outputs:
    ...   tip: {range: [0, 30], partition: [low, medium, high]}
    ... rules:
    ...   - IF service IS poor OR food IS rancid THEN tip IS low
    ...   - IF service IS good THEN tip IS medium
    ...   - IF service IS excellent OR food IS delicious THEN tip IS high
    ... ''')
    >>> round(model(8, 9), 2)
    18.39
    """
    if isinstance(text, (bytes, bytearray, memoryview)):
        text = _decoded(bytes(text), "<text>")
    if not isinstance(text, str):
        help_text = "`load` reads files, `loads` texts"
        raise DataError(f"`{type(text).__name__}` is not the text of a rule set\n  help: {help_text}")
    return _read(text, "<text>")


def load(path: str | os.PathLike[str] | IO[str] | IO[bytes]) -> Model:
    """Reads a rule set from a file.

    Parameters
    ----------
    path
        The file, or a file that is open for reading: YAML, FIS, FLL, FCL or FML, with any name. Or a built-in rule set:
        ``flagred``, ``flagred-battery`` or ``flagred-paper``. Such a name takes precedence over a file with this name.

    Raises
    ------
    RuleSetError
        The file is not a valid rule set. ``findings`` contains all mistakes.
    OSError
        The file cannot be read.
    """
    built_in = _built_in(path) if isinstance(path, str) else None
    if built_in is not None:
        return _read(built_in, str(path))
    if isinstance(path, (str, os.PathLike)):
        with open(path, "rb") as file:
            return _read(_decoded(file.read(), os.fspath(path)), os.fspath(path))
    if not hasattr(path, "read"):
        raise DataError(f"`{type(path).__name__}` is not a file\n  help: give a path or an open file")
    name = getattr(path, "name", "<file>")
    name = name if isinstance(name, str) else "<file>"
    data = path.read()
    return _read(data if isinstance(data, str) else _decoded(bytes(data), name), name)
