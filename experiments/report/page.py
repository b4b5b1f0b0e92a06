"""Puts the report together: CSV tables, static figures, and one self-contained HTML page."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from . import figures, findings, tables
from .load import Store
from .statistics import rule_of_three
from .style import SHAPES, looks

TEMPLATES = Path(__file__).resolve().parent / "templates"
CHART_LIBRARY = Path("/usr/share/javascript/chart.js/chart.min.js")  # Debian's libjs-chart.js
WORST_SHOWN = 60  # rows of the page's table of worst rays; the CSV has all that were read

# Fields of a result row that the page's scripts need.
PAGE_FIELDS = (
    ["cell", "family", "rays", "wrong", "ambiguous_wrong", "missed", "spurious", "wrong_first", "uncertain", "failed"]
    + ["unsolved", "inexcusable", "ns_median", "ns_min", "ns_p90", "repeats", "censored", "query"]
    + ["evaluations_per_ray", "iterations_per_ray", "starts_per_ray"]
    + [f"{name}_share" for name in ("wrong", "inexcusable", "unsolved", "wrong_first")]
    + [f"{metric}_{q}" for metric in tables.METRICS for q in ("p50", "p99", "worst")]
)
CURVE_FIELDS = [
    "cell", "family", "from", "to", "records", "rays",
    "wrong_share", "inexcusable_share", "unsolved_share", "condition_units_p50", "condition_units_p99",
]  # fmt: skip


class MissingLibrary(Exception):
    """The charting library is not installed."""


@dataclass(frozen=True)
class Tables:
    """The tables that page, CSV and figures share."""

    results: pd.DataFrame
    curves: pd.DataFrame
    remarks: list[str]
    distributions: pd.DataFrame
    worst: pd.DataFrame
    best: pd.DataFrame
    formulations: pd.DataFrame
    sentences: list[findings.Finding]


def write_report(store: Store, out: Path) -> Path:
    """Writes everything under `out` and returns the page's path. Raises OSError, MissingLibrary."""
    library = chart_library()
    data = gather(store)
    (out / "csv").mkdir(parents=True, exist_ok=True)
    (out / "figures").mkdir(exist_ok=True)
    write_csv(store, data, out / "csv")
    drawn = draw_figures(store, data, out / "figures")
    html = render(store, data, drawn, library)

    # The page appears whole or not at all, even when an earlier one is being read.
    page = out / "index.html"
    draft = out / "index.html.part"
    draft.write_text(html, encoding="utf-8")
    os.replace(draft, page)
    return page


def chart_library() -> str:
    """The source of Chart.js, safe inside a script element."""
    if not CHART_LIBRARY.is_file():
        raise MissingLibrary
    return CHART_LIBRARY.read_text(encoding="utf-8").replace("</script", "<\\/script")


def gather(store: Store) -> Tables:
    """All tables, once."""
    results = tables.results(store)
    curves, remarks = tables.stability(store)
    best = findings.best_by_family(results)
    sentences = [] if results.empty else findings.findings(store, results, curves)
    lost = tables.formulations(results)
    return Tables(results, curves, remarks, tables.distributions(store), tables.worst_rays(store), best, lost, sentences)


def named(data: Tables, table: pd.DataFrame) -> pd.DataFrame:
    """A table of (cell, family, ...) with the names of both in front."""
    labels = data.results[["cell", "family", "surface", "family_name", "label"]]
    merged = labels.merge(table, on=["cell", "family"])
    return merged


def write_csv(store: Store, data: Tables, folder: Path) -> None:
    """Every table as CSV; infinite values read `inf`."""
    identity = ["surface", "family_name", "solver", "options", "formulation", "precision", "certified", "rays"]
    counted = [name for name in tables.SHARES if name in data.results]
    bounds = [f"{name}_{part}" for name in counted for part in ("share", "low", "high")]
    timing = ["ns_median", "ns_min", "ns_p90", "repeats", "timed_rays", "query", "censored"]
    quantiles = [f"{m}_{q}" for m in tables.METRICS for q in ("count", "p50", "p99", "worst")]
    costs = [f"{name}{part}" for name in ("evaluations", "iterations", "starts") for part in ("", "_per_ray")]
    wrong = ["wrong", "wrong_share", "wrong_low", "wrong_high"]
    pieces = {
        "error_time": data.results[identity + wrong + quantiles + timing],
        "verdicts": data.results[identity + ["right", "ambiguous_wrong"] + counted + bounds],
        "formulations": data.formulations,
        "heat_map": data.results.astype({"wrong_share": float}).pivot_table(
            index=["surface", "label"], columns="family_name", values="wrong_share", sort=False
        ).reset_index(),
        "counters_and_times": data.results[identity + costs + timing],
        "stability": named(data, data.curves).drop(columns=["cell", "family"]),
        "error_distribution": named(data, data.distributions).drop(columns=["cell", "family"]),
        "timing_repeats": named(data, store.timing).drop(columns=["cell", "family", "build"]),
        "worst_rays": data.worst.drop(columns=["cell", "family", "place", "truth", "hits"], errors="ignore"),
        "best_by_family": data.best,
        "findings": pd.DataFrame([vars(f) for f in data.sentences], columns=["surface", "kind", "text"]),
        "left_out": store.skipped,
        "notes": store.notes[["pass", "text"]],
    }
    for name, table in pieces.items():
        table.to_csv(folder / f"{name}.csv", index=False)


