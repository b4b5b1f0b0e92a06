"""Tests of the program graze with good and bad input. Run: python3 tests/experiments/program_test.py PATH/TO/graze

Each test starts the program as a user would and checks exit code, messages and data.
"""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

GRAZE = ""  # set by main
TEARDROP = ("--surface", "teardrop:s=1")
BY_COMPANION = ("solve", *TEARDROP, "--solver", "companion")
POLYNOMIAL_SOLVERS = ("companion", "companion:polish=true", "interval_bisection")
# By hand (document 000, s = 1): the ray along x at y = 1.5 meets the circle of radius R(1/2) = 15/8.
ALONG_X = '{"o":[-5,1.5,0],"d":[1,0,0]}'
L_ALONG_X = [3.125, 6.875]
SURFACE_TABLE = '[[surface]]\ntype = "teardrop"\ns = 1\n'

EXPERIMENT = """
name = "test"
seed = 7
rays = {rays}
surfaces = ["teardrop:s=1"]
solvers = [{solvers}]
cases = ["camera", "graze"]
[timing]
repeats = {repeats}
rays = 20
budget_ms = 5
"""


def run(*arguments: str, text: str | bytes = "", **options) -> subprocess.CompletedProcess:
    """Runs graze with `text` on standard input; stdout and stderr come back as text."""
    data = text.encode() if isinstance(text, str) else text
    done = subprocess.run([GRAZE, *arguments], input=data, capture_output=True, timeout=120, check=False, **options)
    done.stdout, done.stderr = done.stdout.decode(), done.stderr.decode()
    return done


def answers(done: subprocess.CompletedProcess) -> list[dict]:
    return [json.loads(line) for line in done.stdout.splitlines()]


def lengths(answer: dict) -> list:
    return [hit["l"] for hit in answer["hits"]]


