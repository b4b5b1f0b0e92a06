#!/usr/bin/env bash
# usage: one_surface_is_small.sh SOURCE CXX GENERATOR
# A renderer that wants the sphere and its closed form pays for nothing else: builds those two alone, from
# the standard library and Eigen, and weighs the libraries.
set -euo pipefail
readonly source=$1 cxx=$2 generator=$3
readonly most=300000 # bytes, the promise of surfaces/sphere.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake -G "$generator" -S "$source" -B "$work" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$cxx" \
  -DGRAZE_SURFACES=sphere -DGRAZE_SOLVERS=closed_form -DGRAZE_CERES=OFF -DGRAZE_BOOST_ROOTS=OFF \
  -DGRAZE_TRUTH=OFF -DGRAZE_PROGRAM=OFF \
  -DGRAZE_TESTS=OFF >"$work/configure.log" 2>&1 || { cat "$work/configure.log"; exit 1; }
cmake --build "$work" -j1 >"$work/build.log" 2>&1 || { cat "$work/build.log"; exit 1; }

# Archives carry symbol tables and relocations that no program gets, so both are put whole into one stripped
# shared library, which is more than any program links of them.
"$cxx" -shared -s -o "$work/sphere.so" -Wl,--whole-archive "$work/surfaces/libgraze_surfaces.a" \
  "$work/solvers/libgraze_solvers.a" -Wl,--no-whole-archive
total=$(stat -c %s "$work/sphere.so")
printf 'sphere and closed_form: %d bytes, at most %d\n' "$total" "$most"
if ldd "$work/sphere.so" | grep -vE 'linux-vdso|libstdc\+\+|libgcc_s|libm\.|libc\.|ld-linux'; then
  echo "FAILED: the libraries above are no part of the standard library" >&2
  exit 1
fi
"$(dirname "$0")/minimal_links_nothing.sh" "$work"
((total < most)) || { echo "FAILED: too large" >&2; exit 1; }
