"""Pictures."""

from __future__ import annotations

import os


class Picture:
    """An SVG picture. Jupyter shows it; ``str()`` is its text."""

    __slots__ = ("svg",)

    svg: str
    """The text of the picture."""

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture to a file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.svg)

    def _repr_svg_(self) -> str:
        return self.svg

    def __str__(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"Picture({len(self.svg)} bytes of SVG)"