class ProgramTest(unittest.TestCase):
    """What the tests share: a folder of their own and checks of how a run ended."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="graze-test-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, name: str, text: str | bytes) -> str:
        path = self.folder / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return str(path)

    def done(self, *arguments: str, text: str | bytes = "", **options) -> subprocess.CompletedProcess:
        """A run that must succeed."""
        result = run(*arguments, text=text, **options)
        self.assertEqual(result.returncode, 0, f"{arguments}: {result.stderr}")
        return result

    def refused(self, code: int, words: tuple[str, ...], *arguments: str, text: str | bytes = "", **options):
        """A run that must end with `code` and a message that holds every word."""
        result = run(*arguments, text=text, **options)
        self.assertEqual(result.returncode, code, f"{arguments}: {result.stderr or result.stdout}")
        self.assertTrue(result.stderr.startswith("graze"), result.stderr)
        self.assertNotIn("internal error", result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        return result

    def scene(self, extra: str, name: str = "scene.toml") -> str:
        return self.write(name, SURFACE_TABLE + extra)


class Usage(ProgramTest):
    OPTIONS = {
        "list": ["WHAT", "--json"],
        "solve": ["--scene", "--surface", "--solver", "--formulation", "--query", "--precision", "--keep-going", "--jobs",
                  "RAYS"],
        "truth": ["--scene", "--surface", "--query", "--keep-going", "--jobs", "--digits", "RAYS"],
        "roots": ["--solver", "--precision", "--keep-going", "POLYNOMIALS"],
        "bench": ["--surface", "--case", "--solver", "--formulation", "--precision", "--query", "--rays", "--misses",
                  "--threads", "--judge",
                  "--match-radius", "--repeats", "--budget-ms", "--seed", "--json"],
        "sweep": ["CONFIG", "--out", "--jobs"],
        "report": ["DIR", "--out"],
    }

    def test_help_of_the_program_lists_every_command_and_exit_code(self):
        text = self.done("--help").stdout
        for word in (*self.OPTIONS, "--version", "130", "2 wrong usage", "3 bad input", "4 environment"):
            self.assertIn(word, text)

    def test_help_of_every_command_lists_its_options(self):
        for command, options in self.OPTIONS.items():
            text = self.done(command, "--help").stdout
            for option in options:
                self.assertRegex(text, rf"(?<![\w-]){re.escape(option)}\b", f"{command} --help lacks {option}")
            known = set(re.findall(r"^\s+(--[a-z-]+)", text, re.MULTILINE))
            self.assertEqual(known - set(options), set(), f"{command}: options that this test does not know")

    def test_version_names_commit_compiler_and_instruction_set(self):
        self.assertRegex(self.done("--version").stdout, r"^graze \d+\.\d+\.\d+ \(commit \S+, .+; this machine: \w+\)\n$")

    def test_unknown_commands_and_options_are_refused(self):
        self.refused(2, ("graze --help",))
        self.refused(2, ("unknown command 'slove'", "nearest: solve"), "slove")
        for later in (("merge", "out", "a"), ("choose", "dir"), ("render", "scene.toml"), ("explain", "flat")):
            self.refused(2, (f"unknown command '{later[0]}'",), *later)
        self.refused(2, ("--shard", "graze sweep --help"), "sweep", "x.toml", "--out", "x", "--shard", "1/2")
        self.refused(2, ("--bogus", "graze solve --help"), *BY_COMPANION, "--bogus")

    def test_missing_and_contradictory_options_are_refused(self):
        self.refused(2, ("--solver",), "solve", *TEARDROP, "--solver")
        self.refused(2, ("--scene", "--surface"), "solve", "--solver", "companion")
        self.refused(2, ("--scene", "--surface"), *BY_COMPANION, "--scene", "x.toml")
        self.refused(2, ("--query",), *BY_COMPANION, "--query", "some")
        self.refused(2, ("--precision",), *BY_COMPANION, "--precision", "half")
        self.refused(2, ("interval_bisection", "float"), "roots", "--solver", "interval_bisection", "--precision", "float")
        self.refused(2, ("--jobs",), *BY_COMPANION, "--jobs", "0")
        self.refused(2, ("--digits",), "truth", *TEARDROP, "--digits", "3")
        self.refused(2, ("--out",), "sweep", "x.toml")

    def test_unknown_names_are_answered_with_the_nearest(self):
        self.refused(2, ("unknown surface 'teardop'", "nearest: teardrop"), "solve", "--surface", "teardop:s=1",
                     "--solver", "companion")
        self.refused(2, ("unknown solver 'compnion'", "nearest: companion"), "solve", *TEARDROP, "--solver", "compnion")
        self.refused(2, ("unknown formulation of teardrop 'along_rya'", "nearest: along_ray"), *BY_COMPANION,
                     "--formulation", "along_rya")
        self.refused(2, ("companion", "takes no form of formulation 'along_ray'"), *BY_COMPANION, "--formulation",
                     "along_ray")
        self.refused(2, ("unknown parameter of teardrop 'size'", "nearest: s"), "truth", "--surface", "teardrop:size=1")
        self.refused(2, ("unknown parameter of newton_slices 'trees'", "nearest: tries"), "solve", *TEARDROP, "--solver",
                     "newton_slices:trees=3")
        self.refused(2, ("unknown case 'camra'", "nearest: camera"), "bench", *TEARDROP, "--solver", "companion", "--case",
                     "camra")
        self.refused(2, ("WHAT", "surfaces"), "list", "surface")

    def test_bad_values_are_named(self):
        for s in ("0", "-1", "nan", "inf", "-inf", '"a"', "true", "[1]"):
            self.refused(2, ("teardrop", "'s'"), "solve", "--surface", f"teardrop:s={s}", "--solver", "companion")
        self.refused(2, ("'s' is missing",), "truth", "--surface", "teardrop")
        self.refused(2, ("not key=value",), "truth", "--surface", "teardrop:s=")
        for tries in ("0", "-3", "1.5", "1e12", "nan"):
            self.refused(2, ("'tries'", "whole number" if tries != "nan" else "finite"), "solve", *TEARDROP, "--solver",
                         f"newton_slices:tries={tries}")

    def test_control_points_that_are_no_surface_are_refused(self):
        for points, word in (("[[0,0]]", "at least 2"), ("[[0,0],[inf,1]]", "not finite"), ("[[0,0],[nan,1]]", "not finite"),
                             ("[[1,2],[1,2],[1,2]]", "equal"), ("[[0,0],[0,6]]", "axis"), ("[1,2]", "rows"),
                             ("[[0,0],[1,2,3]]", "2 numbers"), (str([[1, i] for i in range(34)]), "at most 33")):
            self.refused(2, ("control_points", word), "truth", "--surface", f"bezier_revolution:control_points={points}")
        self.refused(2, ("control_points", "missing"), "truth", "--surface", "bezier_revolution")
        self.refused(2, ("TOML",), "truth", "--surface", "bezier_revolution:control_points=[[0,0],[1")


class List(ProgramTest):
    def test_names_what_there_is(self):
        text = self.done("list").stdout
        for word in ("companion", "interval_bisection", "teardrop", "bezier_revolution", "sextic_homogeneous", "camera"):
            self.assertIn(word, text)
        self.assertNotIn("camera", self.done("list", "solvers").stdout)

    def test_json_holds_forms_claims_and_sources(self):
        everything = json.loads(self.done("list", "--json").stdout)
        everything.pop("peers", None)  # of a build that has some
        self.assertEqual(list(everything), ["solvers", "surfaces", "cases"])
        for solver in everything["solvers"]:
            self.assertEqual(set(solver["claims"]), {"finds_touching_roots", "certified", "deterministic"})
            self.assertTrue(solver["forms"] and solver["source"] and solver["summary"])
            self.assertEqual(solver["precisions"][0], "double")
            self.assertLessEqual(set(solver["precisions"]), {"double", "float"})
            self.assertTrue(solver["max_degree"] is None or solver["max_degree"] > 0)
        for surface in everything["surfaces"]:
            self.assertTrue(surface["formulations"] and surface["parameters"])
            self.assertIsInstance(surface["varieties"], list)
            for formulation in surface["formulations"]:
                self.assertTrue(formulation["degree"] is None or formulation["degree"] > 0)
        self.assertEqual(list(json.loads(self.done("list", "cases", "--json").stdout)), ["cases"])

    def test_says_what_degree_and_arithmetic_a_solver_takes_and_which_kinds_a_surface_has(self):
        listed = json.loads(self.done("list", "--json").stdout)
        solvers = {solver["name"]: solver for solver in listed["solvers"]}
        self.assertEqual(solvers["closed_form"]["max_degree"], 4)
        self.assertEqual(solvers["closed_form"]["precisions"], ["double", "float"])
        self.assertEqual(solvers["interval_bisection"]["precisions"], ["double"])
        text = self.done("list").stdout
        for word in ("degree <= 4", "any degree", "in double, float", "in double;"):
            self.assertIn(word, text)
        surfaces = {surface["name"]: surface for surface in listed["surfaces"]}
        if "torus" in surfaces:
            self.assertIn("spindle torus", surfaces["torus"]["varieties"])
        if "quadric" in surfaces:
            self.assertIn("two-sheet hyperboloid", surfaces["quadric"]["varieties"])
            self.assertIn("varieties: ", text)

    def test_every_page_it_names_exists(self):
        root = Path(__file__).resolve().parents[2]
        for kind in ("solvers", "surfaces"):
            for entry in json.loads(self.done("list", kind, "--json").stdout)[kind]:
                self.assertTrue((root / entry["page"]).is_file(), entry["page"])


class Rays(ProgramTest):
    def test_hits_carry_point_normal_and_parameters(self):
        answer = answers(self.done(*BY_COMPANION, text=ALONG_X))[0]
        self.assertEqual(answer["status"], "ok")
        self.assertEqual(lengths(answer), L_ALONG_X)
        first = answer["hits"][0]
        self.assertEqual(list(first), ["l", "surface", "point", "normal", "params", "multiplicity"])
        self.assertEqual((first["point"], first["surface"], first["multiplicity"]), ([-1.875, 1.5, 0], 0, 1))
        self.assertEqual(first["params"]["t"], 0.5)
        self.assertAlmostEqual(sum(n * n for n in first["normal"]), 1, delta=1e-15)
        self.assertLess(first["normal"][0], 0)  # outward

    def test_query_first_and_any_give_one_hit(self):
        for query in ("first", "any"):
            self.assertEqual(lengths(answers(self.done(*BY_COMPANION, "--query", query, text=ALONG_X))[0]), L_ALONG_X[:1])

    def test_hex_floats_mean_the_same_numbers(self):
        text = '{"o":["-0x1.4p+2","0x1.8p0",0],"d":["0X1P0",0,"-0x0p+0"]}'
        self.assertEqual(self.done(*BY_COMPANION, text=text).stdout, self.done(*BY_COMPANION, text=ALONG_X).stdout)

    def test_other_fields_are_passed_over(self):
        text = '{"id":[1,{"a":"}"}],"d":[1,0,0],"o":[-5,1.5,0],"note":null}'
        self.assertEqual(lengths(answers(self.done(*BY_COMPANION, text=text))[0]), L_ALONG_X)

    def test_line_ends_and_blank_lines_do_not_matter(self):
        expected = self.done(*BY_COMPANION, text=f"{ALONG_X}\n{ALONG_X}\n").stdout
        for text in (f"{ALONG_X}\n{ALONG_X}", f"{ALONG_X}\r\n{ALONG_X}\r\n", f"\n{ALONG_X}\n \t\n\n{ALONG_X}\n\n"):
            self.assertEqual(self.done(*BY_COMPANION, text=text).stdout, expected)

    def test_empty_input_gives_empty_output(self):
        for command in (BY_COMPANION, ("truth", *TEARDROP), ("roots", "--solver", "truth")):
            for text in ("", "\n", "\r\n\r\n"):
                result = self.done(*command, text=text)
                self.assertEqual((result.stdout, result.stderr), ("", ""))

    def test_a_very_long_line_is_read(self):
        padding = " " * (5 << 20)
        text = f'{ALONG_X}\n{{"note":"{"x" * (3 << 20)}",{padding}"o":[-5,1.5,0],"d":[1,0,0]}}\n{ALONG_X}\n'
        got = answers(self.done(*BY_COMPANION, text=text))
        self.assertEqual([lengths(a) for a in got], [L_ALONG_X] * 3)

    def test_rays_come_from_a_file(self):
        path = self.write("rays.jsonl", ALONG_X)
        self.assertEqual(lengths(answers(self.done(*BY_COMPANION, path))[0]), L_ALONG_X)
        self.assertEqual(lengths(answers(self.done(*BY_COMPANION, "-", text=ALONG_X))[0]), L_ALONG_X)
        self.refused(3, ("missing.jsonl", "cannot read"), *BY_COMPANION, str(self.folder / "missing.jsonl"))

    BAD_LINES = (
        ('{"o":[0,0,0],"d":[1,0,NaN]}', "'d'"), ('{"o":[Infinity,0,0],"d":[1,0,0]}', "'o'"),
        ('{"o":[0,0,0],"d":[1,0,1e999]}', "'d'"), ('{"o":[0,0,0],"d":["0x1p+5000",0,0]}', "'d'"),
        ('{"o":[0,0,0],"d":[0,0,0]}', "zero direction"), ('{"o":[0,0,0],"d":[0,-0.0,"0x0p0"]}', "zero direction"),
        ('{"o":[0,0,0]}', "'d': missing"), ('{"d":[0,0,1]}', "'o': missing"), ("{}", "'o': missing"),
        ('{"o":[0,0],"d":[0,0,1]}', "'o'"), ('{"o":[0,0,0,0],"d":[0,0,1]}', "'o'"), ('{"o":"abc","d":[0,0,1]}', "'o'"),
        ('{"o":[0,0,"1.5"],"d":[0,0,1]}', "'o'"), ('{"o":[0,0,"0xg"],"d":[0,0,1]}', "'o'"),
        ('{"o":[0,0,null],"d":[0,0,1]}', "'o'"), ('{"o":[0,0,true],"d":[0,0,1]}', "'o'"), ('{"o":{"x":1},"d":[0,0,1]}', "'o'"),
        ('{"o":[0,0,0],"d":[0,0,1]', "JSON"), ('{"o":[0,0,0] "d":[0,0,1]}', "JSON"), ("[1,2,3]", "JSON"), ("hello", "JSON"),
        ('{"o":[0,0,0],"d":[0,0,1]} {"o"', "JSON"), ("{'o':[0,0,0],'d':[0,0,1]}", "JSON"),
    )

    def test_a_bad_line_ends_the_run_after_the_answers_before_it(self):
        for command in (BY_COMPANION, ("truth", *TEARDROP)):
            for line, word in self.BAD_LINES:
                result = self.refused(3, ("<stdin>:4:", word), *command, text=f"{ALONG_X}\n\n{ALONG_X}\n{line}\n{ALONG_X}\n")
                self.assertEqual(len(answers(result)), 2, line)
        path = self.write("rays.jsonl", f"{ALONG_X}\n\xff\xfe\n".encode("latin-1"))
        self.assertEqual(len(answers(self.refused(3, (f"{path}:2:",), *BY_COMPANION, path))), 1)

    def test_a_bad_line_far_behind_ends_the_run_after_all_answers_before_it(self):
        text = f"{ALONG_X}\n" * 20000 + "oops\n"
        result = self.refused(3, ("<stdin>:20001:",), *BY_COMPANION, "--jobs", "3", text=text)
        self.assertEqual(result.stdout.count("\n"), 20000)

    def test_keep_going_answers_a_bad_line_with_invalid(self):
        lines = "".join(f"{line}\n{ALONG_X}\n" for line, _ in self.BAD_LINES)
        for command in (BY_COMPANION, ("truth", *TEARDROP)):
            got = answers(self.done(*command, "--keep-going", text=lines))
            self.assertEqual(len(got), 2 * len(self.BAD_LINES))
            for (_, word), bad, good in zip(self.BAD_LINES, got[::2], got[1::2]):
                self.assertEqual((bad["hits"], bad["status"]), ([], "invalid"))
                self.assertIn(word, bad["why"])
                self.assertEqual([float(l) for l in lengths(good)], L_ALONG_X)

    def test_every_solver_and_formulation_finds_the_hits_worked_by_hand(self):
        registry = json.loads(self.done("list", "--json").stdout)
        formulations = {f["name"]: set(f["forms"]) for f in registry["surfaces"][0]["formulations"]}
        # The teardrop's polynomials are of degree 6: beyond a solver of quadratics.
        for solver in (s for s in registry["solvers"] if (s["max_degree"] or 6) >= 6):
            for name, forms in formulations.items():
                if not forms & set(solver["forms"]):
                    continue
                got = answers(self.done("solve", *TEARDROP, "--solver", solver["name"], "--formulation", name, text=ALONG_X))
                # faithful proves digits from exact coefficients; other equations leave them open.
                statuses = {"ok", "uncertain"} if solver["name"] == "faithful" else {"ok"}
                self.assertIn(got[0]["status"], statuses, (solver["name"], name))
                self.assertEqual(len(got[0]["hits"]), 2, (solver["name"], name))
                for l, expected in zip(lengths(got[0]), L_ALONG_X):
                    self.assertAlmostEqual(l, expected, delta=1e-11)

    def test_output_does_not_depend_on_the_number_of_threads(self):
        text = "".join(f'{{"o":[{-5 + i % 7},{i / 900},{i % 13 / 7}],"d":[1,{i % 5 / 9},{i % 3}]}}\n' for i in range(6000))
        for command in (BY_COMPANION, ("solve", *TEARDROP, "--solver", "newton_slices:tries=4"), ("truth", *TEARDROP)):
            one = self.done(*command, "--jobs", "1", text=text).stdout
            self.assertEqual(one, self.done(*command, "--jobs", "4", text=text).stdout)
            self.assertEqual(one.count("\n"), 6000)


class Truth(ProgramTest):
    def truth(self, ray: str, *extra: str) -> dict:
        return answers(self.done("truth", *TEARDROP, *extra, text=ray))[0]

    def test_hits_worked_by_hand(self):
        for ray, expected in ((ALONG_X, L_ALONG_X), ('{"o":[0,10,0],"d":[0,-1,0]}', [4, 10]),
                              ('{"o":[-5,1.5,0],"d":[2,0,0]}', [3.125 / 2, 6.875 / 2]), ('{"o":[0,1.5,1.875],"d":[0,0,1]}', []),
                              ('{"o":[0,1.5,1.875],"d":[0,0,-1]}', [3.75]), ('{"o":[0,3,9],"d":[0,1,0]}', [])):
            answer = self.truth(ray)
            self.assertEqual(answer["status"], "ok")
            self.assertEqual([float(l) for l in lengths(answer)], expected)
            for hit in answer["hits"]:  # a rational l with few digits is exact, and says so
                self.assertEqual(hit["enclosure"], [hit["l"]] * 2)
                self.assertEqual((hit["multiplicity"], hit["tangent"]), (1, False))

    def test_a_ray_that_touches_has_one_hit_of_multiplicity_two(self):
        answer = self.truth('{"o":[1.875,1.5,-5],"d":[0,0,1]}')
        self.assertEqual([(float(h["l"]), h["multiplicity"], h["tangent"]) for h in answer["hits"]], [(5, 2, True)])

    def test_forty_digits_between_neighbouring_decimals(self):
        hits = self.truth('{"o":[-5,1,0.25],"d":[1,0.125,0]}')["hits"]
        self.assertEqual(len(hits), 2)
        for hit in hits:
            self.assertEqual(len(hit["l"].replace(".", "").lstrip("0")), 40)
            lo, hi = hit["enclosure"]
            self.assertLess(float(lo), float(hi) + 1e-15)
            self.assertEqual(lo[:-2], hi[:-2])
            self.assertIn(hit["l"], (lo, hi))
        self.assertEqual(len(self.truth('{"o":[-5,1,0.25],"d":[1,0.125,0]}', "--digits", "100")["hits"][0]["l"]), 101)
        self.assertEqual(self.truth(ALONG_X, "--query", "first")["hits"][0]["l"], "3.125")
        self.assertEqual(len(self.truth(ALONG_X, "--query", "any")["hits"]), 1)

    def test_the_teardrop_is_its_bezier_profile(self):
        ray = '{"o":[-5,1,0.25],"d":[1,0.125,0]}'
        same = "bezier_revolution:control_points=[[0,0],[2,0],[3,2],[0,6]]"
        self.assertEqual(lengths(answers(self.done("truth", "--surface", same, text=ray))[0]), lengths(self.truth(ray)))


class Scenes(ProgramTest):
    def test_surfaces_are_placed_and_bring_their_own_solver(self):
        moved = ('name = "moved"\ntranslate = [10, 0, 0]\nmatrix = [[2,0,0],[0,2,0],[0,0,2]]\nsolver = "interval_bisection"\n'
                 'formulation = "along_ray"\n[surface.eps]\nbody = 1e-10\ngrazing = 1e-6\n')
        path = self.scene(SURFACE_TABLE + moved)
        ray = '{"o":[-5,1.5,0],"d":[1,0,0]}'
        got = answers(self.done("solve", "--scene", path, "--solver", "companion", text=ray))[0]
        self.assertEqual([hit["surface"] for hit in got["hits"]], [0, 0, 1, 1])
        exact = answers(self.done("truth", "--scene", path, text=ray))[0]
        self.assertEqual([hit["surface"] for hit in exact["hits"]], [0, 0, 1, 1])
        for hit, true in zip(got["hits"], exact["hits"]):
            self.assertAlmostEqual(hit["l"], float(true["l"]), delta=1e-8)

    def test_eps_decides_how_sharp_an_enclosure_gets(self):
        ray = '{"o":[-5,1.25,0.25],"d":[1,0.125,0]}'
        true = float(answers(self.done("truth", *TEARDROP, text=ray))[0]["hits"][0]["l"])
        errors = []
        for eps in ("1e-7", "1e-13"):
            path = self.scene(f"eps = {{ bottom = {eps}, body = {eps}, equator = {eps}, neck = {eps}, apex = {eps} }}\n")
            got = answers(self.done("solve", "--scene", path, "--solver", "interval_bisection", text=ray))[0]
            errors.append(abs(got["hits"][0]["l"] - true))
        self.assertLess(errors[1], 1e-13)
        self.assertGreater(errors[0], 1e-12)
        self.assertLess(errors[0], 1e-7)

    def test_an_eps_too_wide_to_locate_a_hit_makes_the_answer_uncertain(self):
        path = self.scene("eps = { bottom = 0.1, body = 0.1, equator = 0.1, neck = 0.1, apex = 0.1, grazing = 0.1 }\n")
        ray = '{"o":[-5,1.25,0.25],"d":[1,0.125,0]}'
        got = answers(self.done("solve", "--scene", path, "--solver", "interval_bisection", text=ray))[0]
        self.assertEqual((got["hits"], got["status"]), ([], "uncertain"))

    def test_bad_fields_are_named_with_file_and_line(self):
        for extra, word in (("x = = 1", "TOML"), ("translate = [1,2]", "'translate'"), ("translate = 3", "'translate'"),
                            ("matrix = [[1,0,0],[0,1,0]]", "'matrix'"), ("matrix = [[1,0],[0,1],[0,0]]", "'matrix'"),
                            ('matrix = "unit"', "'matrix'"), ("name = 3", "'name'"), ("eps = 1", "'eps'"),
                            ('eps = { body = "small" }', "'eps.body'"), ('solver = "compnion"', "nearest: companion"),
                            ('solver = "newton_slices:tries=0"', "'tries'"), ("solver = 1", "'solver'"),
                            ('formulation = "along"', "nearest: along_ray"), ("s = 2", "TOML"), ("t = { a = 1 }", "'t'")):
            path = self.scene(extra + "\n")
            self.refused(2, (f"{path}:4:", word), "solve", "--scene", path, "--solver", "companion", text=ALONG_X)

    def test_bad_surfaces_are_named_with_file_and_line(self):
        for extra, word in (("matrix = [[1,0,0],[0,1,0],[1,1,0]]", "singular"), ("matrix = [[0,0,0],[0,0,0],[0,0,0]]", "singular"),
                            ("matrix = [[1,0,0],[0,1,0],[0,0,nan]]", "finite"), ("translate = [0,inf,0]", "finite"),
                            ("eps = { botom = 1e-9 }", "nearest: bottom"), ("eps = { body = 0 }", "eps.body"),
                            ("eps = { body = -1e-9 }", "eps.body"), ("r = 2", "unknown parameter of teardrop 'r'")):
            path = self.scene(extra + "\n")
            for command in (("solve", "--solver", "companion"), ("truth",)):
                self.refused(2, (f"{path}:1:", word), *command, "--scene", path, text=ALONG_X)
        path = self.write("type.toml", '[[surface]]\ntype = "teardop"\ns = 1\n')
        self.refused(2, (f"{path}:1:", "nearest: teardrop"), "truth", "--scene", path)
        path = self.write("none.toml", "[[surface]]\ns = 1\n")
        self.refused(2, (f"{path}:1:", "'type'"), "truth", "--scene", path)

    def test_files_that_are_no_scene_are_refused(self):
        self.refused(2, ("missing.toml", "cannot read"), "truth", "--scene", str(self.folder / "missing.toml"))
        for text in ("", "[camera]\nfov = 40\n", "surface = 3\n"):
            path = self.write("scene.toml", text)
            self.refused(2, (path, "[[surface]]"), "truth", "--scene", path)
        path = self.write("scene.toml", '[[surface]\ntype = "teardrop"\n')
        self.refused(2, (f"{path}:1:", "TOML"), "truth", "--scene", path)


# Surfaces of every type; a ray that hits each; what makes it no surface, and the words of the complaint.
# By hand: every one but the last two is met by the ray first at l.
UP = '{"o":[0.125,-5,0.25],"d":[0,1,0]}'
SURFACES = {
    "sphere": ("sphere:radius=3,center=[0.125,0,0.25]", [2, 8], (
        ("sphere", "radius"), ("sphere:radius=0", "radius"), ("sphere:radius=-1", "radius"),
        ("sphere:radius=nan", "radius"), ("sphere:radius=1,center=[0,0]", "center"), ("sphere:radius=1,centre=[0,0,0]", "center"))),
    "ellipsoid": ("ellipsoid:semi_axes=[1,3,1],center=[0.125,0,0.25]", [2, 8], (
        ("ellipsoid", "P"), ("ellipsoid:semi_axes=[1,0,1]", "semi_axes"), ("ellipsoid:semi_axes=[1,1]", "semi_axes"),
        ("ellipsoid:P=[[1,0,0],[0,1,0]]", "P"), ("ellipsoid:P=[[1,2,0],[2,1,0],[0,0,1]]", "P"),
        ("ellipsoid:P=[[1,0.5,0],[0,1,0],[0,0,1]]", "P"), ("ellipsoid:P=[[1,0,0],[0,1,0],[0,0,1]],semi_axes=[1,1,1]", "P"))),
    "quadric": ("quadric:E=1,J=-4", [3, 7], (
        ("quadric", "zero"), ("quadric:A=0,J=0", "zero"), ("quadric:A=inf", "A"), ("quadric:A=1,K=1", "K"))),
    "plane": ("plane:a=[0,1,0],b=-1", [4], (
        ("plane:b=1", "a"), ("plane:a=[0,0,0],b=1", "a"), ("plane:a=[0,1,0]", "b"), ("plane:a=[0,1],b=1", "a"),
        ("plane:a=[0,1,0],b=nan", "b"), ("plane:a=[0,1,0],b=0,one_sided=1", "one_sided"))),
    "triangle": ("triangle:vertices=[[-2,1,-2],[2,1,-2],[0,1,4]]", [6], (
        ("triangle", "vertices"), ("triangle:vertices=[[0,0,0],[1,1,1]]", "vertices"),
        ("triangle:vertices=[[0,0,0],[1,1,1],[2,2,2]]", "vertices"), ("triangle:vertices=[[0,0],[1,1],[2,2]]", "vertices"))),
    "polygon": ("polygon:vertices=[[-2,1,-2],[2,1,-2],[2,1,2],[-2,1,2]]", [6], (
        ("polygon", "vertices"), ("polygon:vertices=[[0,0,0],[1,0,0]]", "vertices"),
        ("polygon:vertices=[[0,0,0],[1,0,0],[1,0,1],[0,1,0]]", "vertices"),
        ("polygon:vertices=[[0,0,0],[1,0,0],[0,0,1],[1,0,1]]", "vertices"),
        ("polygon:vertices=[[0,0,0],[0,0,0],[1,0,0],[1,0,1]]", "vertices"))),
    "disk": ("disk:normal=[0,1,0],radius=2,center=[0,1,0]", [6], (
        ("disk:radius=1", "normal"), ("disk:normal=[0,0,0],radius=1", "normal"), ("disk:normal=[0,1,0]", "radius"),
        ("disk:normal=[0,1,0],radius=0", "radius"), ("disk:normal=[0,1,0],radius=1,center=3", "center"))),
    "box": ("box:min=[0,0,0],max=[1,1,1]", [5, 6], (
        ("box:min=[0,0,0]", "max"), ("box:max=[0,0,0]", "min"), ("box:min=[0,0,0],max=[1,0,1]", "flat"),
        ("box:min=[0,0,0],max=[1,-1,1]", "max"), ("box:min=[0,0,0],max=[1,1]", "max"))),
    "tetrahedron": ("tetrahedron:vertices=[[-2,0,-2],[2,0,-2],[0,0,4],[0.125,2,0.25]]", [5, 7], (
        ("tetrahedron", "vertices"), ("tetrahedron:vertices=[[0,0,0],[1,0,0],[0,1,0]]", "vertices"),
        ("tetrahedron:vertices=[[0,0,0],[1,0,0],[0,1,0],[1,1,0]]", "vertices"))),
    "convex_polyhedron": ("convex_polyhedron:halfspaces=[[1,0,0,1],[-1,0,0,1],[0,1,0,1],[0,-1,0,1],[0,0,1,1],[0,0,-1,1]]", [4, 6], (
        ("convex_polyhedron", "halfspaces"), ("convex_polyhedron:halfspaces=[[1,0,0,1],[-1,0,0,1]]", "unbounded"),
        ("convex_polyhedron:halfspaces=[[0,0,0,1],[1,0,0,1],[-1,0,0,1],[0,1,0,1],[0,-1,0,1],[0,0,1,1],[0,0,-1,1]]", "zero"),
        ("convex_polyhedron:halfspaces=[[1,0,0,-2],[-1,0,0,1],[0,1,0,1],[0,-1,0,1],[0,0,1,1],[0,0,-1,1]]", "empty"),
        ("convex_polyhedron:halfspaces=[[1,0,0,1],[-1,0,0,-1],[0,1,0,1],[0,-1,0,1],[0,0,1,1],[0,0,-1,1]]", "flat"))),
    "torus": ("torus:R=0.25,r=0.125", None, (
        ("torus:R=1", "r"), ("torus:r=1", "R"), ("torus:R=0,r=1", "R"), ("torus:R=1,r=-1", "r"), ("torus:R=1,r=nan", "r"))),
    "implicit_polynomial": ("implicit_polynomial:terms=[[1,0,2,0],[-4,0,0,0]]", [3, 7], (
        ("implicit_polynomial", "terms"), ("implicit_polynomial:terms=[[1,0,0,0]]", "terms"),
        ("implicit_polynomial:terms=[[1,1,0,0],[-1,1,0,0]]", "terms"), ("implicit_polynomial:terms=[[1,0.5,0,0]]", "terms"),
        ("implicit_polynomial:terms=[[1,33,0,0]]", "terms"), ("implicit_polynomial:terms=[[1,0,0]]", "terms"),
        ("implicit_polynomial:terms=[[1,-1,0,0]]", "terms"))),
}  # fmt: skip


class Surfaces(ProgramTest):
    """Every type of surface inline and in scene files."""

    def built(self) -> list[str]:
        known = [surface["name"] for surface in json.loads(self.done("list", "surfaces", "--json").stdout)["surfaces"]]
        return [name for name in SURFACES if name in known]

    @staticmethod
    def solvers(name: str) -> tuple[str, ...]:
        higher = ("interval_bisection", "companion")
        return higher if name == "implicit_polynomial" else ("closed_form", *higher)

    @staticmethod
    def as_toml(text: str) -> str:
        """The inline surface as a table of a scene file."""
        name, _, values = text.partition(":")
        lines = re.sub(r",(?=[A-Za-z_]+=)", "\n", values).replace("=", " = ")
        return f'[[surface]]\ntype = "{name}"\n{lines}\n'

    def test_every_type_is_solved_inline_as_worked_by_hand(self):
        for name in self.built():
            surface, expected, _ = SURFACES[name]
            truth = answers(self.done("truth", "--surface", surface, text=UP))[0]
            self.assertEqual(truth["status"], "ok", surface)
            if expected is not None:
                self.assertEqual([float(l) for l in lengths(truth)], expected, surface)
            for solver in self.solvers(name):
                got = answers(self.done("solve", "--surface", surface, "--solver", solver, text=UP))[0]
                self.assertEqual(got["status"], "ok", (surface, solver))
                self.assertEqual(len(got["hits"]), len(truth["hits"]), (surface, solver))
                for l, exact in zip(lengths(got), lengths(truth)):
                    self.assertAlmostEqual(l, float(exact), delta=1e-11, msg=(surface, solver))

    def test_bad_parameters_are_named(self):
        for name in self.built():
            for surface, word in SURFACES[name][2]:
                for command in (("truth",), ("solve", "--solver", "interval_bisection")):
                    result = self.refused(2, (name,), *command, "--surface", surface, text=UP)
                    self.assertRegex(result.stderr, rf"\b{word}\b", surface)

    def test_bad_parameters_in_scene_files_are_named_with_file_and_line(self):
        for name in self.built():
            for surface, word in SURFACES[name][2]:
                path = self.write("scene.toml", "# A comment, so that the surface starts on line 2.\n" + self.as_toml(surface))
                result = self.refused(2, (path,), "solve", "--solver", "interval_bisection", "--scene", path, text=UP)
                self.assertRegex(result.stderr, rf"\b{word}\b", surface)
                # The line of the field that it names, or of the surface where the field is missing.
                place = re.search(r":(\d+): field '(\w+)'", result.stderr)
                self.assertIsNotNone(place, result.stderr)
                with open(path) as file:
                    line = file.read().splitlines()[int(place[1]) - 1]
                self.assertRegex(line, rf"^({place[2]} =|\[\[surface\]\])", result.stderr)

    def test_a_scene_mixes_all_types_and_names_the_surface_of_every_hit(self):
        built = self.built()
        tables = [self.as_toml(SURFACES[name][0]) for name in built]
        for i, table in enumerate(tables):
            tables[i] = table + f'name = "number {i}"\ntranslate = [0, {0.0625 * i}, 0]\n'
        path = self.write("scene.toml", SURFACE_TABLE + "".join(tables))
        truth = answers(self.done("truth", "--scene", path, text=UP))[0]
        got = answers(self.done("solve", "--scene", path, "--solver", "interval_bisection", text=UP))[0]
        self.assertEqual(got["status"], "ok")
        self.assertEqual([hit["surface"] for hit in got["hits"]], [hit["surface"] for hit in truth["hits"]])
        for l, exact in zip(lengths(got), lengths(truth)):
            self.assertAlmostEqual(l, float(exact), delta=1e-9)
        first = answers(self.done("solve", "--scene", path, "--solver", "interval_bisection", "--query", "first", text=UP))[0]
        self.assertEqual(lengths(first), lengths(got)[:1])

    def test_hits_name_the_variety_of_their_surface(self):
        for surface, variety in (("quadric:E=1,J=-4", "parallel planes"), ("quadric:A=1,E=1,H=1,J=-4", "ellipsoid"),
                                 ("quadric:A=1,E=-1,H=1", "cone"), ("torus:R=0.25,r=0.5", "spindle torus")):
            if surface.partition(":")[0] not in self.built():
                continue
            for hit in answers(self.done("solve", "--surface", surface, "--solver", "companion", text=UP))[0]["hits"]:
                self.assertEqual(hit["variety"], variety, surface)

    def test_a_one_sided_plane_is_seen_from_its_front_only(self):
        if "plane" not in self.built():
            self.skipTest("this build has no plane")
        for sides, up, down in (("", 1, 1), (",one_sided=true", 0, 1), (",one_sided=false", 1, 1)):
            for direction, count in ((1, up), (-1, down)):
                ray = f'{{"o":[0.5,{-5 * direction},0],"d":[0,{direction},0]}}'
                for command in (("truth",), ("solve", "--solver", "closed_form")):
                    got = answers(self.done(*command, "--surface", f"plane:a=[0,1,0],b=0{sides}", text=ray))[0]
                    self.assertEqual((got["status"], len(got["hits"])), ("ok", count))


class Float(ProgramTest):
    """The same questions in single precision: near enough to the true answers, and not the same digits."""

    EPS = 2.0**-23

    def test_solve_answers_in_float(self):
        ray = '{"o":[-5,1.3,0.3],"d":[1,0.125,0.01]}'
        exact = [float(l) for l in lengths(answers(self.done("truth", *TEARDROP, text=ray))[0])]
        for solver in ("companion", "newton_slices"):
            single = answers(self.done("solve", *TEARDROP, "--solver", solver, "--precision", "float", text=ray))[0]
            self.assertEqual(single["status"], "ok", solver)
            self.assertEqual(len(single["hits"]), len(exact), solver)
            for l, true in zip(lengths(single), exact):
                self.assertAlmostEqual(l, true, delta=1e3 * self.EPS * abs(true), msg=solver)
            double = answers(self.done("solve", *TEARDROP, "--solver", solver, text=ray))[0]
            self.assertNotEqual(lengths(single), lengths(double), solver)

    def test_a_solver_without_float_says_so(self):
        self.refused(2, ("interval_bisection", "float"), "solve", *TEARDROP, "--solver", "interval_bisection", "--precision",
                     "float", text=ALONG_X)

    def test_roots_are_found_in_float(self):
        text = '{"c":[-2,0,1],"interval":[0,2]}\n{"c":[-6,11,-6,1]}\n'
        two, three = answers(self.done("roots", "--solver", "companion", "--precision", "float", text=text))
        self.assertAlmostEqual(two["roots"][0]["x"], 2**0.5, delta=8 * self.EPS)
        self.assertNotAlmostEqual(two["roots"][0]["x"], 2**0.5, delta=2.0**-40)
        for root, x in zip(three["roots"], (1, 2, 3)):
            self.assertAlmostEqual(root["x"], x, delta=1e3 * self.EPS)
        text += '{"c":[-1,0,0,0,0,1]}\n'
        formulas = answers(self.done("roots", "--solver", "closed_form", "--precision", "float", text=text))
        self.assertEqual([answer["status"] for answer in formulas], ["ok", "ok", "failed"])

    def test_bench_times_float(self):
        lines = answers(self.done("bench", *TEARDROP, "--solver", "companion", "--precision", "float", *Bench.QUICK, "--json"))
        self.assertEqual([line["precision"] for line in lines], ["float"])
        self.assertGreater(lines[0]["ns_per_ray"]["min"], 0)

    def test_a_sweep_compares_double_and_float(self):
        text = EXPERIMENT.format(rays=50, solvers='"companion", "interval_bisection"', repeats=1)
        config = self.write("experiment.toml", text.replace("rays = 50", 'rays = 50\nprecision = ["double", "float"]', 1))
        out = self.folder / "out"
        self.done("sweep", config, "--out", str(out))
        cells = {(row[4], row[6]) for row in rows(out, "cell")}
        self.assertEqual(cells, {("companion", "double"), ("companion", "float"), ("interval_bisection", "double")})
        self.assertTrue(any("interval_bisection / float" in row[0] for row in rows(out, "skipped")))
        for bad, word in (('precision = ["half"]', "float"), ('precision = "float"', "list")):
            broken = self.write("bad.toml", text.replace("rays = 50", f"rays = 50\n{bad}", 1))
            self.refused(2, (":5:", "'precision'", word), "sweep", broken, "--out", str(self.folder / "never"))

    def test_a_sweep_takes_preferred_formulations_only(self):
        text = EXPERIMENT.format(rays=50, solvers='"companion", "interval_bisection"', repeats=0)
        preferred = self.write("preferred.toml", text.replace("rays = 50", 'rays = 50\nformulations = "preferred"', 1))
        out = self.folder / "out"
        self.done("sweep", preferred, "--out", str(out))
        cells = [(row[1], row[4], row[2]) for row in rows(out, "cell")]
        self.assertEqual(len(cells), len({(surface, solver) for surface, solver, _ in cells}), "one a solver and surface")
        self.assertEqual({solver for _, solver, _ in cells}, {"companion", "interval_bisection"})
        self.assertTrue(any("preferred" in row[1] for row in rows(out, "skipped")))
        # The others come when they are asked for.
        self.done("sweep", self.write("all.toml", text), "--out", str(out))
        self.assertGreater(len(rows(out, "cell")), len(cells))
        broken = self.write("bad.toml", text.replace("rays = 50", 'rays = 50\nformulations = "best"', 1))
        self.refused(2, (":5:", "'formulations'", "preferred"), "sweep", broken, "--out", str(self.folder / "never"))


class RootFinders(ProgramTest):
    # Coefficients (ascending), interval, roots, and whether they are simple.
    CASES = (
        ([-6, 11, -6, 1], None, [1, 2, 3], True), ([-2, 0, 1], [0, 2], [2**0.5], True), ([1, 0, 1], None, [], True),
        ([0, -1, 1], [0, 1], [0, 1], True), ([5], None, [], True), ([-1, 2, 0, 0], None, [0.5], True),
        ([-2, 0, 1], [1.5, 2], [], True), ([1, -2, 1], None, [1], False), ([0, 0, 0, 1], [-1, 1], [0], False),
        ([0, -1e-200, 1e-200], None, [0, 1], True), ([-1e300, 1e300], [0, 2], [1], True),
    )

    @staticmethod
    def line(c: list, interval: list | None) -> str:
        return json.dumps({"c": c} | ({"interval": interval} if interval else {})) + "\n"

    def roots(self, solver: str, text: str) -> list[dict]:
        return answers(self.done("roots", "--solver", solver, text=text))

    def test_truth_finds_every_root_with_its_multiplicity(self):
        got = self.roots("truth", "".join(self.line(c, interval) for c, interval, _, _ in self.CASES))
        for answer, (c, _, expected, simple) in zip(got, self.CASES):
            self.assertEqual(answer["status"], "ok")
            self.assertEqual([float(root["x"]) for root in answer["roots"]], expected, c)
            for root in answer["roots"]:
                self.assertEqual(root["multiplicity"] == 1, simple, c)
                self.assertLessEqual(float(root["enclosure"][0]), float(root["enclosure"][1]))
        self.assertEqual(got[1]["roots"][0]["x"], "1.414213562373095048801688724209698078570")

    def test_solvers_find_simple_roots_within_their_radius(self):
        simple = [case for case in self.CASES if case[3]]
        text = "".join(self.line(c, interval) for c, interval, _, _ in simple)
        for solver in POLYNOMIAL_SOLVERS:
            for answer, (c, _, expected, _) in zip(self.roots(solver, text), simple):
                self.assertEqual(answer["status"], "ok", (solver, c))
                self.assertEqual(len(answer["roots"]), len(expected), (solver, c))
                for root, x in zip(answer["roots"], expected):
                    self.assertLessEqual(abs(root["x"] - x), root["radius"] + 2**-52 * abs(x), (solver, c))
                    self.assertLess(root["radius"], 1e-11)

    def test_a_certifying_solver_does_not_guess_at_double_roots(self):
        for answer in self.roots("interval_bisection", '{"c":[1,-2,1]}\n'):
            self.assertEqual(answer["status"], "uncertain")

    def test_the_zero_polynomial_is_coincident(self):
        for solver in (*POLYNOMIAL_SOLVERS, "truth"):
            for answer in self.roots(solver, '{"c":[0]}\n{"c":[0,0,0],"interval":[0,1]}\n'):
                self.assertEqual((answer["roots"], answer["status"]), ([], "coincident"))

    def test_bad_polynomials_end_the_run_or_are_answered_invalid(self):
        for line, word in (('{"c":[]}', "'c'"), ('{"c":1}', "'c'"), ('{"c":[1,"a"]}', "'c'"), ('{"c":[1,NaN]}', "'c'"),
                           ('{"interval":[0,1]}', "'c': missing"), ('{"c":[1,1],"interval":[1]}', "'interval'"),
                           ('{"c":[1,1],"interval":[2,1]}', "'interval'"), ('{"c":[1,1],"interval":[0,1e999]}', "'interval'"),
                           ('{"c":[1,1]', "JSON")):
            text = f'{{"c":["-0x1p0",1]}}\n{line}\n'
            for solver in ("companion", "truth"):
                result = self.refused(3, ("<stdin>:2:", word), "roots", "--solver", solver, text=text)
                self.assertEqual(len(answers(result)), 1)
                kept = answers(self.done("roots", "--solver", solver, "--keep-going", text=text))
                self.assertEqual((kept[1]["roots"], kept[1]["status"]), ([], "invalid"))
                self.assertIn(word, kept[1]["why"])

    def test_solvers_that_take_no_polynomials_say_so(self):
        self.refused(2, ("newton_slices", "polynomials"), "roots", "--solver", "newton_slices")
        self.refused(2, ("unknown solver 'nope'",), "roots", "--solver", "nope")


class Bench(ProgramTest):
    QUICK = ("--rays", "100", "--judge", "50", "--repeats", "2", "--budget-ms", "20")

    def test_json_lines_have_the_contracts_keys(self):
        lines = answers(self.done("bench", *TEARDROP, "--case", "camera,scale", "--solver",
                                  "companion,newton_slices:tries=5,seed=3,interval_bisection", *self.QUICK, "--json"))
        self.assertEqual([line["case"] for line in lines], ["camera"] * 3 + ["scale"] * 3)
        self.assertEqual([line["solver"] for line in lines[:3]],
                         ["companion", "newton_slices:tries=5,seed=3", "interval_bisection"])
        for line in lines:
            self.assertLessEqual({"surface", "case", "solver", "formulation", "precision", "query", "rays", "ns_per_ray", "hits",
                                  "wrong"}, set(line))
            self.assertEqual((line["surface"], line["precision"], line["query"]), ("teardrop:s=1", "double", "first"))
            self.assertEqual(set(line["ns_per_ray"]), {"min", "median", "p90"})
            self.assertLessEqual(line["ns_per_ray"]["min"], line["ns_per_ray"]["median"])
            self.assertGreater(line["ns_per_ray"]["min"], 0)
            self.assertEqual(line["judged"], 50)
        self.assertEqual(lines[2]["wrong"], 0)  # certified

    def test_operations_are_counted_or_absent(self):
        lines = answers(self.done("bench", "--surface", "torus:R=1,r=0.25", "--solver", "closed_form,newton_slices,certified",
                                  *self.QUICK, "--json"))
        formula, slices, certified = (line["solver_operations"] for line in lines)
        self.assertEqual(set(formula), {"total", "additions", "multiplications", "divisions", "square_roots", "fused",
                                        "functions", "comparisons", "evaluations_apart", "rays"})
        parts = [formula[key] for key in ("additions", "multiplications", "divisions", "square_roots", "functions")]
        self.assertAlmostEqual(formula["total"], sum(parts) + 2 * formula["fused"])
        self.assertGreater(formula["total"], 100)
        self.assertEqual((formula["evaluations_apart"], formula["rays"]), (0, 100))
        self.assertGreater(slices["evaluations_apart"], 1)
        # The torus' kernel, on lanes that count.
        self.assertGreater(certified["total"], 300)
        in_float = answers(self.done("bench", "--surface", "torus:R=1,r=0.25", "--solver", "companion", "--precision", "float",
                                     *self.QUICK, "--json"))
        self.assertIsNone(in_float[0]["solver_operations"])

    def test_a_ladders_tiers_are_counted_and_timed(self):
        certified, companion = answers(self.done("bench", "--surface", "sphere:radius=1", "--case", "graze", "--solver",
                                                 "certified,companion", *self.QUICK, "--json"))
        self.assertEqual(companion["tiers"], [])
        tiers = [one["tier"] for one in certified["tiers"]]
        self.assertGreaterEqual(len(tiers), 2)
        self.assertEqual(tiers, sorted(set(tiers)))
        self.assertEqual(sum(one["rays"] for one in certified["tiers"]), 100)
        for one in certified["tiers"]:
            self.assertGreater(one["ns_per_ray"]["min"], 0)

    def test_rays_are_spread_until_a_share_misses(self):
        def hits(*options):
            line = answers(self.done("bench", *TEARDROP, "--rays", "2000", "--judge", "2000", "--repeats", "1", *options,
                                     "--json"))[0]
            self.assertEqual((line["wrong"], line["judged"]), (0, 2000))
            return line["hits"]
        self.assertGreater(hits(), 600)
        self.assertAlmostEqual(hits("--misses", "0.9"), 200, delta=2)
        self.refused(2, ("--misses", "camera"), "bench", *TEARDROP, "--misses", "0.01")
        self.refused(2, ("--misses",), "bench", *TEARDROP, "--misses", "1.5")

    def test_threads_share_the_rays(self):
        line = answers(self.done("bench", *TEARDROP, "--threads", "3", *self.QUICK, "--json"))[0]
        self.assertEqual((line["threads"], line["rays"], line["censored"]), (3, 100, False))
        self.refused(2, ("--threads",), "bench", *TEARDROP, "--threads", "0")

    def test_a_table_for_people(self):
        text = self.done("bench", *TEARDROP, "--solver", "companion", *self.QUICK).stdout
        for word in ("camera", "companion", "median ns", "solver operations", "wrong"):
            self.assertIn(word, text)
        self.assertNotIn("tier", text)
        text = self.done("bench", *TEARDROP, "--solver", "certified", *self.QUICK).stdout
        self.assertRegex(text, r"tier 1: [0-9.]+ %, [0-9.]+ ns")

    def test_any_is_judged_by_presence(self):
        line = answers(self.done("bench", *TEARDROP, "--query", "any", "--solver", "certified", *self.QUICK, "--json"))[0]
        self.assertEqual((line["query"], line["wrong"], line["judged"]), ("any", 0, 50))
        self.assertGreater(line["hits"], 0)

    def test_a_wider_match_radius_forgives_more(self):
        wrong = []
        for radius in ("1e-15", "1e-6"):
            line = answers(self.done("bench", *TEARDROP, "--case", "far", "--solver", "companion", *self.QUICK,
                                     "--match-radius", radius, "--json"))[0]
            wrong.append(line["wrong"])
        self.assertGreater(wrong[0], wrong[1])
        self.refused(2, ("--match-radius",), "bench", *TEARDROP, "--match-radius", "-1")

    def peers(self) -> list[str]:
        listed = json.loads(self.done("list", "solvers", "--json").stdout)
        return [peer["name"] for peer in listed.get("peers", [])]

    def test_a_peer_that_is_not_there_is_refused_with_the_way_to_get_it(self):
        self.refused(2, ("'peer:nope'", "GRAZE_PEERS=ON"), "bench", *TEARDROP, "--solver", "peer:nope")
        self.refused(2, ("'peer:gsl'", "graze bench"), "solve", *TEARDROP, "--solver", "peer:gsl")

    def test_peers_are_compared_with_ours_in_one_run(self):
        peers = self.peers()
        if not peers:
            self.skipTest("a build without peers")
        if "peer:embree" in peers:
            peers[peers.index("peer:embree")] = "peer:embree:triangles=2000,packets=true"
        lines = answers(self.done("bench", *TEARDROP, "--solver", ",".join(["certified", *peers]), *self.QUICK, "--json"))
        self.assertEqual([line["solver"] for line in lines], ["certified", *peers])
        for line in lines:
            self.assertEqual(line["formulation"] == "triangles", "embree" in line["solver"])
            self.assertGreater(line["hits"], 0)
            if "embree" not in line["solver"]:
                self.assertEqual(line["wrong"], 0, line)

    def test_occlusion_is_judged_by_presence(self):
        if "peer:embree" not in self.peers():
            self.skipTest("a build without this peer")
        line = answers(self.done("bench", *TEARDROP, "--query", "any", "--solver", "peer:embree:triangles=20000", *self.QUICK,
                                 "--json"))[0]
        self.assertGreater(line["hits"], 0)
        self.assertLessEqual(line["wrong"], 2)  # rays at the mesh's outline

    def test_bad_requests_are_refused(self):
        self.refused(2, ("unknown solver 'compnion'",), "bench", *TEARDROP, "--solver", "companion,compnion")
        self.refused(2, ("--rays",), "bench", *TEARDROP, "--solver", "companion", "--rays", "0")
        self.refused(2, ("--surface",), "bench", "--solver", "companion")
        flat = "bezier_revolution:control_points=[[1,0],[2,3]]"
        self.refused(2, ("case 'pole' makes no sense",), "bench", "--surface", flat, "--solver", "companion", "--case", "pole")


def rows(store: Path, table: str) -> list[tuple]:
    """A table's rows in a stable order; empty while the store or the table is not there yet."""
    try:
        with sqlite3.connect(store / "run.sqlite", timeout=10) as database:
            return sorted(database.execute(f"SELECT * FROM {table}").fetchall(), key=repr)
    except sqlite3.OperationalError:
        return []