def draw_figures(store: Store, data: Tables, folder: Path) -> dict[str, list[str]]:
    """Draws every figure for every surface; returns the file stems by kind of figure."""
    drawn: dict[str, list[str]] = {"error_time": [], "stability": [], "heat_map": [], "distribution": [], "cost": []}
    look = looks(store.cells)
    curves, spread = named(data, data.curves), named(data, data.distributions)
    wrong, units = "wrong rays", "99th percentile, condition units"
    with figures.plt.rc_context(figures.RC):
        for surface, rows in data.results.groupby("surface", sort=False):
            tail = figures.slug(surface)
            own_curves, own_spread = curves[curves["surface"] == surface], spread[spread["surface"] == surface]
            drawn["error_time"] += [
                figures.error_time(rows, look, "wrong_share", wrong, folder, f"error_time_wrong_{tail}"),
                figures.error_time(rows, look, "condition_units_p99", units, folder, f"error_time_p99_{tail}"),
            ]
            drawn["stability"].append(figures.stability(own_curves, store, look, folder, f"stability_{tail}"))
            drawn["heat_map"].append(figures.heat_map(rows, folder, f"heat_map_{tail}"))
            drawn["distribution"].append(figures.distributions(own_spread, look, folder, f"distribution_{tail}"))
            drawn["cost"].append(figures.cost(rows, look, folder, f"cost_{tail}"))
    return {kind: [name for name in names if name] for kind, names in drawn.items()}


def plain(value: object) -> object:
    """A value JSON can hold: infinities as 'inf', NaN and absent values as null, floats to 5 digits."""
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float):
        if math.isnan(value):
            return None
        return "inf" if math.isinf(value) else float(f"{value:.5g}")
    return value


def rows_of(table: pd.DataFrame, columns: list[str]) -> list[list[object]]:
    """The table's rows as lists, in the order of `columns`."""
    return [[plain(value) for value in row] for row in table[columns].itertuples(index=False)]


def script_data(store: Store, data: Tables) -> dict[str, object]:
    """What the page's scripts draw from."""
    look = looks(store.cells)
    surface_of = store.surfaces.set_index("id")["label"]
    cells = [
        {
            "id": int(c.id), "label": c.label, "surface": surface_of[c.surface], "variant": c.variant,
            "formulation": c.formulation, "certified": bool(c.certified), **vars(look[c.id]),
        }
        for c in store.cells.itertuples()
    ]  # fmt: skip
    families = [
        {"id": int(f.id), "name": f.name, "summary": f.summary, "knob": f.difficulty}
        for f in store.families.itertuples(index=False)
    ]
    return {
        "shapes": [shape.path for shape in SHAPES],
        "cells": cells,
        "families": families,
        "fields": list(PAGE_FIELDS),
        "rows": rows_of(data.results, list(PAGE_FIELDS)),
        "smallestBin": findings.SMALLEST_BIN,
        "curveFields": CURVE_FIELDS,
        "curves": rows_of(data.curves, CURVE_FIELDS),
        "bins": rows_of(data.distributions, ["cell", "family", "metric", "bin", "count"]),
    }


