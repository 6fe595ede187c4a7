#!/bin/sh
# The solver built for other instruction sets gives the same results but for round-off.
# usage: portable_test.sh NATIVE_PROBE SCRATCH_DIRECTORY PROBE...
# The tolerance: 200 steps add some 200 x 16 roundings of 1e-16 to every sum, and stresses near the yield limit lose a few
# digits more; 5e-12 was seen. A wrong term is of order one.
set -eu
native=$1 scratch=$2
shift 2
steps=200 tolerance=1e-9
mkdir -p "$scratch"
for probe in "$@"; do
  case $probe in *x86_64_v3) grep -qw avx2 /proc/cpuinfo || { echo "$probe left out: no AVX2 here"; continue; } ;; esac
  for scheme in mpm ugimp cpgimp; do
    for order in usl usf musl; do
      for law in elastic mohr_coulomb; do
        echo "$(basename "$probe") $scheme $order $law"
        "$probe" $scheme $order $law $steps >"$scratch/state"
        "$native" $scheme $order $law $steps "$scratch/state" $tolerance
      done
    done
  done
done
