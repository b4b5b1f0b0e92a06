"""Colours, marker shapes, fills and dashes: one solver looks the same in every figure."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

# Okabe and Ito (2008), safe for the common colour-vision deficiencies; yellow last, it is faint on white.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8A8A8A", "#D6C91F")


@dataclass(frozen=True)
class Shape:
    """A marker: its name in matplotlib and its outline as an SVG path in the square [-1, 1]^2."""

    matplotlib: str
    path: str


SHAPES = (
    Shape("o", "M1 0A1 1 0 1 1 -1 0A1 1 0 1 1 1 0Z"),
    Shape("s", "M-.88-.88H.88V.88H-.88Z"),
    Shape("^", "M0-1.1L1.05 .8H-1.05Z"),
    Shape("D", "M0-1.2L1.2 0L0 1.2L-1.2 0Z"),
    Shape("v", "M0 1.1L1.05-.8H-1.05Z"),
    Shape("P", "M-.4-1.1H.4V-.4H1.1V.4H.4V1.1H-.4V.4H-1.1V-.4H-.4Z"),
    Shape("p", "M0-1.1L1.05-.34L.65 .89H-.65L-1.05-.34Z"),
    Shape("h", "M0-1.1L.95-.55V.55L0 1.1L-.95 .55V-.55Z"),
    Shape("<", "M-1.1 0L.8-1.05V1.05Z"),
    Shape(">", "M1.1 0L-.8-1.05V1.05Z"),
)

# A formulation is told by the filled part of its marker and the dash of its line.
FILLS = ("full", "none", "left", "bottom")
DASHES = ((), (6, 3), (2, 2), (8, 2, 2, 2))


@dataclass(frozen=True)
class Look:
    """How one cell is drawn."""

    colour: str
    shape: int
    fill: str
    dash: tuple[int, ...]


def looks(cells: pd.DataFrame) -> dict[int, Look]:
    """The look of every cell: colour by solver, shape by variant, fill and dash by formulation of its surface."""
    solvers = sorted(cells["solver"].unique())
    variants = sorted(cells["variant"].unique())
    formulations = {surface: sorted(own.unique()) for surface, own in cells.groupby("surface")["formulation"]}
    return {
        cell.id: Look(
            colour=COLOURS[solvers.index(cell.solver) % len(COLOURS)],
            shape=variants.index(cell.variant) % len(SHAPES),
            **pattern(formulations[cell.surface].index(cell.formulation)),
        )
        for cell in cells.itertuples()
    }


def pattern(place: int) -> dict[str, object]:
    """Fill and dash number `place`: after every fill was used once, they meet the dashes in another order."""
    turn = place // len(FILLS)
    return {"fill": FILLS[place % len(FILLS)], "dash": DASHES[(place + turn) % len(DASHES)]}
