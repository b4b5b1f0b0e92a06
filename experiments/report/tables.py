"""The tables behind the page: one row a (cell, family), stability curves, error distributions, worst rays."""

from __future__ import annotations

import json
import math
import re
from graphlib import CycleError, TopologicalSorter

import pandas as pd

from .load import COUNTS, VERDICTS, Store
from .statistics import (
    bins_per_decade,
    histogram_quantile,
    median,
    nearest_rank,
    strata_weights,
    upper_edge,
    weighted_quantile,
    wilson,
)

METRICS = ("condition_units", "ulps", "backward", "normal_error")
QUANTILES = {"p50": 0.5, "p99": 0.99, "worst": 1.0}
# Types whose parameters are lengths, every one.
LENGTHS_ONLY = ("teardrop", "bezier_revolution", "sphere", "torus", "box", "triangle", "polygon", "tetrahedron")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d[\d.]*(?:[eE][-+]?\d+)?")
TRUTH_DIGITS = 20  # characters of a true l in the table: beyond double's 17 digits, short enough to read
SHARES = ("wrong", "inexcusable", "missed", "spurious", "wrong_first", "uncertain", "failed", "unsolved")


def names(store: Store) -> pd.DataFrame:
    """Pairs (cell, family) that have rays, with the names a reader knows them by."""
    surface_of = store.surfaces.set_index("id")["label"]
    cells = store.cells.rename(columns={"id": "cell"})
    cells["surface_id"], cells["surface"] = cells["surface"], cells["surface"].map(surface_of)
    columns = [
        "cell", "surface_id", "surface", "label", "solver", "options", "variant", "formulation", "form", "precision",
        "certified",
    ]  # fmt: skip
    pairs = store.tally[["cell", "family"]].merge(cells[columns], on="cell")
    family = store.families.rename(columns={"id": "family", "name": "family_name"})[["family", "family_name"]]
    return pairs.merge(family, on="family").sort_values(["surface_id", "family", "cell"], ignore_index=True)


def verdicts(store: Store) -> pd.DataFrame:
    """Counts of every verdict with shares and Wilson 95 % intervals.

    `inexcusable`: wrong on a ray whose true verdict stands under one-ulp moves; `unsolved`: any verdict but right.
    """
    table = store.tally[["cell", "family", "blocks", *COUNTS]].copy()
    table["inexcusable"] = table["wrong"] - table["ambiguous_wrong"]
    table["unsolved"] = table["rays"] - table["right"]
    for name in SHARES:
        bounds = [wilson(k, n) for k, n in zip(table[name], table["rays"])]
        table[f"{name}_share"] = table[name] / table["rays"]
        table[f"{name}_low"] = [low for low, _ in bounds]
        table[f"{name}_high"] = [high for _, high in bounds]
    for name in ("evaluations", "iterations", "starts"):
        table[f"{name}_per_ray"] = table[name] / table["rays"]
    return table


def errors(store: Store) -> pd.DataFrame:
    """Median, 99th percentile and worst of each metric, read at the upper edges of the histogram's bins."""
    rows: dict[tuple[int, int], dict[str, float | None]] = {}
    for (cell, family, metric), group in store.histogram.groupby(["cell", "family", "metric"]):
        row = rows.setdefault((cell, family), {"cell": cell, "family": family})
        bins = list(zip(group["bin"], group["count"]))
        row[f"{metric}_count"] = int(group["count"].sum())
        row.update({f"{metric}_{name}": histogram_quantile(bins, q) for name, q in QUANTILES.items()})
    columns = ["cell", "family"] + [f"{m}_{q}" for m in METRICS for q in ("count", *QUANTILES)]
    return pd.DataFrame(list(rows.values()), columns=columns)


def times(store: Store) -> pd.DataFrame:
    """Median, smallest and 90th percentile of the repeats of the timing pass, in ns a ray."""
    rows = [
        {
            "cell": cell,
            "family": family,
            "ns_median": median(list(group["ns_per_ray"])),
            "ns_min": min(group["ns_per_ray"]),
            "ns_p90": nearest_rank(list(group["ns_per_ray"]), 0.9),
            "repeats": len(group),
            "timed_rays": int(group["rays"].max()),
            "query": group["query"].iloc[0],
            "censored": int((group["censored"] != 0).sum()),
        }
        for (cell, family), group in store.timing.groupby(["cell", "family"])
    ]
    columns = ["cell", "family", "ns_median", "ns_min", "ns_p90", "repeats", "timed_rays", "query", "censored"]
    return pd.DataFrame(rows, columns=columns)


def results(store: Store) -> pd.DataFrame:
    """Everything known of each (cell, family), in one row."""
    pair = ["cell", "family"]
    table = names(store).merge(verdicts(store), on=pair)
    return table.merge(errors(store), on=pair, how="left").merge(times(store), on=pair, how="left")


