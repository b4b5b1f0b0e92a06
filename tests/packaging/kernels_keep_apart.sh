#!/usr/bin/env bash
# usage: kernels_keep_apart.sh BUILD
# What is compiled for one instruction set must not be linked into the code for another: an object of lanes defines
# nothing that the linker could merge with another object's, outside of its own namespace.
set -euo pipefail
objects=0 findings=0
while read -r object; do
  objects=$((objects + 1))
  set=$(sed -E 's|.*_lanes_([a-z0-9]+)\.dir/.*|\1|' <<<"$object")
  while read -r line; do
    echo "$object: $line"
    findings=$((findings + 1))
  done < <(nm -C --defined-only "$object" | grep -E ' [TWVu] ' | grep -vE " [TWVu] graze::$set::" || true)
done < <(find "$1" -path '*_lanes_*.dir/*.o')
echo "$objects objects looked at, $findings findings"
((objects > 0 && findings == 0)) || { echo "FAILED" >&2; exit 1; }