class Sweep(ProgramTest):
    RESULTS = ("record", "ray", "tally", "histogram", "cell", "family", "surface", "skipped")

    def config(self, rays: int, solvers: str, repeats: int = 1) -> str:
        return self.write("experiment.toml", EXPERIMENT.format(rays=rays, solvers=solvers, repeats=repeats))

    def sweep(self, config: str, name: str, jobs: int = 1) -> Path:
        out = self.folder / name
        self.done("sweep", config, "--out", str(out), "--jobs", str(jobs))
        return out

    def interrupt(self, config: str, out: Path) -> subprocess.CompletedProcess:
        """Starts a sweep and interrupts it once two blocks are finished."""
        with subprocess.Popen([GRAZE, "sweep", config, "--out", str(out)], stderr=subprocess.PIPE) as process:
            end = time.monotonic() + 60
            while process.poll() is None and len(rows(out, "tally")) < 2 and time.monotonic() < end:
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            _, stderr = process.communicate(timeout=60)
        return subprocess.CompletedProcess(process.args, process.returncode, "", stderr.decode())

    def test_an_interrupted_sweep_resumes_to_what_an_uninterrupted_one_gives(self):
        config = self.config(400, '"newton_slices:tries=400", "companion"')
        whole = self.sweep(config, "whole", jobs=2)
        out = self.folder / "parts"
        stopped = self.interrupt(config, out)
        self.assertEqual(stopped.returncode, 130, stopped.stderr)
        self.assertIn("run the same command to go on", stopped.stderr)
        finished = {table: rows(out, table) for table in ("tally", "record")}
        self.assertGreater(len(finished["tally"]), 0)
        self.assertLess(len(finished["tally"]), len(rows(whole, "tally")))
        self.sweep(config, "parts", jobs=2)
        for table in finished:
            self.assertLessEqual(set(finished[table]), set(rows(out, table)))
        # A block that ran twice would count twice in the histograms.
        for table in self.RESULTS:
            self.assertEqual(rows(out, table), rows(whole, table), table)
        self.assertGreater(len(rows(out, "record")), 0)

    def test_a_finished_sweep_run_again_changes_nothing(self):
        config = self.config(60, '"companion"')
        out = self.sweep(config, "out")
        tables = (*self.RESULTS, "timing", "build")
        before = {table: rows(out, table) for table in tables}
        self.assertEqual(len(before["record"]), 2 * 60 * 5)  # families x rays x formulations
        self.sweep(config, "out")
        for table in tables:
            self.assertEqual(rows(out, table), before[table], table)

    def test_results_do_not_depend_on_the_number_of_threads(self):
        config = self.config(120, '"companion", "interval_bisection"', repeats=0)
        one, four = self.sweep(config, "one"), self.sweep(config, "four", jobs=4)
        for table in self.RESULTS:
            self.assertEqual(rows(one, table), rows(four, table), table)

    def test_a_changed_experiment_needs_another_folder(self):
        out = self.sweep(self.config(10, '"companion"', repeats=0), "out")
        changed = self.write("changed.toml", (self.folder / "experiment.toml").read_text().replace("seed = 7", "seed = 8"))
        self.refused(2, ("seed = 7", "8", "--out"), "sweep", changed, "--out", str(out))

    def test_bad_configurations_are_named_with_file_and_line(self):
        text = Path(self.config(10, '"companion"')).read_text()
        for old, new, words in (
            ("seed = 7", "sed = 7", (":3:", "unknown field 'sed'", "nearest: seed")), ("seed = 7", "seed = -1", (":3:", "'seed'")),
            ("rays = 10", "rays = 1.5", (":4:", "'rays'", "whole")), ("rays = 10", "rays = 0", (":4:", "'rays'")),
            ("teardrop:s=1", "teardop:s=1", (":5:", "nearest: teardrop")), ("teardrop:s=1", "teardrop:s=0", (":5:", "'s'")),
            ('"companion"', '"compnion"', (":6:", "nearest: companion")), ('"companion"', "1", (":6:", "'solvers'")),
            ('"camera"', '"camra"', (":7:", "nearest: camera")), ("repeats = 1", "repeat = 1", (":9:", "timing.repeat")),
            ("seed = 7", "seed = ", (":3:", "TOML")), ('solvers = ["companion"]', "", ("'solvers'", "missing")),
        ):
            bad = self.write("bad.toml", text.replace(old, new, 1))
            self.refused(2, ("bad.toml", *words), "sweep", bad, "--out", str(self.folder / "never"))
        self.assertFalse((self.folder / "never").exists())
        self.refused(2, ("missing.toml",), "sweep", str(self.folder / "missing.toml"), "--out", str(self.folder / "never"))

    def test_a_folder_that_cannot_be_written_is_named(self):
        config = self.config(10, '"companion"')
        occupied = self.write("file", "not a folder")
        self.refused(4, (occupied,), "sweep", config, "--out", occupied)
        self.refused(4, (occupied,), "sweep", config, "--out", occupied + "/below")
        broken = self.folder / "broken"
        broken.mkdir()
        (broken / "run.sqlite").write_bytes(b"this is no database, and long enough to be seen as none" * 20)
        self.refused(4, ("run.sqlite",), "sweep", config, "--out", str(broken))


