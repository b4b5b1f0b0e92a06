"""Sentences drawn from the numbers by rules. No claim is written down before the numbers are known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import pandas as pd

from .load import EXAMPLES, Store, some
from .statistics import rule_of_three, wilson

# A bin with fewer records says nothing: Wilson's interval of 10 rays is already 0 to 28 % when none is wrong.
SMALLEST_BIN = 10
# Repeats that spread further than this (p90 over smallest) leave cells of similar speed indistinguishable.
WIDE_SPREAD = 1.25


@dataclass(frozen=True)
class Finding:
    """A sentence and its kind: alarm (a broken promise), bad, good or plain."""

    kind: str
    text: str
    surface: str = ""


def percent(share: float) -> str:
    """A share in %, three significant digits, unbroken."""
    return f"{100 * share:.3g}\u00a0%"


def nanoseconds(value: float) -> str:
    """A time in the unit that reads best."""
    for limit, scale, unit in ((1e3, 1.0, "ns"), (1e6, 1e3, "µs"), (1e9, 1e6, "ms")):
        if value < limit:
            return f"{value / scale:.3g}\u00a0{unit}"
    return f"{value / 1e9:.3g}\u00a0s"


def count(number: int, noun: str, plural: str = "") -> str:
    """A number with its noun in the right form; a narrow space groups the digits."""
    grouped = f"{number:,}".replace(",", "\u202f")
    return f"{grouped} {noun if number == 1 else plural or noun + 's'}"


def listed(words: Iterable[str]) -> str:
    """a, b and c."""
    words = list(words)
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def certified_promise(table: pd.DataFrame) -> Iterator[Finding]:
    """Cells that claim proved answers must not be wrong; a wrong one comes first in the page."""
    claims = table[table["certified"] == 1]
    for label, cell in claims[claims["wrong"] > 0].groupby("label", sort=False):
        wrong, excusable = int(cell["wrong"].sum()), int(cell["ambiguous_wrong"].sum())
        where = listed(f"{r.family_name} ({r.wrong} of {r.rays})" for r in cell.itertuples() if r.wrong)
        yield Finding(
            "alarm",
            f"{label} claims proved answers and gave {count(wrong, 'wrong answer')} ({excusable} of them ambiguous): "
            f"{where}. Its claim does not hold.",
        )
    kept = claims.groupby("label").filter(lambda cell: cell["wrong"].sum() == 0)
    if not kept.empty:
        rays, open_ = int(kept["rays"].sum()), int(kept["unsolved"].sum())
        yield Finding(
            "good",
            f"{count(kept['label'].nunique(), 'cell')} with proved answers kept the promise: none of "
            f"{count(rays, 'answer')} was wrong (share below {percent(rule_of_three(rays))} with 95\u00a0% confidence); "
            f"{percent(open_ / rays)} of the rays stayed undecided.",
        )


def safe_cells(table: pd.DataFrame) -> pd.DataFrame:
    """Cells that were asked every family of their surface, were never wrong and have a full time for each."""
    families = table["family"].nunique()

    def is_safe(cell: pd.DataFrame) -> bool:
        is_timed = cell["ns_median"].notna().all() and cell["censored"].sum() == 0
        return bool(len(cell) == families and cell["wrong"].sum() == 0 and is_timed)

    sums = (
        table.groupby("label")
        .filter(is_safe)
        .groupby("label")
        .agg(
            total=("ns_median", "sum"),
            fastest=("ns_median", "min"),
            slowest=("ns_median", "max"),
            unsolved=("unsolved", "sum"),
        )
    )
    return sums.sort_values("total")


def fastest_safe(table: pd.DataFrame) -> Iterator[Finding]:
    """The fastest cell that was never wrong, or the least wrong one."""
    if table["ns_median"].isna().all():
        return
    safe = safe_cells(table)
    if safe.empty:
        columns = {"wrong": ("wrong", "sum"), "rays": ("rays", "sum"), "families": ("family", "nunique")}
        by_cell = table.groupby("label").agg(**columns)
        best = by_cell.sort_values(["families", "wrong"], ascending=[False, True]).iloc[0]
        yield Finding(
            "bad",
            f"No cell was timed on every family without a wrong answer; the fewest wrong has {best.name} "
            f"({count(int(best.wrong), 'ray')} of {int(best.rays)}).",
        )
        return
    first = safe.iloc[0]
    tail = f", but left {count(int(first.unsolved), 'ray')} undecided" if first.unsolved else ""
    yield Finding(
        "good",
        f"The fastest cell with no wrong answer in any family is {first.name}: medians of {nanoseconds(first.fastest)} "
        f"to {nanoseconds(first.slowest)} a ray by family{tail}.",
    )


def fastest_by_family(table: pd.DataFrame) -> Iterator[Finding]:
    """For each family the fastest cell without a wrong answer; families with the same winner share a sentence."""
    winners: dict[str, list[str]] = {}
    losers = []
    for name, family in table.groupby("family_name", sort=False):
        timed = family[family["ns_median"].notna() & (family["censored"] == 0)]
        right = timed[timed["wrong"] == 0].sort_values("ns_median")
        if not right.empty:
            row = right.iloc[0]
            winners.setdefault(row["label"], []).append(f"{name} ({nanoseconds(row['ns_median'])})")
        elif not timed.empty:
            losers.append(name)
    for label, families in winners.items():
        yield Finding("plain", f"Fastest with no wrong answer on {listed(families)}: {label}.")
    if losers:
        yield Finding("bad", f"No timed cell is free of wrong answers on {listed(losers)}.")


def formulation_losses(table: pd.DataFrame) -> Iterator[Finding]:
    """Formulations whose best cell leaves more rays unsolved than another formulation, beyond chance."""
    losses: dict[str, list[str]] = {}
    for name, family in table.groupby("family_name", sort=False):
        best = family.sort_values("unsolved_share").groupby("formulation", sort=False).first()
        top = best.sort_values(["unsolved_share", "unsolved_high"]).iloc[0]
        equals = listed(best.index[best["unsolved_share"] == top["unsolved_share"]])
        for formulation, row in best.iterrows():
            if row["unsolved_low"] > top["unsolved_high"]:
                against = f"against {percent(top['unsolved_share'])} with {equals}"
                losses.setdefault(formulation, []).append(f"{name} ({percent(row['unsolved_share'])}, {against})")
    for formulation, families in losses.items():
        yield Finding(
            "bad",
            f"The formulation {formulation} loses whichever solver takes it; even its best cell leaves unsolved: "
            f"{listed(families)}.",
        )


def solver_weakness(table: pd.DataFrame) -> Iterator[Finding]:
    """For each solver the family where it is most often wrong, and those where it never is."""
    for variant, rows in table.groupby("variant", sort=False):
        worst = rows.sort_values("wrong_share").iloc[-1]
        if worst["wrong"] == 0:
            continue
        wrong = rows.groupby("family_name", sort=False)["wrong"].sum()
        clean = list(wrong[wrong == 0].index)
        tail = f"; never wrong on {listed(clean)}" if clean else "; wrong somewhere in every family"
        yield Finding(
            "plain",
            f"{variant} is most often wrong on {worst['family_name']}: {percent(worst['wrong_share'])} with the "
            f"formulation {worst['formulation']} ({worst['wrong']} of {worst['rays']}){tail}.",
        )


def largest_spread(table: pd.DataFrame, fixed: str, varied: str) -> tuple[float, str] | None:
    """Largest change of the unsolved share in one family when `varied` changes and `fixed` stays, beyond chance.

    Unsolved, not wrong: a solver that gives up on every ray must not look insensitive.
    """
    best: tuple[float, str] | None = None
    for (held, family), rows in table.groupby([fixed, "family_name"], sort=False):
        ends = rows.sort_values("unsolved_share")
        low, high = ends.iloc[0], ends.iloc[-1]
        gain = high["unsolved_share"] - low["unsolved_share"]
        beyond_chance = high["unsolved_low"] > low["unsolved_high"]
        if rows[varied].nunique() > 1 and beyond_chance and (best is None or gain > best[0]):
            text = (
                f"{held} on {family}: {percent(high['unsolved_share'])} with {high[varied]}, "
                f"{percent(low['unsolved_share'])} with {low[varied]}"
            )
            best = (gain, text)
    return best


def formulation_or_solver(table: pd.DataFrame) -> Iterator[Finding]:
    """Which choice moves the share of unsolved rays more: the formulation under one solver, or the reverse."""
    by_formulation = largest_spread(table, "variant", "formulation")
    by_solver = largest_spread(table, "formulation", "variant")
    if by_formulation is not None:
        text = f"The same solver, another formulation: the share of unsolved rays moves most for {by_formulation[1]}."
        yield Finding("plain", text)
    if by_solver is not None:
        text = f"The same formulation, another solver: the share of unsolved rays moves most for {by_solver[1]}."
        yield Finding("plain", text)
    both = []
    for _, rows in table.groupby("family_name", sort=False):
        formulation = largest_spread(rows, "variant", "formulation") or (0.0, "")
        solver = largest_spread(rows, "formulation", "variant") or (0.0, "")
        both.append((formulation[0], solver[0]))
    moved = [(f, s) for f, s in both if f > 0 or s > 0]
    if moved:
        more = sum(f > s for f, s in moved)
        yield Finding(
            "plain",
            f"Of {len(moved)} families where either choice matters beyond chance, the formulation matters more in "
            f"{more} and the solver in {sum(s > f for f, s in moved)}.",
        )


def excusable(table: pd.DataFrame, asked: bool) -> Iterator[Finding]:
    """How many wrong answers are on rays whose true verdict a one-ulp change of the input flips."""
    wrong, ambiguous = int(table["wrong"].sum()), int(table["ambiguous_wrong"].sum())
    if wrong == 0:
        return
    if not asked:
        yield Finding("plain", "Whether a one-ulp change flips the true verdict was not asked: no error is excused.")
        return
    by_family = table.groupby("family_name", sort=False)[["wrong", "ambiguous_wrong"]].sum()
    top = (by_family["ambiguous_wrong"] / by_family["wrong"].clip(lower=1)).sort_values().index[-1]
    row = by_family.loc[top]
    tail = f"; most on {top} ({row['ambiguous_wrong']} of {row['wrong']})" if ambiguous else ""
    yield Finding(
        "plain",
        f"Of {count(wrong, 'wrong answer')}, {ambiguous} ({percent(ambiguous / wrong)}) are excusable: the true verdict "
        f"of their ray changes under a one-ulp change of an input{tail}.",
    )


def difficulty_effect(table: pd.DataFrame, curves: pd.DataFrame, knobs: dict[str, str]) -> Iterator[Finding]:
    """For each family the cell whose wrong share changes most along the difficulty, beyond chance."""
    named = curves.merge(table[["cell", "family", "label", "family_name"]], on=["cell", "family"])
    named = named[named["records"] >= SMALLEST_BIN]
    for family, rows in named.groupby("family_name", sort=False):
        best = None
        for label, curve in rows.groupby("label", sort=False):
            ends = curve.sort_values("wrong_share")
            low, high = ends.iloc[0], ends.iloc[-1]
            gain = high["wrong_share"] - low["wrong_share"]
            if apart(low, high) and (best is None or gain > best[0]):
                best = (gain, label, low, high)
        if best is not None:
            _, label, low, high = best
            yield Finding(
                "plain",
                f"On {family}, {label} depends most on the difficulty ({knobs.get(family, 'its knob')}): "
                f"{percent(low['wrong_share'])} wrong {span(low)}, "
                f"{percent(high['wrong_share'])} {span(high)}.",
            )


def span(row: pd.Series) -> str:
    """The bin of difficulty, in words."""
    if row["to"] == 0:
        return "at difficulty 0"
    return f"from {row['from']:.3g} to {row['to']:.3g}"


def apart(low: pd.Series, high: pd.Series) -> bool:
    """True when the Wilson intervals of two bins, by their numbers of records, do not meet."""
    a = wilson(round(low["wrong_share"] * low["records"]), int(low["records"]))
    b = wilson(round(high["wrong_share"] * high["records"]), int(high["records"]))
    return a[1] < b[0]


def timing_quality(table: pd.DataFrame) -> Iterator[Finding]:
    """Times that ran out of budget, and times whose repeats spread widely."""
    timed = table[table["ns_median"].notna()]
    cut = timed[timed["censored"] > 0]
    if not cut.empty:
        names = some([f"{r.label} on {r.family_name}" for r in cut.itertuples()])
        text = f"{count(len(cut), 'time')} ran out of budget and bound the cost from below only: {names}."
        yield Finding("bad", text)
    wide = timed[timed["ns_p90"] > WIDE_SPREAD * timed["ns_min"]]
    if not wide.empty:
        yield Finding(
            "plain",
            f"In {len(wide)} of {count(len(timed), 'time')} the repeats spread by more than a factor of {WIDE_SPREAD} "
            "(p90 over smallest): do not tell such cells apart by small differences.",
        )


def of_surface(store: Store, table: pd.DataFrame, curves: pd.DataFrame) -> Iterator[Finding]:
    """All findings of one surface, most important first."""
    knobs = store.families.set_index("name")["difficulty"].to_dict()
    yield from certified_promise(table)
    yield from fastest_safe(table)
    yield from formulation_losses(table)
    yield from formulation_or_solver(table)
    yield from solver_weakness(table)
    yield from fastest_by_family(table)
    yield from excusable(table, store.ambiguity_asked)
    yield from difficulty_effect(table, curves, knobs)
    yield from timing_quality(table)


def findings(store: Store, table: pd.DataFrame, curves: pd.DataFrame) -> list[Finding]:
    """The findings of every surface, alarms of all surfaces first."""
    found = [
        Finding(f.kind, f.text, surface)
        for surface, rows in table.groupby("surface", sort=False)
        for f in of_surface(store, rows, curves)
    ]
    return sorted(found, key=lambda f: f.kind != "alarm")


def best_by_family(table: pd.DataFrame) -> pd.DataFrame:
    """For each family the most accurate cell and the fastest one without a wrong answer.

    Most accurate: fewest inexcusable wrong answers, then fewest unsolved rays, then the smallest 99th percentile
    of the error in condition units, then the shortest time.
    """
    rows = []
    for (surface, name), family in table.groupby(["surface", "family_name"], sort=False):
        order = ["inexcusable_share", "unsolved_share", "condition_units_p99", "ns_median"]
        best = family.sort_values(order).iloc[0]
        safe = family[(family["wrong"] == 0) & family["ns_median"].notna() & (family["censored"] == 0)]
        fast = safe.sort_values("ns_median").iloc[0] if not safe.empty else None
        rows.append(
            {
                "surface": surface,
                "family": name,
                "rays": int(family["rays"].max()),
                "most_accurate": best["label"],
                "wrong": int(best["wrong"]),
                "unsolved": int(best["unsolved"]),
                "condition_units_p99": best["condition_units_p99"],
                "ns": best["ns_median"],
                "fastest_never_wrong": None if fast is None else fast["label"],
                "fastest_ns": None if fast is None else fast["ns_median"],
            }
        )
    return pd.DataFrame(rows)


def abstract(store: Store, table: pd.DataFrame) -> str:
    """One paragraph: what was asked, what came out."""
    if table.empty:
        return "The store has no finished block of rays yet, so there is nothing to compare."
    rays = int(table.groupby(["surface", "family"])["rays"].max().sum())
    answers, wrong = int(table["rays"].sum()), int(table["wrong"].sum())
    unsolved, ambiguous = int(table["unsolved"].sum()), int(table["ambiguous_wrong"].sum())
    surfaces = table["surface"].unique()
    which = listed(surfaces) if len(surfaces) <= EXAMPLES else count(len(surfaces), "surface")
    text = (
        f"{count(table['cell'].nunique(), 'cell')} ({count(len(table[['solver', 'options']].drop_duplicates()), 'solver')}, "
        f"{count(table['formulation'].nunique(), 'formulation')}) answered {count(rays, 'ray')} of "
        f"{count(table['family'].nunique(), 'family', 'families')} on {which}; "
        f"certified truth judged every answer. Of {count(answers, 'answer')}, {percent(wrong / answers)} were wrong "
        f"({percent(ambiguous / wrong) if wrong else 'none'} of these excusable, because a one-ulp change of the ray "
        f"flips the true verdict) and {percent((unsolved - wrong) / answers)} were given up as uncertain or failed."
    )
    worst = table.groupby("family_name", sort=False)[["wrong", "rays"]].sum()
    share = (worst["wrong"] / worst["rays"]).sort_values()
    if share.iloc[-1] > 0:
        text += f" The hardest family is {share.index[-1]} ({percent(share.iloc[-1])} wrong over all cells)."
    safe = [safe_cells(rows) for _, rows in table.groupby("surface", sort=False)]
    if len(safe) == 1 and not safe[0].empty:
        first = safe[0].iloc[0]
        text += (
            f" {count(len(safe[0]), 'timed cell')} gave no wrong answer at all; the fastest of them, {first.name}, "
            f"takes {nanoseconds(first.fastest)} to {nanoseconds(first.slowest)} a ray."
        )
    return text