def embedded(value: object) -> Markup:
    """JSON for a script element: no `<` can end it."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return Markup(text.replace("<", "\\u003c"))


def run_facts(store: Store) -> list[tuple[str, str]]:
    """Machine, build and sampling, as pairs of term and text."""
    build, meta = store.build, store.meta
    facts = [
        ("Machine", f"{build['cpu']}, {build['cores']} cores, {build['system']}"),
        ("Build", f"graze {build['version']}, commit {build['git_commit']}"),
        ("Compiler", f"{build['compiler']}, {build['flags']}, instruction set {build['instruction_set']}"),
        ("Started", str(build["started"])),
        ("Finished", meta.get("finished", "not finished")),
        ("Seed", meta.get("seed", "not stated")),
        ("Match radius", meta.get("match_radius", "not stated")),
        ("Records", record_rule(store)),
    ]
    if len(store.builds) > 1:
        held = f"the store holds {len(store.builds)} builds"
        text = f"{held}; this page shows number {build['id']}, the latest with results"
        facts.insert(2, ("Builds", text))
    return facts


def record_rule(store: Store) -> str:
    """The rule that decides which records are kept, and what it did here."""
    kept, asked = int(store.kept["count"].sum()), int(store.tally["rays"].sum())
    rule = f"keep_all = {store.meta['keep_all']}; " if "keep_all" in store.meta else ""
    if kept >= asked:
        return f"{rule}all {findings.count(kept, 'record')} kept"
    return (
        f"{rule}thinned: {findings.count(kept, 'record')} of {findings.count(asked, 'answer')} kept (every wrong, "
        "unsolved and worst one, and a seeded sample); counts and histograms cover all answers"
    )


def ray_counts(data: Tables) -> list[tuple[str, list[tuple[str, int]]]]:
    """For each surface its families and their rays."""
    return [
        (surface, [(family, int(part["rays"].max())) for family, part in rows.groupby("family_name", sort=False)])
        for surface, rows in data.results.groupby("surface", sort=False)
    ]


def heat_maps(data: Tables) -> list[dict[str, object]]:
    """One heat map a surface: its families and, for each cell, a result row for each family or None."""
    maps = []
    for surface, rows in data.results.groupby("surface", sort=False):
        order = list(rows["family_name"].unique())
        lines = []
        for _, cell in rows.groupby("cell"):
            by_family = {row.family_name: row for row in cell.itertuples()}
            lines.append((cell.iloc[0], [by_family.get(name) for name in order]))
        maps.append({"surface": surface, "families": order, "lines": lines})
    return maps


def formulation_tables(data: Tables) -> list[dict[str, object]]:
    """One table a surface: a column a formulation and solver, in the surface's order, and a line a family."""
    made = []
    for surface, rows in data.formulations.groupby("surface", sort=False):
        columns = rows.drop_duplicates(["place", "variant"]).sort_values("place", kind="stable")
        keys = list(zip(columns["place"], columns["variant"]))
        lines = []
        for family, part in rows.groupby("family_name", sort=False):
            by_key = {(row.place, row.variant): row for row in part.itertuples()}
            lines.append((family, int(part["rays"].max()), [by_key.get(key) for key in keys]))
        spans = [(name, len(group)) for name, group in columns.groupby("formulation", sort=False)]
        made.append({"surface": surface, "spans": spans, "columns": list(columns.itertuples()), "lines": lines})
    return made


def environment() -> Environment:
    """Jinja with everything escaped, and the formats that the template uses."""
    jinja = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    jinja.filters.update(
        percent=lambda x: findings.percent(x),
        ns=lambda x: findings.nanoseconds(x) if known(x) else "—",
        short=lambda x: "—" if not known(x) else "∞" if math.isinf(x) else f"{x:.3g}",
        heat=figures.heat,
        upper=rule_of_three,
    )
    jinja.tests["known"] = known
    return jinja


def known(value: object) -> bool:
    """False for absent values and NaN."""
    return value is not None and value == value


def render(store: Store, data: Tables, drawn: dict[str, list[str]], library: str) -> str:
    """The page as text."""
    jinja = environment()
    return jinja.get_template("report.html.j2").render(
        title=store.meta.get("title") or store.meta.get("name") or "Untitled run",
        abstract=findings.abstract(store, data.results),
        facts=run_facts(store),
        ray_counts=ray_counts(data),
        missing=store.missing,
        alarms=[f for f in data.sentences if f.kind == "alarm"],
        sentences=[f for f in data.sentences if f.kind != "alarm"],
        best=list(data.best.itertuples()),
        rows=list(data.results.itertuples()),
        heat_maps=heat_maps(data),
        formulation_tables=formulation_tables(data),
        surfaces=list(data.results["surface"].unique()),
        families=store.families[store.families["id"].isin(data.results["family"])].to_dict("records"),
        variants=sorted(data.results["variant"].unique()),
        formulations=sorted(data.results["formulation"].unique()),
        remarks=data.remarks,
        smallest_bin=findings.SMALLEST_BIN,
        has_curves=not data.curves.empty,
        has_times=not store.timing.empty,
        worst=list(data.worst.head(WORST_SHOWN).itertuples()),
        worst_count=len(data.worst),
        skipped=store.skipped.to_dict("records"),
        notes=store.notes.to_dict("records"),
        command=store.meta.get("command", "graze sweep CONFIG.toml --out DIR"),
        report_command=f"graze report {store.path.parent}",
        config=store.meta.get("config", ""),
        config_path=store.meta.get("config_path", ""),
        drawn=drawn,
        css=Markup((TEMPLATES / "report.css").read_text(encoding="utf-8")),
        js=Markup((TEMPLATES / "report.js").read_text(encoding="utf-8")),
        library=Markup(library),
        data=embedded(script_data(store, data)),
    )
