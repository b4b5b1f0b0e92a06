#!/usr/bin/python3
"""Entry point: graze_report.py STORE_DIR [--out DIR].

Exit codes as every graze command: 0 done, 2 wrong usage, 3 bad input data, 4 environment.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import sys
from pathlib import Path

EXIT_DATA = 3
EXIT_ENVIRONMENT = 4
NEEDED = ("pandas", "matplotlib", "jinja2")
DEBIAN_PACKAGES = "python3-pandas python3-matplotlib python3-jinja2 libjs-chart.js"


def fail(code: int, message: str) -> int:
    """Says why on stderr and hands back the exit code."""
    print(f"graze report: {message}", file=sys.stderr)
    return code


def missing_packages() -> list[str]:
    """Names of the needed Python packages that this Python cannot find."""
    return [name for name in NEEDED if importlib.util.find_spec(name) is None]


def parse_arguments(arguments: list[str] | None) -> argparse.Namespace:
    """The command line; argparse exits with 2 on wrong usage."""
    parser = argparse.ArgumentParser(
        prog="graze report", description="Makes index.html, csv/ and figures/ from the store of one run."
    )
    parser.add_argument("store", metavar="DIR", type=Path, help="folder of the run (holds run.sqlite)")
    parser.add_argument("--out", type=Path, help="where to write (default: DIR/report)")
    return parser.parse_args(arguments)


def main(arguments: list[str] | None = None) -> int:
    """Runs the report and returns the exit code."""
    options = parse_arguments(arguments)
    absent = missing_packages()
    if absent:
        return fail(EXIT_ENVIRONMENT, f"Python lacks {', '.join(absent)}: install {DEBIAN_PACKAGES}.")

    # The folder is imported as a package, so that its statistics.py never hides Python's own module.
    here = Path(__file__).resolve().parent
    sys.path[:] = [str(here.parent)] + [p for p in sys.path if p == "" or Path(p).resolve() != here]
    load = importlib.import_module(f"{here.name}.load")
    page = importlib.import_module(f"{here.name}.page")

    default = options.store / "report" if options.store.is_dir() else options.store.parent / "report"
    try:
        written = page.write_report(load.read_store(options.store), options.out or default)
    except load.StoreError as error:
        return fail(EXIT_DATA, str(error))
    except page.MissingLibrary:
        return fail(EXIT_ENVIRONMENT, f"chart.min.js is not installed: install {DEBIAN_PACKAGES}.")
    except OSError as error:
        return fail(EXIT_ENVIRONMENT, f"cannot write {error.filename or options.out}: {error.strerror}.")
    print(written)
    return 0


if __name__ == "__main__":
    sys.exit(main())
