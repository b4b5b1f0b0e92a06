#!/usr/bin/env bash
# usage: minimal_links_nothing.sh BUILD
# What a build without Ceres, truth and program must not refer to, whether by symbol or by shared library.
set -euo pipefail
readonly build=$1
readonly libraries='ceres|glog|gflags|boost|gmp|mpfr|mpfi|flint|arb|sqlite'
readonly symbols='ceres::|google::|boost::|__gmp|mpfr_|mpfi_|fmpz_|sqlite3_'

mapfile -t archives < <(find "$build" -name '*.a')
mapfile -t programs < <(find "$build" -path '*/CMakeFiles' -prune -o -type f -executable -print |
  while read -r file; do if [[ $(head -c 4 "$file") == $'\x7fELF' ]]; then echo "$file"; fi; done)
if ((${#archives[@]} == 0)); then
  echo "FAILED: nothing to look at in $build" >&2
  exit 1
fi

failures=0
for file in "${archives[@]}" "${programs[@]}"; do
  if nm -C "$file" 2>/dev/null | grep -E "$symbols"; then
    printf 'FAILED: %s holds the symbols above\n' "$file" >&2
    failures=$((failures + 1))
  fi
done
for file in "${programs[@]}"; do
  if ldd "$file" | grep -E "lib($libraries)"; then
    printf 'FAILED: %s links the libraries above\n' "$file" >&2
    failures=$((failures + 1))
  fi
done
printf '%d libraries and %d programs looked at, %d findings\n' ${#archives[@]} ${#programs[@]} $failures
exit $((failures > 0))