def formulation_order(rows: pd.DataFrame) -> list[str]:
    """The formulations of one surface in the surface's own order, the preferred one first.

    The store lists the cells of a solver in that order: the order of all of them is a merge of these chains.
    """
    after: dict[str, list[str]] = {name: [] for name in rows.sort_values("cell")["formulation"].unique()}
    for _, chain in rows.sort_values("cell").groupby(["variant"], sort=False)["formulation"]:
        names_ = list(chain.unique())
        for earlier, later in zip(names_, names_[1:]):
            after[later].append(earlier)
    try:
        return list(TopologicalSorter(after).static_order())
    except CycleError:  # cells that were added by a later run of another build may stand in any order
        return list(after)


def formulations(table: pd.DataFrame) -> pd.DataFrame:
    """What each formulation costs in right answers: one row a (surface, family, formulation, solver).

    `place` counts a surface's formulations in its own order from 1. A wrong answer on a ray whose true verdict a
    one-ulp change flips is `wrong_ambiguous`, any other `wrong_unambiguous`.
    """
    columns = [
        "surface", "family_name", "place", "of", "formulation", "solver", "options", "precision", "variant", "rays",
        "right", "wrong_unambiguous", "wrong_ambiguous", "uncertain", "failed",
    ]  # fmt: skip
    parts = []
    for _, rows in table.groupby("surface", sort=False):
        order = formulation_order(rows)
        place = rows["formulation"].map(lambda name, order=order: order.index(name) + 1)
        parts.append(rows.assign(place=place, of=len(order)))
    whole = pd.concat(parts) if parts else table.assign(place=0, of=0)
    whole = whole.rename(columns={"inexcusable": "wrong_unambiguous", "ambiguous_wrong": "wrong_ambiguous"})
    return whole.sort_values(["surface_id", "family", "place", "cell"], ignore_index=True)[columns]


def record_weights(store: Store) -> tuple[dict[tuple[int, int, str], float], set[tuple[int, int]]]:
    """Weight of a sampled record by (cell, family, verdict), and the pairs whose records cannot stand for their rays.

    Records kept for a reason count once; the sampled ones stand for the rays of their verdict that have no record.
    """
    counts = store.kept.set_index(["cell", "family", "verdict", "sampled"])["count"].to_dict()
    weights, unusable = {}, set()
    for row in store.tally.itertuples():
        for verdict in VERDICTS:
            key = (row.cell, row.family, verdict)
            total = int(store.tally.at[row.Index, verdict])
            weight = strata_weights(total, counts.get((*key, 0), 0), counts.get((*key, 1), 0))
            if weight is None:
                unusable.add((row.cell, row.family))
            weights[key] = weight or 0.0
    return weights, unusable


def stability(store: Store) -> tuple[pd.DataFrame, list[str]]:
    """Wrong share and error against difficulty, in bins of log10 |difficulty|, and the remarks a reader must see.

    Each bin states its records and the rays that they stand for. Difficulty 0 has a bin of its own (NaN edges).
    """
    columns = [
        "cell", "family", "from", "to", "records", "rays",
        "wrong_share", "inexcusable_share", "unsolved_share", "condition_units_p50", "condition_units_p99",
    ]  # fmt: skip
    weights, unusable = record_weights(store)
    usable = [pair not in unusable for pair in zip(store.records["cell"], store.records["family"])]
    records = store.records[usable].copy()
    remarks = stability_remarks(store, weights, unusable)
    if records.empty:
        return pd.DataFrame(columns=columns), remarks
    keys = zip(records["cell"], records["family"], records["verdict"], records["sampled"])
    records["weight"] = [weights.get((c, f, v), 0.0) if sampled else 1.0 for c, f, v, sampled in keys]
    rows = []
    for family, group in records.groupby("family"):
        per_decade, bin_ = difficulty_bins(group["difficulty"])
        for (cell, index), part in group.groupby(["cell", bin_]):
            rows.append({"cell": cell, "family": family, **edges(index, per_decade), **bin_summary(part)})
    table = pd.DataFrame(rows, columns=columns)
    return table.sort_values(["family", "cell", "from"], na_position="first", ignore_index=True), remarks


def stability_remarks(store: Store, weights: dict, unusable: set) -> list[str]:
    """How the curves were made from the records."""
    remarks = []
    if any(weight > 1 for weight in weights.values()):
        remarks.append(
            "Records are thinned: kept records count once, and each sampled one stands for the rays of its verdict "
            "that have no record, so shares and quantiles are estimates."
        )
    elif not store.kept.empty:
        remarks.append("Every ray has its record: the curves use all of them, unweighted.")
    if unusable:
        remarks.append(f"{len(unusable)} pairs of cell and family have no sample of their rays and are not drawn.")
    return remarks


def difficulty_bins(difficulty: pd.Series) -> tuple[int, pd.Series]:
    """Bins a decade, and the bin of every ray: floor(bins log10 |difficulty|), -inf where it is 0."""
    logs = difficulty.abs().map(lambda d: math.log10(d) if d > 0 else -math.inf)
    finite = logs[(logs > -math.inf) & (logs < math.inf)]
    per_decade = bins_per_decade(finite.max() - finite.min() if len(finite) else 0.0)
    # The 1e-9 keeps a difficulty of exactly 10^k, whose logarithm is rounded, in the bin that starts there.
    return per_decade, logs.map(lambda x: x if math.isinf(x) else math.floor(x * per_decade + 1e-9))


