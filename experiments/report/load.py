"""Reads the store of one run (SQLite, read only) into tables, and says what it lacks."""

from __future__ import annotations

import sqlite3
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

FORMAT = "1"
TABLES = (
    "meta", "build", "surface", "family", "cell", "skipped", "ray", "record", "tally", "histogram", "timing", "note",
)  # fmt: skip
COUNTS = (
    "rays", "right", "wrong", "uncertain", "failed", "missed", "spurious", "wrong_first", "ambiguous_wrong",
    "evaluations", "iterations", "starts",
)  # fmt: skip
VERDICTS = ("right", "wrong", "uncertain", "failed")
WORST_PER_PAIR = 5  # worst records read for each (cell, family): enough to see a pattern, few enough to read
EXAMPLES = 4  # names given in a sentence before "and N more"


class StoreError(Exception):
    """The store is absent, is not a store, or holds what the report cannot read."""


@dataclass(frozen=True)
class Store:
    """One run: the tables of the schema, restricted to one build and joined where the report needs it."""

    path: Path
    meta: dict[str, str]
    builds: pd.DataFrame
    build: dict[str, object]
    surfaces: pd.DataFrame
    families: pd.DataFrame
    cells: pd.DataFrame
    skipped: pd.DataFrame
    tally: pd.DataFrame  # one row a (cell, family): sums over blocks, and the number of blocks
    histogram: pd.DataFrame
    timing: pd.DataFrame
    records: pd.DataFrame  # records whose ray has a difficulty
    kept: pd.DataFrame  # counts of records by (cell, family, verdict, sampled)
    worst: pd.DataFrame
    notes: pd.DataFrame
    blocks: pd.DataFrame
    ambiguity_asked: bool  # whether truth was asked again under one-ulp moves, for any ray
    missing: list[str] = field(default_factory=list)

    @property
    def thinned(self) -> bool:
        """True when some records were not kept."""
        return int(self.kept["count"].sum()) < int(self.tally["rays"].sum())


def store_file(path: Path) -> Path:
    """The SQLite file of a run folder; the file itself is accepted too."""
    file = path / "run.sqlite" if path.is_dir() else path
    if not file.is_file():
        raise StoreError(f"{file}: no such store; make one with: graze sweep CONFIG.toml --out DIR")
    return file


