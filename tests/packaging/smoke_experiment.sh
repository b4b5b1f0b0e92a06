#!/usr/bin/env bash
# usage: smoke_experiment.sh GRAZE CONFIG
# From the command line to a report: one ray by hand, a small experiment, the same again, its page.
set -euo pipefail
readonly graze=$1 config=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  printf 'FAILED: %s\n' "$1" >&2
  exit 1
}

# By hand, from (-5, 1.5, 0) along x: l = 25/8 and 55/8.
readonly ray='{"o":[-5,1.5,0],"d":[1,0,0]}'
"$graze" solve --surface teardrop:s=1 --solver companion --query all <<<"$ray" | tee "$work/hits"
[[ $(grep -o '"l":3.125\b\|"l":6.875\b' "$work/hits" | wc -l) == 2 ]] || fail "solve: l = 3.125 and 6.875"
"$graze" truth --surface teardrop:s=1 --query all <<<"$ray" | tee "$work/truth"
[[ $(grep -oE '"l":"(3.125|6.875)0*"' "$work/truth" | wc -l) == 2 ]] || fail "truth: l = 3.125 and 6.875"

# A second run finds everything finished and adds no record.
"$graze" sweep "$config" --out "$work/run" --jobs 2
readonly count='import sqlite3, sys; print(sqlite3.connect(sys.argv[1]).execute("select count(*) from record").fetchone()[0])'
records=$(/usr/bin/python3 -c "$count" "$work/run/run.sqlite")
((records > 0)) || fail "the sweep kept no record"
"$graze" sweep "$config" --out "$work/run" --jobs 2
[[ $(/usr/bin/python3 -c "$count" "$work/run/run.sqlite") == "$records" ]] || fail "the second sweep changed the records"

"$graze" report "$work/run"
for file in index.html csv figures; do
  [[ -s $work/run/report/$file || -d $work/run/report/$file ]] || fail "the report lacks $file"
done
echo "$records records, report made"
