"""Pictures."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from .errors import DataError

if TYPE_CHECKING:
    from ._core import DecisionMap


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


def framed(page: str) -> str:
    """An HTML page within another: a frame isolates its styles."""
    from html import escape

    return f'<iframe srcdoc="{escape(page)}" style="width:100%;height:40em;border:0" sandbox="allow-scripts"></iframe>'


def plot_map(map: DecisionMap, ax: Any | None) -> Any:
    """Draws a map as a picture, or on axes of matplotlib."""
    if ax is None:
        return Picture(map.svg())
    axes = list(map.axes.items())
    if len(axes) > 2:
        raise DataError(f"a picture has one or two axes, but the map has {len(axes)}")
    ax.set_xlabel(axes[0][0])
    if len(axes) == 1:
        ax.plot(axes[0][1], map.values)
        ax.set_ylabel(map.output)
        return ax
    # Unknown values are blank.
    drawn = ax.pcolormesh(axes[0][1], axes[1][1], map.values.T, shading="nearest", cmap=_colours(map))
    ax.set_ylabel(axes[1][0])
    ax.figure.colorbar(drawn, ax=ax, label=map.output)
    return ax


def _colours(map: DecisionMap) -> str:
    """The colours of the output: pictures of risks are red, as those of the command line and of the page."""
    return "YlOrRd" if map.output == "risk" or map.output.endswith("_risk") else "viridis"


def plot_surface(map: DecisionMap, ax: Any | None) -> Any:
    """Draws a map as a surface: a picture, or on axes of matplotlib in three dimensions."""
    if ax is None:
        return Picture(map.svg("surface"))
    axes = list(map.axes.items())
    if len(axes) != 2:
        help_text = "give the other inputs a value: `model.surface(bill=80)`"
        raise DataError(f"a surface has two axes, but the map has {len(axes)}\n  help: {help_text}")
    if not hasattr(ax, "plot_surface"):
        raise DataError('the axes are flat\n  help: make them with `plt.subplot(projection="3d")`')
    (x_name, x), (y_name, y) = axes
    # Rows of matplotlib's arrays run along y.
    ax.plot_surface(x[None, :], y[:, None], map.values.T, cmap=_colours(map))
    ax.set_xlabel(x_name)
    ax.set_ylabel(y_name)
    ax.set_zlabel(map.output)
    return ax
