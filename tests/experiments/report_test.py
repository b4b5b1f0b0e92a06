"""Tests of the report generator, on a small synthetic store. Run: python3 tests/experiments/report_test.py"""

from __future__ import annotations

import importlib
import itertools
import json
import math
import random
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "experiments" / "report" / "graze_report.py"
SCHEMA = ROOT / "experiments" / "schema.sql"
sys.path.insert(0, str(ROOT / "experiments"))
try:
    statistics = importlib.import_module("report.statistics")
    load = importlib.import_module("report.load")
    tables = importlib.import_module("report.tables")
    findings = importlib.import_module("report.findings")
    page = importlib.import_module("report.page")
except ImportError as error:
    if __name__ == "__main__":
        print(f"skipped: {error}")
        sys.exit(77)  # the exit code by which CTest knows a skipped test
    raise unittest.SkipTest(f"the report's Python packages are not installed: {error}") from error

SURFACE = "teardrop:s=1"
# Family: what its difficulty is (empty: no knob) and the share of rays that a weak cell gets wrong.
FAMILIES = {
    "camera": ("", 0.0),
    "inside": ("", 0.0),
    "graze": ("offset from tangency / L", 0.08),
    "flat": ("|q_y|", 0.5),
    "horizontal": ("", 0.6),
    "pole": ("distance from the pole / L", 0.2),
    "axis": ("angle to the axis", 0.1),
    "far": ("distance of the origin / L", 0.02),
    "scale": ("", 0.0),
}
# Solver, options, formulation, form, certified, ns a ray, weakness (1: as weak as its family allows).
CELLS = (
    ("companion", "", "sextic", "polynomial", 0, 2000, 1.0),
    ("companion", "polish=1", "sextic", "polynomial", 0, 2300, 0.9),
    ("companion", "", "sextic_homogeneous", "polynomial", 0, 2050, 0.7),
    ("newton_slices", "", "system", "system", 0, 41000, 0.3),
    ("newton_slices", "", "along_ray", "scalar", 0, 9000, 0.02),
    ("newton_slices", "tries=5", "system", "system", 0, 8000, 0.8),
    ("ceres_slices", "", "system", "system", 0, 2500000, 0.35),
    ("ceres_slices", "", "along_ray", "scalar", 0, 400000, 0.03),
    ("interval_bisection", "", "sextic_homogeneous", "polynomial", 1, 15000, 0.0),
    ("interval_bisection", "", "along_ray", "scalar", 1, 7000, 0.0),
    ("interval_bisection", "", "system", "interval", 1, 90000, 0.0),
    ("certified", "", "along_ray", "scalar", 1, 30, 0.0),
)