def edges(index: float, per_decade: int) -> dict[str, float]:
    """The bin's edges in units of difficulty."""
    if math.isinf(index):
        value = 0.0 if index < 0 else math.inf
        return {"from": value, "to": value}
    return {"from": power_of_ten(index / per_decade), "to": power_of_ten((index + 1) / per_decade)}


def power_of_ten(exponent: float) -> float:
    """10^exponent, infinite beyond the range of double."""
    return 10.0**exponent if exponent < 308.25 else math.inf


def bin_summary(part: pd.DataFrame) -> dict[str, float | None]:
    """Shares and error quantiles of the records of one bin."""
    weight = part["weight"]
    rays = float(weight.sum())
    wrong = part["verdict"] == "wrong"

    def share(chosen: pd.Series) -> float | None:
        return float(weight[chosen].sum()) / rays if rays > 0 else None

    values, measured = list(part["condition_units"]), list(weight)
    return {
        "records": len(part),
        "rays": rays,
        "wrong_share": share(wrong),
        "inexcusable_share": share(wrong & (part["ambiguous"] == 0)),
        "unsolved_share": share(part["verdict"] != "right"),
        "condition_units_p50": weighted_quantile(values, measured, 0.5),
        "condition_units_p99": weighted_quantile(values, measured, 0.99),
    }


def distributions(store: Store) -> pd.DataFrame:
    """Cumulative distribution of every metric: share of the rays whose error lies below the bin's upper edge."""
    pair = ["cell", "family", "metric"]
    table = store.histogram.sort_values([*pair, "bin"], ignore_index=True)
    table["below"] = table["bin"].map(upper_edge)
    counts = table.astype({"count": float}).groupby(pair)["count"]
    table["share"] = counts.cumsum() / counts.transform("sum")
    return table


def worst_rays(store: Store) -> pd.DataFrame:
    """The worst wrong records on rays that are not ambiguous, least excusable first, as lines to paste."""
    cells = store.cells.set_index("id")
    surfaces = store.surfaces.set_index("id")
    family_of = store.families.set_index("id")["name"]
    table = store.worst.copy()
    table["asked"] = [
        scaled_surface(surfaces.at[row.surface, "label"], surfaces.at[row.surface, "type"], row.scale)
        for row in table.itertuples()
    ]
    table["ray"] = [ray_line(row) for row in table.itertuples()]
    table["truth_l"] = table["truth"].map(truth_text)
    table["answer_l"] = table["hits"].map(answer_text)
    table["surface"] = table["surface"].map(surfaces["label"])
    table["family_name"] = table["family"].map(family_of)
    for column in ("label", "variant", "solver", "options", "formulation", "precision", "certified"):
        table[column] = table["cell"].map(cells[column])
    table["command"] = [solve_command(row) for row in table.itertuples()]
    order = ["certified", "place", "wrong_first", "condition"]
    return table.sort_values(order, ascending=[False, True, False, True], ignore_index=True)


def ray_line(row: object) -> str:
    """The ray as one JSON line of hex floats, as `graze solve` and `graze truth` read it."""
    line = {"o": [row.ox, row.oy, row.oz], "d": [row.dx, row.dy, row.dz]}
    return json.dumps(line, separators=(",", ":"))


def scaled_surface(label: str, type_: str, scale: float) -> str | None:
    """The surface that the ray was asked of: its lengths times `scale`. None where a number may not be a length."""
    if scale == 1:
        return label
    if type_ not in LENGTHS_ONLY:
        return None
    name, _, parameters = label.partition(":")
    return f"{name}:" + NUMBER.sub(lambda number: repr(float(number[0]) * scale), parameters)


def solve_command(row: object) -> str:
    """The command that asks the cell again; its ray comes on stdin."""
    if row.asked is None:
        return f"# {row.surface}, its lengths multiplied by {row.scale!r}: {row.ray}"
    precision = "" if row.precision == "double" else f" --precision {row.precision}"
    solver = f"'{row.solver}:{row.options}'" if row.options else row.solver
    return (
        f"echo '{row.ray}' | graze solve --surface '{row.asked}' --solver {solver} "
        f"--formulation {row.formulation} --query all{precision}"
    )


def cut(decimal: str) -> str:
    """A decimal without the digits that the table has no room for; its exponent stays."""
    digits, mark, exponent = decimal.partition("e")
    return digits[:TRUTH_DIGITS] + mark + exponent


def truth_text(text: str) -> str:
    """The true hits, cut to a readable length; a touching hit says so."""
    try:
        hits = json.loads(text)
    except ValueError:
        return text
    shown = [f"{cut(str(h.get('l')))}{' (touches)' if h.get('multiplicity', 1) > 1 else ''}" for h in hits]
    return ", ".join(shown) or "no hit"


def answer_text(text: str) -> str:
    """The reported hits as decimals that round-trip."""
    try:
        return ", ".join(repr(float.fromhex(word)) for word in text.split()) or "no hit"
    except (ValueError, OverflowError):
        return text
