#!/usr/bin/env bash
# usage: install_and_consume.sh BUILD CONSUMER CXX GENERATOR
# Installs BUILD into a folder of its own, builds CONSUMER from there alone, runs it, looks at what it links,
# and asks for components one by one.
set -euo pipefail
readonly build=$1 consumer=$2 cxx=$3 generator=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  printf 'FAILED: %s\n' "$1" >&2
  exit 1
}

# configure NAME COMPONENT...: configures the consumer against the installed tree.
configure() {
  local -r name=$1
  shift
  cmake -G "$generator" -S "$consumer" -B "$work/$name" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$cxx" \
    -DCMAKE_PREFIX_PATH="$work/prefix" -DCONSUMER_COMPONENTS="$(IFS=';' && echo "$*")" >"$work/$name.log" 2>&1
}

cmake --install "$build" --prefix "$work/prefix" >"$work/install.log"

# The consumer as README.md shows it.
configure consumer solvers surfaces || { cat "$work/consumer.log"; fail "the consumer does not configure"; }
cmake --build "$work/consumer"
"$work/consumer/consumer" || fail "the consumer's answer is wrong"

# A consumer of one surface and one solver pays for nothing else: shared libraries, symbols, search paths.
if ldd "$work/consumer/consumer" | grep -E 'ceres|glog|gflags|boost|gmp|mpfr|sqlite'; then
  fail "the consumer links the libraries above"
fi
if nm -C "$work/consumer/consumer" | grep -iE 'ceres::|boost::|__gmp|mpfr_|sqlite3_|_registry\(\)'; then
  fail "the consumer holds the symbols above"
fi
if grep -iE '^(Ceres|Boost|GMP|SQLite)[A-Za-z0-9_]*_DIR' "$work/consumer/CMakeCache.txt"; then
  fail "the consumer looked for the packages above"
fi

# Every installed component can be asked for alone, and brings what it needs.
for file in "$work"/prefix/lib*/cmake/graze/graze-*.cmake "$work"/prefix/lib/*/cmake/graze/graze-*.cmake; do
  [[ $file =~ graze-([a-z_]+)\.cmake$ ]] || continue
  component=${BASH_REMATCH[1]}
  configure "only-$component" "$component" surfaces || { cat "$work/only-$component.log"; fail "component $component"; }
  echo "component $component: found"
done

# A component that is not there is refused by name.
if configure unknown surfaces sorcery; then fail "the unknown component was accepted"; fi
tr -s ' \n' ' ' <"$work/unknown.log" | grep -oE "has no component 'sorcery'[^.]*" ||
  { cat "$work/unknown.log"; fail "the message does not name the unknown component"; }
