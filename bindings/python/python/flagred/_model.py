"""Rule sets."""

from __future__ import annotations

import os
from typing import Any

from ._core import RuleSet
from ._errors import RuleSetError
from ._picture import Picture

__all__ = ["Model", "load", "loads"]


class Model(RuleSet):
    """A fuzzy rule set: inputs and outputs with their terms, and rules between them.

    :func:`load` and :func:`loads` read one. A model is called like a function. It is compiled when it is first used,
    can be used by many threads at once, and is pickled and copied as data.
    """

    __slots__ = ()

    def __new__(cls, name: str, description: str | None = None) -> Model:
        model = super().__new__(cls, "fuzzy: 1\nname: _\ninputs: {}\noutputs: {}\nrules: []\n", "<model>", True)
        return model

    @property
    def name(self) -> str:
        """The name of the rule set."""
        return self._name()

    @property
    def text(self) -> str:
        """The text it was read from; after an edit, the rule set in YAML."""
        return self._text()[0]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the rule set in YAML.

        Parameters
        ----------
        path
            The file.
        """
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.to_yaml())

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
        """A model that is equal, and apart: an edit of one does not change the other."""
        other = Model(self.name)
        other._share(self)
        return other


def _read(text: str, file: str) -> Model:
    return RuleSet.__new__(Model, text, file, file == "<model>")


def loads(text: str) -> Model:
    """Reads a rule set from its text.

    Parameters
    ----------
    text
        A rule set in YAML, or in a format of another program: FIS (MATLAB), FLL (fuzzylite), FCL or FML.

    Raises
    ------
    RuleSetError
        The text is no rule set. All mistakes are told at once, in ``findings``.

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
    18.34
    """
    return _read(text, "<text>")


def load(path: str | os.PathLike[str]) -> Model:
    """Reads a rule set from a file.

    Parameters
    ----------
    path
        The file: YAML, FIS, FLL, FCL or FML, whatever its name.

    Raises
    ------
    RuleSetError
        The file is no rule set. All mistakes are told at once, in ``findings``.
    OSError
        The file cannot be read.
    """
    with open(path, "rb") as file:
        data = file.read()
    name = os.fspath(path)
    encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        raise RuleSetError(f"`{name}` is not UTF-8: byte {error.start} is {data[error.start]:02X}") from None
    return _read(text, name)
