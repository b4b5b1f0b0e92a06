"""The static figures (SVG and PDF) of every interactive one, drawn with matplotlib."""

from __future__ import annotations

import math
import re
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend must be chosen first)
import pandas as pd  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from .load import Store  # noqa: E402
from .statistics import INFINITE_BIN, ZERO_BIN, pareto_front, rule_of_three  # noqa: E402
from .style import SHAPES, Look  # noqa: E402

COLUMNS = 3  # panels side by side: a full text width of a paper
PANEL = (3.1, 2.6)  # inches
BAND = 10**0.7  # zero and infinity are drawn this factor beyond the finite values
RC = {
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.linewidth": 0.4,
    "grid.alpha": 0.5,
    "svg.hashsalt": "graze",  # the same store gives the same file
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
INK = "#333333"


def slug(text: str) -> str:
    """A file name for a surface's label."""
    return re.sub(r"[^A-Za-z0-9.-]+", "_", text).strip("_")


def panels(count: int) -> tuple[Figure, list[plt.Axes]]:
    """A grid of axes for `count` families."""
    columns = min(COLUMNS, count)
    rows = math.ceil(count / columns)
    figure, grid = plt.subplots(rows, columns, figsize=(PANEL[0] * columns, PANEL[1] * rows + 0.6), squeeze=False)
    axes = list(grid.flat)
    for axis in axes[count:]:
        axis.set_axis_off()
    return figure, axes[:count]


def legend(figure: Figure, rows: pd.DataFrame, looks: dict[int, Look], lines: bool) -> None:
    """One legend under all panels."""
    cells = rows.drop_duplicates("cell")
    handles = [
        plt.Line2D(
            [], [], color=looks[c.cell].colour, marker=SHAPES[looks[c.cell].shape].matplotlib, markersize=5,
            label=c.label, fillstyle=looks[c.cell].fill, linestyle=line_style(looks[c.cell]) if lines else "",
        )
        for c in cells.itertuples()
    ]  # fmt: skip
    below = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "ncol": COLUMNS}
    figure.legend(handles=handles, frameon=False, fontsize=7, **below)


def line_style(look: Look) -> str | tuple[int, tuple[int, ...]]:
    """The dash of a formulation."""
    return (0, look.dash) if look.dash else "-"


def save(figure: Figure, folder: Path, name: str) -> str:
    """Writes name.svg and name.pdf without dates, so that equal stores give equal files."""
    for axis in figure.axes:
        axis.minorticks_off()
    figure.tight_layout()
    # Measured once for both files: "tight" would draw the figure again for each.
    frame = figure.get_tightbbox(figure.canvas.get_renderer()).padded(0.1)
    figure.savefig(folder / f"{name}.svg", bbox_inches=frame, metadata={"Date": None})
    figure.savefig(folder / f"{name}.pdf", bbox_inches=frame, metadata={"CreationDate": None})
    plt.close(figure)
    return name


def banded(values: list[float], least: float) -> tuple[list[float], float, float]:
    """Values with zero and infinity moved to bands beyond the finite ones; the bands' positions."""
    finite = [v for v in values if 0 < v < math.inf] + [least]
    low, high = min(finite) / BAND, max(finite) * BAND
    return [low if v == 0 else high if math.isinf(v) else v for v in values], low, high


def error_time(
    rows: pd.DataFrame, looks: dict[int, Look], metric: str, label: str, folder: Path, name: str
) -> str | None:
    """Error against run time, a panel a family, with Pareto fronts and the spread of the repeats."""
    rows = rows[rows["ns_median"].notna() & rows[metric].notna()]
    if rows.empty:
        return None
    families = list(rows.groupby("family_name", sort=False))
    is_share = metric.endswith("_share")
    figure, axes = panels(len(families))
    for axis, (family, part) in zip(axes, families):
        least = rule_of_three(int(part["rays"].max())) if is_share else 1.0
        heights, low, high = banded(list(part[metric]), least)
        draw_points(axis, part, heights, looks)
        front = pareto_front(list(zip(part["ns_median"], part[metric])))
        xs, ys = part["ns_median"].iloc[front], [heights[i] for i in front]
        axis.step(xs, ys, where="post", color=INK, lw=0.8, ls=":", zorder=1)
        axis.set(xscale="log", yscale="log", title=family, xlabel="ns a ray (median)", ylabel=label)
        band_ticks(axis, list(part[metric]), (low, high), is_share, int(part["rays"].max()))
    legend(figure, rows, looks, lines=False)
    return save(figure, folder, name)