class Report(ProgramTest):
    def test_a_folder_without_a_run_is_refused(self):
        for folder in (self.folder, self.folder / "missing"):
            self.refused(3, (str(folder),), "report", str(folder))
        self.refused(2, ("DIR",), "report")

    def test_a_page_is_made_from_a_small_run(self):
        probe = subprocess.run(["/usr/bin/python3", "-c", "import pandas, matplotlib, jinja2"], capture_output=True, check=False)
        if probe.returncode != 0:
            self.skipTest("the report's Python packages are not installed")
        config = self.write("experiment.toml", EXPERIMENT.format(rays=30, solvers='"companion"', repeats=1))
        out = self.folder / "out"
        self.done("sweep", config, "--out", str(out))
        self.done("report", str(out), "--out", str(self.folder / "page"))
        self.assertIn("teardrop", (self.folder / "page" / "index.html").read_text())
        self.assertTrue(any((self.folder / "page" / "csv").iterdir()))
        blocked = self.write("blocked", "")
        self.refused(4, ("blocked",), "report", str(out), "--out", blocked)


class Environment(ProgramTest):
    def test_a_full_disk_is_said(self):
        for command, text in ((BY_COMPANION, ALONG_X), (("truth", *TEARDROP), ALONG_X), (("list",), ""),
                              (("roots", "--solver", "truth"), '{"c":[-1,1]}'),
                              (("bench", *TEARDROP, "--solver", "companion", *Bench.QUICK), "")):
            with open("/dev/full", "wb") as full:
                done = subprocess.run([GRAZE, *command], input=text.encode(), stdout=full, stderr=subprocess.PIPE, check=False,
                                      timeout=60)
            self.assertEqual(done.returncode, 4, command)
            self.assertIn(b"No space left on device", done.stderr)

    def test_a_folder_is_no_input_file(self):
        self.refused(4, ("Is a directory",), *BY_COMPANION, str(self.folder))