def connect(file: Path) -> sqlite3.Connection:
    """Opens the store read only and checks that it is one."""
    # A read-only medium cannot hold SQLite's shared-memory file; immutable reads do without it.
    last = "not readable"
    for mode in ("mode=ro", "immutable=1"):
        try:
            database = sqlite3.connect(f"{file.resolve().as_uri()}?{mode}", uri=True)
            names = {row[0] for row in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
            break
        except sqlite3.Error as error:
            last = str(error)
    else:
        raise StoreError(f"{file}: not a store of graze ({last})")
    absent = [name for name in TABLES if name not in names]
    if absent:
        raise StoreError(f"{file}: not a store of graze (no table {', '.join(absent)})")
    return database


def read_meta(database: sqlite3.Connection, file: Path) -> dict[str, str]:
    """The run's description; refuses formats this report does not know."""
    meta = dict(database.execute("SELECT key, value FROM meta"))
    if meta.get("format", FORMAT) != FORMAT:
        raise StoreError(f"{file}: table meta, key format: this report reads {FORMAT}, the store is {meta['format']}")
    return meta


def choose_build(builds: pd.DataFrame, tallied: set[int], file: Path) -> dict[str, object]:
    """The latest build that has results; the latest of all when none has."""
    if builds.empty:
        raise StoreError(f"{file}: table build is empty: the sweep stopped before its first block")
    usable = builds[builds["id"].isin(tallied)]
    return (usable if not usable.empty else builds).sort_values("id").iloc[-1].to_dict()


def cell_labels(cells: pd.DataFrame) -> pd.DataFrame:
    """Adds `variant` (solver, options, and the arithmetic unless it is double) and `label` (within its surface)."""
    cells = cells.copy()
    shown = cells["options"].map(lambda text: f"[{text}]" if text else "")
    precision = cells["precision"].map(lambda text: "" if text == "double" else f" ({text})")
    cells["variant"] = cells["solver"] + shown + precision
    cells["label"] = cells["variant"] + " · " + cells["formulation"]
    return cells


def read_store(path: Path) -> Store:
    """Reads everything the report needs. Raises StoreError with file and table."""
    file = store_file(path)
    database = connect(file)
    try:
        return read_tables(database, file)
    except (sqlite3.Error, pd.errors.DatabaseError) as error:
        raise StoreError(f"{file}: cannot be read: {error}") from error
    finally:
        database.close()


def read_tables(database: sqlite3.Connection, file: Path) -> Store:
    """Reads the tables of the chosen build."""
    # One read transaction: a sweep may still be writing, and the tables must agree with each other.
    database.execute("BEGIN")
    meta = read_meta(database, file)
    builds = pd.read_sql_query("SELECT * FROM build ORDER BY id", database)
    tallied = {row[0] for row in database.execute("SELECT DISTINCT build FROM tally")}
    build = choose_build(builds, tallied, file)

    def table(query: str) -> pd.DataFrame:
        return pd.read_sql_query(query, database, params={"build": int(build["id"])})

    sums = ", ".join(f'SUM("{name}") AS "{name}"' for name in COUNTS)
    parts = {
        "surfaces": pd.read_sql_query("SELECT * FROM surface ORDER BY id", database),
        "families": pd.read_sql_query("SELECT * FROM family ORDER BY id", database),
        "cells": cell_labels(pd.read_sql_query("SELECT * FROM cell ORDER BY id", database)),
        "skipped": pd.read_sql_query("SELECT * FROM skipped ORDER BY what", database),
        "notes": table("SELECT * FROM note WHERE build = :build ORDER BY id"),
        "blocks": table("SELECT cell, family, block FROM tally WHERE build = :build"),
        "tally": table(
            f"SELECT cell, family, COUNT(*) AS blocks, {sums} FROM tally WHERE build = :build GROUP BY cell, family"
        ),
        "histogram": table("SELECT cell, family, metric, bin, count FROM histogram WHERE build = :build"),
        "timing": table("SELECT * FROM timing WHERE build = :build ORDER BY cell, family, repeat"),
        "records": named_verdicts(table(RECORDS)),
        "kept": table(KEPT),
        "worst": table(WORST),
        "ambiguity_asked": database.execute("SELECT COUNT(ambiguous) FROM ray").fetchone()[0] > 0,
    }
    store = Store(path=file, meta=meta, builds=builds, build=build, **parts)
    store.missing.extend(what_is_missing(store))
    return store


def named_verdicts(records: pd.DataFrame) -> pd.DataFrame:
    """Verdicts as a categorical: one byte a record instead of one string."""
    codes = records["verdict"].astype("int8")
    return records.assign(verdict=pd.Categorical.from_codes(codes, categories=list(VERDICTS)))


RECORDS = """
SELECT r.cell, y.family, y.difficulty,
       CASE r.verdict WHEN 'right' THEN 0 WHEN 'wrong' THEN 1 WHEN 'uncertain' THEN 2 ELSE 3 END AS verdict,
       r.kept = 'sample' AS sampled, COALESCE(y.ambiguous, 0) AS ambiguous, r.condition_units
FROM record r JOIN ray y ON y.id = r.ray
WHERE r.build = :build AND y.difficulty IS NOT NULL
"""

KEPT = """
SELECT r.cell, y.family, r.verdict, r.kept = 'sample' AS sampled, COUNT(*) AS count
FROM record r JOIN ray y ON y.id = r.ray WHERE r.build = :build
GROUP BY 1, 2, 3, 4
"""

# Worst first: a wrong first hit, then more wrong hits, then the better conditioned ray: the least excusable.
WORST = f"""
SELECT * FROM (
  SELECT r.cell, y.family, y.surface, y.idx, y.difficulty, y.scale, y.condition, y.ambiguous, y.truth, y.hits AS true_hits,
         r.status, r.hits, r.missed, r.spurious, r.wrong_first, r.condition_units,
         y.ox, y.oy, y.oz, y.dx, y.dy, y.dz,
         ROW_NUMBER() OVER (PARTITION BY r.cell, y.family
           ORDER BY r.wrong_first DESC, r.missed + r.spurious DESC, y.condition IS NULL, y.condition, y.idx) AS place
  FROM record r JOIN ray y ON y.id = r.ray
  WHERE r.build = :build AND r.verdict = 'wrong' AND COALESCE(y.ambiguous, 0) = 0)
WHERE place <= {WORST_PER_PAIR}
"""


def some(names: list[str]) -> str:
    """The first few names, and how many more there are."""
    rest = len(names) - EXAMPLES
    return ", ".join(names[:EXAMPLES]) + (f" and {rest} more" if rest > 0 else "")


def is_skipped(store: Store, words: list[str]) -> bool:
    """True when a row of `skipped` names all these words: then the reason is on record."""
    return any(all(word in what for word in words) for what in store.skipped["what"])


def what_is_missing(store: Store) -> list[str]:
    """One sentence for each kind of gap in the data."""
    sentences = []
    if "finished" not in store.meta:
        sentences.append("The sweep has not finished: run it again to resume; what follows covers the finished blocks.")
    if store.tally.empty:
        return sentences + ["No block of rays is finished yet: there are no results."]
    return sentences + missing_blocks(store) + missing_times(store)


def missing_blocks(store: Store) -> list[str]:
    """Families without rays, pairs never asked, and pairs with fewer blocks than others of their family."""
    surface_of = store.cells.set_index("id")["surface"]
    label_of = store.cells.set_index("id")["label"]
    family_of = store.families.set_index("id")["name"]
    sentences = []
    silent = [name for id_, name in family_of.items() if id_ not in set(store.tally["family"])]
    if silent:
        sentences.append(f"No finished block for the families {some(silent)}.")

    blocks = store.blocks.assign(surface=store.blocks["cell"].map(surface_of))
    expected = blocks.groupby(["surface", "family"])["block"].nunique()
    done = store.tally.set_index(["cell", "family"])["blocks"].to_dict()
    never, short = [], []
    for (surface, family), count in expected.items():
        for cell in store.cells.loc[store.cells["surface"] == surface].itertuples():
            name = f"{label_of[cell.id]} on {family_of[family]}"
            if (cell.id, family) not in done:
                if not is_skipped(store, [cell.solver, family_of[family]]):
                    never.append(name)
            elif done[cell.id, family] < count:
                short.append(f"{name} ({done[cell.id, family]} of {count})")
    if never:
        sentences.append(f"No finished block for {len(never)} pairs of cell and family: {some(never)}.")
    if short:
        sentences.append(f"Blocks are missing for {len(short)} pairs of cell and family: {some(short)}.")
    return sentences


def missing_times(store: Store) -> list[str]:
    """Whether the timing pass has run, and for which pairs it has not."""
    if store.timing.empty:
        return ["The timing pass has not run: there are no times, and cost is shown as evaluations a ray."]
    timed = set(zip(store.timing["cell"], store.timing["family"]))
    label_of = store.cells.set_index("id")["label"]
    family_of = store.families.set_index("id")["name"]
    pairs = [p for p in zip(store.tally["cell"], store.tally["family"]) if p not in timed]
    if not pairs:
        return []
    names = [f"{label_of[c]} on {family_of[f]}" for c, f in pairs]
    return [f"No time for {len(names)} pairs of cell and family: {some(names)}."]
