#!/bin/sh
# Instructions a particle-step takes, counted by valgrind: where wall time is too noisy to gate on, these repeat to
# the digit. The counts in the table are this program's own earlier ones; a change beyond the tolerance, for better or
# worse, asks for a new table in the same commit. They hold for the compiler named in the table only.
#
# Rows whose law is followed by +FEATURE have that feature; the others have none. What a feature that is left out costs
# cannot be compared with a step that does not know the feature, for there is none: it is compared with the table, and
# may move a step without features by no more than 2 %. So may every feature that is added later.
# usage: instructions_test.sh PROBE TABLE COMPILER [--write]
set -eu
probe=$1 table=$2 compiler=$3 write=${4:-}
tolerance_without=2 tolerance_with=4  # percent; inlining alone moves 4 when unrelated code of the same file changes
few=4 many=24 particles=552  # of the probe's footing

count() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$probe" "$@" 2>&1 >/dev/null |
    awk '/Collected/ { print $NF }'
}

command -v valgrind >/dev/null || { echo 'skipped: no valgrind here'; exit 77; }
grep -qw avx2 /proc/cpuinfo || { echo 'skipped: the probe needs AVX2'; exit 77; }
if [ -z "$write" ] && ! grep -qxF "# $compiler" "$table"; then
  echo "skipped: the table is for another compiler than $compiler"; exit 77
fi
[ -n "$write" ] && printf '# %s\n' "$compiler"
status=0
while read -r scheme order law expected; do
  case $scheme in '#'*) continue ;; esac
  short=$(count "$scheme" "$order" "$law" $few)
  long=$(count "$scheme" "$order" "$law" $many)
  [ -n "$short" ] && [ -n "$long" ] || { echo "nothing counted for $scheme $order $law"; exit 2; }
  found=$(((long - short) / (many - few) / particles))
  if [ -n "$write" ]; then
    echo "$scheme $order $law $found"
    continue
  fi
  case $law in *+*) tolerance=$tolerance_with ;; *) tolerance=$tolerance_without ;; esac
  change=$(((found - expected) * 100))
  verdict=
  if [ $change -gt $((tolerance * expected)) ] || [ $change -lt $((-tolerance * expected)) ]; then
    verdict=' - beyond the tolerance' status=1
  fi
  echo "$scheme $order $law: $found instructions a particle-step, $expected in the table$verdict"
done <"$table"
exit $status