class Streaming(ProgramTest):
    """Memory stays flat for any number of rays; the rate is printed, not judged."""

    def rays(self, count: int) -> Path:
        path = self.folder / "rays.jsonl"
        block = "".join(f'{{"o":[-5,{1 + i / 4096},{i % 97 / 40 - 1.2:.4f}],"d":[1,{i % 31 / 64 - 0.25},{i % 17 / 64 - 0.1:.4f}]}}\n'
                        for i in range(1000))
        with open(path, "w") as file:
            for _ in range(count // 1000):
                file.write(block)
        return path

    def test_memory_is_flat_over_a_million_rays(self):
        # Sanitizers keep memory of their own and are slow: there the run is short and its size not judged.
        sanitized = "-fsanitize" in self.done("--version").stdout
        count = 20_000 if sanitized else 1_000_000
        path = self.rays(count)
        limit = 1 << 30

        def limit_memory():
            if not sanitized:
                resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

        start = time.monotonic()
        process = subprocess.Popen([GRAZE, *BY_COMPANION, "--query", "first", str(path)], stdout=subprocess.PIPE,
                                   preexec_fn=limit_memory)
        lines = 0
        with process.stdout as stream:
            while chunk := stream.read(1 << 20):
                lines += chunk.count(b"\n")
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        seconds = time.monotonic() - start
        print(f"\n{count} rays: {count / seconds:.0f} rays a second, {usage.ru_maxrss / 1024:.0f} MB at most", file=sys.stderr)
        self.assertEqual((process.returncode, lines), (0, count))
        if not sanitized:
            self.assertLess(usage.ru_maxrss * 1024, 100e6)


def main() -> None:
    global GRAZE
    if len(sys.argv) < 2 or not os.access(sys.argv[1], os.X_OK):
        sys.exit("usage: program_test.py PATH/TO/graze [unittest arguments]")
    GRAZE = str(Path(sys.argv.pop(1)).resolve())
    unittest.main()


if __name__ == "__main__":
    main()