def draw_points(axis: plt.Axes, part: pd.DataFrame, heights: list[float], looks: dict[int, Look]) -> None:
    """Marker, whisker from the smallest to the 90th percentile of the repeats, and a cross where answers are wrong."""
    for row, height in zip(part.itertuples(), heights):
        look = looks[row.cell]
        axis.plot([row.ns_min, row.ns_p90], [height, height], color=look.colour, lw=1, zorder=2)
        axis.plot(
            row.ns_median, height, marker=SHAPES[look.shape].matplotlib, color=look.colour, markersize=6, zorder=3,
            fillstyle=look.fill, linestyle="",
        )  # fmt: skip
        if row.wrong > 0 or row.unsolved > 0:
            mark = "×" if row.wrong > 0 else "?"
            axis.annotate(mark, (row.ns_median, height), (4, 3), textcoords="offset points", fontsize=7, color=INK)


def band_ticks(axis: plt.Axes, values: list[float], bands: tuple[float, float], is_share: bool, rays: int) -> None:
    """Ticks at decades and at the bands of zero and infinity, which are shaded."""
    low, high = bands
    has_zero, has_infinite = 0 in values, any(math.isinf(v) for v in values)
    decades = range(math.ceil(math.log10(low * BAND)), (0 if is_share else math.floor(math.log10(high / BAND))) + 1)
    ticks = {10.0**k: f"{100 * 10.0**k:g} %" if is_share else f"$10^{{{k}}}$" for k in decades}
    if has_zero:
        ticks[low] = "none" if is_share else "0"
        axis.axhspan(low / 1.8, low * 1.8, color=INK, alpha=0.06, lw=0)
    if has_infinite:
        ticks[high] = "∞"
        axis.axhspan(high / 1.8, high * 1.8, color=INK, alpha=0.06, lw=0)
    axis.set_yticks(list(ticks), list(ticks.values()))
    top = high * 1.8 if has_infinite else 1.4 if is_share else high
    axis.set_ylim(low / (2.8 if has_zero else 1.0), top)
    if has_zero and is_share:
        text = f"none wrong of {rays}: below {100 * rule_of_three(rays):.2g} % (95 %)"
        axis.text(0.99, 0.01, text, transform=axis.transAxes, fontsize=6, color=INK, ha="right", va="bottom")


def stability(curves: pd.DataFrame, store: Store, looks: dict[int, Look], folder: Path, name: str) -> str | None:
    """Share of wrong rays against difficulty, a panel a family."""
    curves = curves[(curves["from"] > 0) & (curves["to"] < math.inf)]
    if curves.empty:
        return None
    knobs = store.families.set_index("name")["difficulty"]
    families = list(curves.groupby("family_name", sort=False))
    figure, axes = panels(len(families))
    for axis, (family, part) in zip(axes, families):
        for cell, curve in part.groupby("cell", sort=False):
            look = looks[cell]
            axis.plot(
                (curve["from"] * curve["to"]) ** 0.5, 100 * curve["wrong_share"], color=look.colour, lw=1,
                markersize=3, marker=SHAPES[look.shape].matplotlib, fillstyle=look.fill, linestyle=line_style(look),
            )  # fmt: skip
        axis.set(xscale="log", title=family, xlabel=knobs[family], ylabel="wrong rays, %")
        axis.set_ylim(bottom=-1)
    legend(figure, curves, looks, lines=True)
    return save(figure, folder, name)