class Builder:
    """Fills a store by the schema that the sweep uses, with answers drawn from a seeded generator."""

    def __init__(self, folder: Path, rays: int = 60, seed: int = 1) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.file = folder / "run.sqlite"
        self.rays = rays
        self.random = random.Random(seed)
        self.db = sqlite3.connect(self.file)
        self.db.executescript(SCHEMA.read_text(encoding="utf-8"))

    def build(self, number: int = 1) -> None:
        """One build of the program."""
        row = (number, f"key{number}", "0.1.0", f"{number}abcdef0", "g++ 12.2.0", "-O3 -ffp-contract=off", "avx2")
        place = ("A processor", 2, "Linux 6.1 x86_64", "2026-11-22T01:00:00Z")
        self.db.execute("INSERT INTO build VALUES(?,?,?,?,?,?,?,?,?,?,?)", row + place)

    def describe(self, finished: bool = True) -> None:
        """Meta data, surface, families, cells, and what is left out."""
        meta = {
            "format": "1", "name": "teardrop", "title": "The teardrop", "config": 'title = "The teardrop"\nrays = 60\n',
            "config_path": "experiments/configs/teardrop.toml", "seed": "1", "match_radius": "1e-6 L",
            "keep_all": "20000", "command": "graze sweep experiments/configs/teardrop.toml --out out/teardrop",
        }  # fmt: skip
        if finished:
            meta["finished"] = "2026-11-22T01:10:00Z"
        self.db.executemany("INSERT INTO meta VALUES(?,?)", meta.items())
        self.db.execute("INSERT INTO surface VALUES(1,?,'teardrop',6.0)", (SURFACE,))
        for id_, (name, (knob, _)) in enumerate(FAMILIES.items(), 1):
            self.db.execute("INSERT INTO family VALUES(?,?,?,?)", (id_, name, f"Rays of the kind {name}: a </script> b.", knob))
        for id_, (solver, options, formulation, form, certified, _, _) in enumerate(CELLS, 1):
            row = (id_, 1, formulation, form, solver, options, "double", certified)
            self.db.execute("INSERT INTO cell VALUES(?,?,?,?,?,?,?,?)", row)
        self.db.execute("INSERT INTO skipped VALUES('companion · system','companion takes polynomials only')")
        self.db.execute("INSERT INTO note VALUES(1,1,'timing','the spread of </script> & 3 cells is above 20 %')")

    def add_rays(self) -> None:
        """Rays with a difficulty where the family has a knob; one in 20 is ambiguous."""
        for family, (name, (knob, _)) in enumerate(FAMILIES.items(), 1):
            for i in range(self.rays):
                difficulty = 10 ** self.random.uniform(-12, 0) if knob else None
                if knob and i == 0:
                    difficulty = 0.0
                hits = 0 if i % 7 == 3 else 2
                truth = [{"l": f"{4 + k}." + "1" * 39, "multiplicity": 1, "cosine": 0.5} for k in range(hits)]
                numbers = [float(self.random.uniform(-9, 9)).hex() for _ in range(6)]
                scale = 2.0 ** (i % 5 - 2) if name == "scale" else 1.0
                row = (family * 10**6 + i, 1, family, i, difficulty, scale, *numbers, "ok", hits, json.dumps(truth))
                extra = (10 ** self.random.uniform(0, 6) if hits else None, int(i % 20 == 0))
                self.db.execute(f"INSERT INTO ray VALUES({','.join('?' * 17)})", row + extra)

    def answer(self, build: int = 1, drop: set[tuple[int, int, int]] = frozenset(), thin: int = 0) -> None:
        """Records, tallies and histograms of every cell; `drop` leaves blocks out, `thin` keeps one right in `thin`."""
        rows = self.db.execute("SELECT id, family, idx, difficulty, hits, ambiguous FROM ray").fetchall()
        for cell, family, block in itertools.product(range(1, len(CELLS) + 1), range(1, len(FAMILIES) + 1), (0, 1)):
            if (cell, family, block) not in drop:
                part = [r for r in rows if r[1] == family and r[2] * 2 // self.rays == block]
                self.answer_block(build, cell, family, block, part, thin)

    def answer_block(self, build: int, cell: int, family: int, block: int, rays: list, thin: int) -> None:
        """One block: what the sweep writes in one transaction."""
        limit = list(FAMILIES.values())[family - 1][1] * CELLS[cell - 1][6]
        count = dict.fromkeys(("right", "wrong", "uncertain", "failed"), 0)
        ambiguous = missed = spurious = first = 0
        for id_, _, index, difficulty, hits, is_ambiguous in rays:
            chance = limit if difficulty is None else limit * (2.0 if difficulty < 1e-6 else 0.3)
            draw = self.random.random()
            verdict = "wrong" if draw < chance else "uncertain" if CELLS[cell - 1][4] and draw > 0.995 else "right"
            verdict = "failed" if verdict == "right" and cell == 7 and draw > 0.97 else verdict
            count[verdict] += 1
            lost = int(verdict != "right" and hits > 0)
            extra = int(verdict == "wrong" and hits == 0)
            wrong_first = int(verdict == "wrong")
            ambiguous += int(verdict == "wrong" and is_ambiguous == 1)
            missed, spurious, first = missed + lost, spurious + extra, first + wrong_first
            units = None if hits == 0 else math.inf if lost else 0.0 if draw > 0.9 else 2 ** self.random.gauss(-2, 2)
            self.put_metrics(build, cell, family, {"condition_units": units, "ulps": units})
            kept = "all" if not thin else "wrong" if verdict != "right" else "sample" if index % thin == 0 else None
            if kept:
                reported = " ".join(["0x1.0p+2"] * (0 if lost else hits) + ["0x1.8p+1"] * extra)
                row = (build, cell, id_, verdict, "ok" if verdict == "wrong" else verdict, reported, lost, extra)
                rest = (wrong_first, units, units, None, None, 120, 8, 30, kept)
                self.db.execute(f"INSERT INTO record VALUES({','.join('?' * 17)})", row + rest)
        n = len(rays)
        row = (build, cell, family, block, n, *count.values(), missed, spurious, first, ambiguous)
        row += (120 * n, 8 * n, 30 * n)
        self.db.execute(f"INSERT INTO tally VALUES({','.join('?' * 16)})", row)

    def put_metrics(self, build: int, cell: int, family: int, values: dict[str, float | None]) -> None:
        """Adds one ray to the histograms."""
        for metric, value in values.items():
            if value is not None:
                bin_ = -100000 if value == 0 else 100000 if math.isinf(value) else math.floor(4 * math.log2(value))
                self.db.execute(
                    "INSERT INTO histogram VALUES(?,?,?,?,?,1) ON CONFLICT DO UPDATE SET count = count + 1",
                    (build, cell, family, metric, bin_),
                )

    def time(self, build: int = 1, repeats: int = 7) -> None:
        """The timing pass; ceres_slices runs out of its budget."""
        for cell, (*_, ns, _) in enumerate(CELLS, 1):
            for family in range(1, 10):
                base = ns * self.random.uniform(0.8, 1.3)
                for repeat in range(repeats):
                    value = base * self.random.uniform(1.0, 1.15)
                    row = (build, cell, family, repeat, 0, self.rays, value, "all", int(cell == 7 and family == 4))
                    self.db.execute("INSERT INTO timing VALUES(?,?,?,?,?,?,?,?,?)", row)

    def close(self) -> Path:
        """Writes the store and returns its folder."""
        self.db.commit()
        self.db.close()
        return self.file.parent


def whole_store(folder: Path, rays: int = 60, thin: int = 0) -> Path:
    """A finished run of nine families and twelve cells."""
    builder = Builder(folder, rays)
    builder.build()
    builder.describe()
    builder.add_rays()
    builder.answer(thin=thin)
    builder.time()
    return builder.close()


class Folder(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="graze_report_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_script(self, *arguments: str) -> subprocess.CompletedProcess:
        """The program as a user runs it."""
        return subprocess.run([sys.executable, str(SCRIPT), *arguments], capture_output=True, text=True, check=False)


class Statistics(unittest.TestCase):
    def test_wilson_interval_agrees_with_published_values(self) -> None:
        # Newcombe (1998), table I, method 3: 81/263, 15/148, 0/20, 1/29.
        table = ((81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0, 0.1611), (1, 29, 0.0061, 0.1718))
        for count, total, low, high in table:
            found = statistics.wilson(count, total)
            self.assertAlmostEqual(found[0], low, delta=5e-5)
            self.assertAlmostEqual(found[1], high, delta=5e-5)

    def test_wilson_interval_of_nothing_is_everything(self) -> None:
        self.assertEqual(statistics.wilson(0, 0), (0.0, 1.0))
        self.assertEqual(statistics.wilson(7, 7)[1], 1.0)

    def test_wilson_interval_holds_the_share(self) -> None:
        for total in (1, 2, 10, 1000):
            for count in range(0, total + 1, max(1, total // 10)):
                low, high = statistics.wilson(count, total)
                self.assertTrue(0 <= low <= count / total <= high <= 1, (count, total))

    def test_rule_of_three_bounds_the_exact_limit(self) -> None:
        for total in (10, 100, 10000):
            exact = 1 - 0.05 ** (1 / total)
            self.assertTrue(exact <= statistics.rule_of_three(total) <= 1.2 * exact)
        self.assertEqual(statistics.rule_of_three(0), 1.0)

    def test_upper_edge_lies_above_its_bin(self) -> None:
        for value in (1e-300, 1e-9, 0.3, 1.0, 1.189, 2.0, 12345.6):
            bin_ = math.floor(4 * math.log2(value))
            self.assertLess(value, statistics.upper_edge(bin_) * (1 + 1e-12))
            self.assertLessEqual(statistics.upper_edge(bin_), value * 2**0.25 * (1 + 1e-12))
        self.assertEqual(statistics.upper_edge(-100000), 0.0)
        self.assertEqual(statistics.upper_edge(100000), math.inf)
        self.assertEqual(statistics.upper_edge(4 * 1024), math.inf)

    def test_histogram_quantile_keeps_zeros_and_infinities_in_the_denominator(self) -> None:
        bins = [(100000, 2), (-100000, 5), (0, 3)]
        self.assertEqual(statistics.histogram_quantile(bins, 0.5), 0.0)
        self.assertEqual(statistics.histogram_quantile(bins, 0.51), 2**0.25)
        self.assertEqual(statistics.histogram_quantile(bins, 0.8), 2**0.25)
        self.assertEqual(statistics.histogram_quantile(bins, 0.81), math.inf)
        self.assertEqual(statistics.histogram_quantile(bins, 1.0), math.inf)
        self.assertIsNone(statistics.histogram_quantile([], 0.5))
        self.assertIsNone(statistics.histogram_quantile([(3, 0)], 0.5))

    def test_histogram_quantile_is_not_moved_by_rounding_of_the_rank(self) -> None:
        # 0.99 * 100 is 99 + 1e-14 in double: the 99th of 100 values is the answer, not the 100th.
        self.assertEqual(statistics.histogram_quantile([(0, 99), (100000, 1)], 0.99), 2**0.25)

    def test_weighted_quantile_counts_weights(self) -> None:
        self.assertEqual(statistics.weighted_quantile([1, 2, math.inf], [1, 8, 1], 0.5), 2)
        self.assertEqual(statistics.weighted_quantile([1, 2, math.inf], [1, 1, 8], 0.5), math.inf)
        self.assertEqual(statistics.weighted_quantile([3, math.nan], [1, 9], 0.5), 3)
        self.assertIsNone(statistics.weighted_quantile([], [], 0.5))

    def test_nearest_rank_and_median(self) -> None:
        self.assertEqual(statistics.nearest_rank([5, 1, 4, 2, 3, 6, 7, 8, 9, 10], 0.9), 9)
        self.assertEqual(statistics.median([3, 1, 2]), 2)
        self.assertEqual(statistics.median([4, 1, 2, 3]), 2.5)

    def test_pareto_front_drops_beaten_points(self) -> None:
        points = [(3, 1), (1, 3), (2, 2), (2, 3), (4, 1), (1, 3), (math.nan, 0), (5, math.inf)]
        self.assertEqual(statistics.pareto_front(points), [1, 5, 2, 0])
        self.assertEqual(statistics.pareto_front([(1, math.inf)]), [0])
        self.assertEqual(statistics.pareto_front([]), [])

    def test_sampled_records_stand_for_the_rays_without_record(self) -> None:
        self.assertEqual(statistics.strata_weights(100, 100, 0), 1.0)
        self.assertEqual(statistics.strata_weights(100, 20, 10), 8.0)
        self.assertIsNone(statistics.strata_weights(100, 20, 0))


class PageReader(HTMLParser):
    """Collects what the tests ask about: tags, identifiers, outside references, balance."""

    VOID = {"meta", "link", "input", "br", "path"}

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.unbalanced: list[str] = []
        self.ids: list[str] = []
        self.references: list[str] = []

    def handle_starttag(self, tag: str, attributes: list) -> None:
        if tag not in self.VOID:
            self.open.append(tag)
        for name, value in attributes:
            if name == "id":
                self.ids.append(value)
            if name in ("href", "src"):
                self.references.append(value)

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.unbalanced.append(tag)


class WholeRun(unittest.TestCase):
    """One report of a finished run, made once."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="graze_report_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.store = load.read_store(whole_store(cls.folder))
        cls.html = page.write_report(cls.store, cls.folder / "report").read_text(encoding="utf-8")

    def test_a_finished_run_lacks_nothing(self) -> None:
        self.assertEqual(self.store.missing, [])
        self.assertFalse("This run is not complete" in self.html)

    def test_the_page_is_self_contained_and_well_formed(self) -> None:
        reader = PageReader()
        reader.feed(self.html)
        self.assertEqual(reader.unbalanced, [])
        self.assertEqual(reader.open, [])
        self.assertEqual(len(reader.ids), len(set(reader.ids)))
        for reference in reader.references:
            self.assertRegex(reference, r"^(#|data:,$|csv/|figures/)")
            if reference.startswith(("csv/", "figures/")):
                self.assertTrue((self.folder / "report" / reference).is_file(), reference)
            elif reference.startswith("#"):
                self.assertIn(reference[1:], reader.ids)
        self.assertFalse("@import" in self.html)

    def test_text_of_the_store_cannot_end_a_script_or_an_element(self) -> None:
        self.assertTrue("the spread of &lt;/script&gt; &amp; 3 cells" in self.html)
        self.assertEqual(self.html.count("</script>"), 3)

    def test_the_page_without_data_stays_below_3_megabytes(self) -> None:
        without = re.sub(r'<script type="application/json".*?</script>', "", self.html, flags=re.S)
        self.assertLess(len(without.encode()), 3_000_000)

    def test_embedded_data_is_strict_json(self) -> None:
        text = re.search(r'id="data">(.*?)</script>', self.html, re.S).group(1)

        def refuse(word: str) -> None:
            raise AssertionError(f"{word} is not JSON")

        data = json.loads(text, parse_constant=refuse)
        self.assertEqual(len(data["cells"]), len(CELLS))
        self.assertEqual(len(data["rows"]), len(CELLS) * len(FAMILIES))
        self.assertTrue(any("inf" in row for row in data["rows"]))

    def test_every_figure_names_the_commands_that_make_it(self) -> None:
        self.assertEqual(self.html.count('<p class="reproduce">'), 10)
        self.assertTrue("graze sweep experiments/configs/teardrop.toml --out out/teardrop" in self.html)
        self.assertTrue(f"graze report {self.folder}" in self.html)

    def test_every_figure_comes_as_svg_and_pdf(self) -> None:
        for name in ("error_time_wrong", "error_time_p99", "stability", "heat_map", "distribution", "cost"):
            for ending in ("svg", "pdf"):
                file = self.folder / "report" / "figures" / f"{name}_teardrop_s_1.{ending}"
                self.assertGreater(file.stat().st_size, 1000, file)

    def test_counts_agree_with_the_records(self) -> None:
        with sqlite3.connect(self.store.path) as database:
            wanted = dict(database.execute("SELECT cell, SUM(verdict = 'wrong') FROM record GROUP BY cell"))
        found = tables.results(self.store).groupby("cell")["wrong"].sum().to_dict()
        self.assertEqual(found, wanted)

    def test_stability_bins_hold_every_record_once(self) -> None:
        curves, remarks = tables.stability(self.store)
        self.assertEqual(int(curves["records"].sum()), len(self.store.records))
        self.assertTrue((curves["records"] == curves["rays"]).all())
        self.assertIn("unweighted", remarks[0])
        at_zero = curves[curves["to"] == 0]
        self.assertEqual(set(at_zero["records"]), {1})

    def test_worst_rays_are_lines_that_read_back(self) -> None:
        worst = tables.worst_rays(self.store)
        self.assertGreater(len(worst), 0)
        for row in worst.itertuples():
            line = json.loads(row.ray)
            self.assertEqual(len([float.fromhex(x) for x in line["o"] + line["d"]]), 6)
            self.assertEqual(row.ambiguous, 0)
            self.assertIn(row.ray, row.command)

    def test_a_ray_of_a_scaled_surface_names_the_scaled_surface(self) -> None:
        self.assertEqual(tables.scaled_surface("teardrop:s=1", "teardrop", 0.25), "teardrop:s=0.25")
        torus = tables.scaled_surface("torus:R=1,r=0.25", "torus", 2.0**100)
        self.assertEqual(torus, f"torus:R={2.0**100!r},r={2.0**98!r}")
        points = "bezier_revolution:control_points=[[0,0],[2.5e-1,-1]]"
        scaled = "bezier_revolution:control_points=[[0.0,0.0],[0.5,-2.0]]"
        self.assertEqual(tables.scaled_surface(points, "bezier_revolution", 2.0), scaled)
        self.assertEqual(tables.scaled_surface("plane:a=[1,0,0],b=2", "plane", 1.0), "plane:a=[1,0,0],b=2")
        self.assertIsNone(tables.scaled_surface("plane:a=[1,0,0],b=2", "plane", 2.0))

    def test_the_same_store_gives_the_same_page_and_figures(self) -> None:
        again = page.write_report(self.store, self.folder / "again")
        self.assertEqual(again.read_text(encoding="utf-8"), self.html)
        for file in (self.folder / "report" / "figures").iterdir():
            self.assertEqual(file.read_bytes(), (self.folder / "again" / "figures" / file.name).read_bytes(), file.name)

    def test_findings_name_the_fastest_cell_that_was_never_wrong(self) -> None:
        found = findings.findings(self.store, tables.results(self.store), tables.stability(self.store)[0])
        texts = [f.text for f in found]
        fastest = "The fastest cell with no wrong answer in any family is certified · along_ray"
        self.assertTrue(any(t.startswith(fastest) for t in texts))
        self.assertTrue(any(t.startswith("The formulation sextic loses whichever solver takes it") for t in texts))

    def test_a_certified_wrong_answer_is_shouted_first(self) -> None:
        table = tables.results(self.store)
        table.loc[(table["certified"] == 1) & (table["family_name"] == "flat"), ["wrong", "ambiguous_wrong"]] = (3, 1)
        first = findings.findings(self.store, table, tables.stability(self.store)[0])[0]
        self.assertEqual(first.kind, "alarm")
        self.assertIn("3 wrong answers (1 of them ambiguous): flat (3 of 60)", first.text)


class ThinnedRun(Folder):
    def test_weights_restore_the_shares_of_all_rays(self) -> None:
        whole = load.read_store(whole_store(self.folder / "whole", rays=400))
        thin = load.read_store(whole_store(self.folder / "thin", rays=400, thin=5))
        self.assertTrue(thin.thinned)
        exact, _ = tables.stability(whole)
        estimate, remarks = tables.stability(thin)
        self.assertTrue(any("thinned" in r for r in remarks))
        for cell in (1, 3):
            totals = [t[(t["cell"] == cell) & (t["family"] == 4)] for t in (exact, estimate)]
            wrong = [(t["wrong_share"] * t["rays"]).sum() for t in totals]
            self.assertAlmostEqual(wrong[0], wrong[1], places=6)
            self.assertAlmostEqual(totals[0]["rays"].sum(), totals[1]["rays"].sum(), places=6)
            self.assertLess(totals[1]["records"].sum(), totals[0]["records"].sum())

    def test_records_that_nothing_stands_for_are_left_out_and_said(self) -> None:
        folder = whole_store(self.folder / "thin", thin=5)
        with sqlite3.connect(folder / "run.sqlite") as database:
            database.execute("DELETE FROM record WHERE kept = 'sample' AND cell = 1")
        curves, remarks = tables.stability(load.read_store(folder))
        self.assertNotIn(1, set(curves["cell"]))
        self.assertTrue(any("no sample" in r for r in remarks))


class PartialRun(Folder):
    def builder(self, finished: bool = False) -> Builder:
        builder = Builder(self.folder, rays=40)
        builder.build()
        builder.describe(finished)
        builder.add_rays()
        return builder

    def test_an_interrupted_sweep_says_what_is_missing(self) -> None:
        builder = self.builder()
        late = {(c, 9, b) for c in range(1, 13) for b in (0, 1)}
        builder.answer(drop={(12, 4, 1), (11, 8, 0), (11, 8, 1)} | late)
        store = load.read_store(builder.close())
        html = page.write_report(store, self.folder / "report").read_text(encoding="utf-8")
        self.assertTrue("The sweep has not finished" in html)
        self.assertTrue("No finished block for the families scale." in html)
        self.assertTrue("No finished block for 1 pairs of cell and family: interval_bisection · system on far." in html)
        self.assertTrue("certified · along_ray on flat (1 of 2)" in html)
        self.assertTrue("The timing pass has not run" in html)

    def test_a_store_before_its_first_block_gives_a_page(self) -> None:
        store = load.read_store(self.builder().close())
        html = page.write_report(store, self.folder / "report").read_text(encoding="utf-8")
        self.assertTrue("there are no results" in html)
        self.assertTrue("companion takes polynomials only" in html)

    def test_of_several_builds_the_latest_with_results_is_shown(self) -> None:
        builder = self.builder(finished=True)
        builder.answer(build=1)
        builder.build(2)
        builder.answer(build=2)
        builder.build(3)
        store = load.read_store(builder.close())
        self.assertEqual(store.build["id"], 2)
        self.assertIn("3 builds", dict(page.run_facts(store))["Builds"])
        self.assertEqual(int(store.tally["rays"].sum()), 40 * len(CELLS) * len(FAMILIES))


class CommandLine(Folder):
    def test_no_store_exits_with_3(self) -> None:
        done = self.run_script(str(self.folder))
        self.assertEqual(done.returncode, 3)
        self.assertIn("no such store", done.stderr)

    def test_a_file_that_is_not_a_store_exits_with_3(self) -> None:
        text = "not a data base, but long enough to look like one" * 50
        (self.folder / "run.sqlite").write_text(text, encoding="utf-8")
        self.assertEqual(self.run_script(str(self.folder)).returncode, 3)
        (self.folder / "run.sqlite").unlink()
        sqlite3.connect(self.folder / "run.sqlite").execute("CREATE TABLE meta(key, value)")
        done = self.run_script(str(self.folder))
        self.assertEqual(done.returncode, 3)
        self.assertIn("no table build", done.stderr)

    def test_an_unknown_format_exits_with_3(self) -> None:
        folder = whole_store(self.folder / "run", rays=10)
        with sqlite3.connect(folder / "run.sqlite") as database:
            database.execute("UPDATE meta SET value = '9' WHERE key = 'format'")
        done = self.run_script(str(folder))
        self.assertEqual(done.returncode, 3)
        self.assertIn("this report reads 1, the store is 9", done.stderr)

    def test_wrong_usage_exits_with_2(self) -> None:
        self.assertEqual(self.run_script("--nonsense").returncode, 2)

    def test_output_that_cannot_be_written_exits_with_4(self) -> None:
        folder = whole_store(self.folder / "run", rays=10)
        (self.folder / "file").write_text("", encoding="utf-8")
        done = self.run_script(str(folder), "--out", str(self.folder / "file" / "report"))
        self.assertEqual(done.returncode, 4)
        self.assertIn("cannot write", done.stderr)

    def test_a_missing_package_exits_with_4_and_names_what_to_install(self) -> None:
        # -S hides the site packages, as on a machine without them.
        command = [sys.executable, "-S", str(SCRIPT), str(self.folder)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 4)
        self.assertIn("install python3-pandas python3-matplotlib python3-jinja2 libjs-chart.js", done.stderr)

    def test_the_page_is_written_where_asked_and_its_path_printed(self) -> None:
        folder = whole_store(self.folder / "run", rays=10)
        done = self.run_script(str(folder), "--out", str(self.folder / "elsewhere"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout.strip(), str(self.folder / "elsewhere" / "index.html"))


PLANE = "plane:a=[0,1,0],b=0"
# Formulation, form, solver, precision, certified and (wrong, of these ambiguous, uncertain, failed) of 20 rays.
PLANE_CELLS = (
    ("exact", "polynomial", "closed_form", "double", 0, (0, 0, 0, 0)),
    ("plain", "polynomial", "closed_form", "double", 0, (5, 2, 0, 1)),
    ("exact", "polynomial", "closed_form", "float", 0, (9, 4, 0, 0)),
    ("exact", "polynomial", "interval_bisection", "double", 1, (0, 0, 3, 0)),
)


def add_plane(builder: Builder) -> None:
    """A second surface with other formulations, a float cell, one family, and conditions that are infinite or absent."""
    db = builder.db
    db.execute("INSERT INTO surface VALUES(2,?,'plane',1.0)", (PLANE,))
    db.execute("INSERT INTO surface VALUES(3,'quadric:J=1','quadric',1.0)")  # no family suits it
    for i in range(20):
        numbers = [float(i).hex()] * 6
        condition = (None, math.inf, 3.5)[i % 3]
        row = (90 * 10**6 + i, 2, 1, i, None, 1.0, *numbers, "ok", int(condition is not None), "[]", condition, i % 2)
        db.execute(f"INSERT INTO ray VALUES({','.join('?' * 17)})", row)
    for id_, (formulation, form, solver, precision, certified, counts) in enumerate(PLANE_CELLS, len(CELLS) + 1):
        db.execute("INSERT INTO cell VALUES(?,2,?,?,?,'',?,?)", (id_, formulation, form, solver, precision, certified))
        wrong, ambiguous, uncertain, failed = counts
        verdicts = ["wrong"] * wrong + ["uncertain"] * uncertain + ["failed"] * failed
        for i, verdict in enumerate(verdicts + ["right"] * (20 - len(verdicts))):
            units = None if i % 3 == 0 else math.inf if verdict == "wrong" else 0.5
            row = (1, id_, 90 * 10**6 + i, verdict, "ok", "", int(verdict == "wrong"), 0, 0, units, units, None, None, 1, 0, 0)
            db.execute(f"INSERT INTO record VALUES({','.join('?' * 17)})", (*row, "all"))
        row = (1, id_, 1, 0, 20, 20 - len(verdicts), wrong, uncertain, failed, wrong, 0, 0, ambiguous, 20, 0, 0)
        db.execute(f"INSERT INTO tally VALUES({','.join('?' * 16)})", row)


class SeveralSurfaces(Folder):
    """Surfaces of different kinds in one run: their own formulations, families, precisions, or no family at all."""

    def setUp(self) -> None:
        super().setUp()
        builder = Builder(self.folder, rays=20)
        builder.build()
        builder.describe()
        builder.add_rays()
        builder.answer()
        add_plane(builder)
        builder.close()
        self.store = load.read_store(self.folder)

    def test_float_is_part_of_the_cells_name_and_double_is_not(self) -> None:
        labels = list(self.store.cells["label"])
        self.assertEqual(labels[0], "companion · sextic")
        self.assertEqual(labels[-2:], ["closed_form (float) · exact", "interval_bisection · exact"])

    def test_formulations_come_in_the_surfaces_order_with_their_losses_apart(self) -> None:
        table = tables.formulations(tables.results(self.store))
        plane = table[table["surface"] == PLANE]
        self.assertEqual(list(plane["formulation"]), ["exact", "exact", "exact", "plain"])
        self.assertEqual(list(plane["place"]), [1, 1, 1, 2])
        counts = plane[["wrong_unambiguous", "wrong_ambiguous", "uncertain", "failed"]].to_numpy().tolist()
        self.assertEqual(counts, [[0, 0, 0, 0], [5, 4, 0, 0], [0, 0, 3, 0], [3, 2, 0, 1]])

    def test_orders_of_solvers_that_contradict_each_other_still_give_every_formulation_once(self) -> None:
        rows = [("a", "x", 1), ("a", "y", 2), ("b", "y", 3), ("b", "x", 4), ("b", "z", 5)]
        frame = tables.pd.DataFrame(rows, columns=["variant", "formulation", "cell"])
        self.assertEqual(tables.formulation_order(frame), ["x", "y", "z"])
        self.assertEqual(tables.formulation_order(frame[frame["cell"] != 4]), ["x", "y", "z"])

    def test_the_report_is_made_and_its_page_is_whole(self) -> None:
        html = page.write_report(self.store, self.folder / "report").read_text(encoding="utf-8")
        self.assertIn("closed_form (float)", html)
        for word in ("3 <small>2&nbsp;amb</small> <small>1&nbsp;failed</small>", "0 <small>3&nbsp;unc</small>"):
            self.assertIn(word, html)
        self.assertTrue((self.folder / "report" / "figures" / "heat_map_plane_a_0_1_0_b_0.svg").is_file())
        csv = (self.folder / "report" / "csv" / "formulations.csv").read_text(encoding="utf-8")
        self.assertIn("plain,closed_form,,double,closed_form,20,14,3,2,0,1", csv)

    def test_formulations_of_one_surface_do_not_look_alike(self) -> None:
        style = importlib.import_module("report.style")
        patterns = [tuple(style.pattern(place).values()) for place in range(16)]
        self.assertEqual(len(set(patterns)), 16)


if __name__ == "__main__":
    unittest.main()
