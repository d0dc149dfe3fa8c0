#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Makes the simulated lidar's recordings, each with a list of all samples sent:
#
#   test/recordings/make.sh TMINI_SIM DIR      for example: make.sh build/bin/tmini-sim /tmp/new
#
# With a third argument, a folder, fails unless its recordings are the same.

set -eu

sim=$1
dir=$2
mkdir -p "$dir"

# make NAME OPTION…
make() {
    name=$1
    shift
    "$sim" --write "$dir/$name.bin" --truth "$dir/$name.csv" "$@"
}

make sim-6hz --seconds 2 --seed 1
make sim-10hz-plain --seconds 1.5 --seed 2 --frequency 10 --no-ct
make sim-12hz --seconds 1.5 --seed 3 --frequency 12
make sim-6hz-damaged --seconds 3 --seed 4 --fault drop=3e-4 --fault flip=3e-4 \
    --fault insert=3e-4 --fault cut=2 --fault burst=1

if [ $# -gt 2 ]; then
    for name in sim-6hz sim-10hz-plain sim-12hz sim-6hz-damaged; do
        cmp "$dir/$name.bin" "$3/$name.bin"
    done
fi