def distributions(table: pd.DataFrame, looks: dict[int, Look], folder: Path, name: str) -> str | None:
    """Cumulative distribution of the error in condition units, a panel a family."""
    table = table[table["metric"] == "condition_units"]
    if table.empty:
        return None
    families = list(table.groupby("family_name", sort=False))
    figure, axes = panels(len(families))
    for axis, (family, part) in zip(axes, families):
        finite = part.loc[(part["bin"] != ZERO_BIN) & (part["bin"] != INFINITE_BIN), "below"]
        left, right = (finite.min() / 2, finite.max() * 2) if len(finite) else (0.5, 2.0)
        for cell, curve in part[part["bin"] != INFINITE_BIN].groupby("cell", sort=False):
            look = looks[cell]
            xs = [max(x, left) for x in curve["below"]] + [right]
            ys = [100 * y for y in curve["share"]]
            place = (len(axis.lines) + 1) * len(ys) // (part["cell"].nunique() + 1)  # one marker, elsewhere on each curve
            axis.step(
                xs, ys + ys[-1:], where="post", color=look.colour, lw=1, linestyle=line_style(look), markersize=4,
                marker=SHAPES[look.shape].matplotlib, fillstyle=look.fill, markevery=[min(place, len(ys) - 1)],
            )  # fmt: skip
        axis.set(xscale="log", title=family, xlabel="error, condition units", ylabel="rays with a hit, %", ylim=(0, 102))
    legend(figure, table, looks, lines=True)
    return save(figure, folder, name)


def heat_map(rows: pd.DataFrame, folder: Path, name: str) -> str:
    """Share of wrong rays, cells by families."""
    grid = rows.pivot_table(index="label", columns="family_name", values="wrong_share", sort=False)
    figure, axis = plt.subplots(figsize=(0.62 * len(grid.columns) + 2.6, 0.28 * len(grid) + 0.9))
    shown = grid.map if hasattr(grid, "map") else grid.applymap
    axis.imshow(shown(heat), cmap="Oranges", vmin=0, vmax=1.25, aspect="auto")
    axis.set_xticks(range(len(grid.columns)), grid.columns, rotation=40, ha="right")
    axis.set_yticks(range(len(grid)), grid.index)
    axis.grid(False)
    for i, line in enumerate(grid.to_numpy()):
        for j, share in enumerate(line):
            text = "" if math.isnan(share) else "0" if share == 0 else f"{100 * share:.2g}"
            axis.text(j, i, text, ha="center", va="center", fontsize=6.5)
    axis.set_title("wrong rays, %")
    return save(figure, folder, name)


def heat(share: float) -> float:
    """Depth of colour of a share: its logarithm from 0.01 % (pale) to 100 %, so that rare errors are seen."""
    return 0.0 if not share > 0 else max(0.08, 1 + math.log10(share) / 4)


def cost(rows: pd.DataFrame, looks: dict[int, Look], folder: Path, name: str) -> str:
    """Evaluations a ray of every cell: one mark a family, so that the spread over families shows."""
    labels = list(rows["label"].unique())
    figure, axis = plt.subplots(figsize=(5.2, 0.26 * len(labels) + 0.9))
    for row in rows.itertuples():
        look = looks[row.cell]
        axis.plot(
            row.evaluations_per_ray, labels.index(row.label), marker=SHAPES[look.shape].matplotlib, color=look.colour,
            markersize=5, fillstyle=look.fill, linestyle="",
        )  # fmt: skip
    axis.set_xscale("symlog", linthresh=1)
    axis.set_xlim(0, 10 ** math.ceil(math.log10(max(rows["evaluations_per_ray"].max(), 1)) + 0.1))
    axis.set_yticks(range(len(labels)), labels)
    axis.invert_yaxis()
    axis.set_xlabel("evaluations a ray, one mark a family")
    return save(figure, folder, name)
