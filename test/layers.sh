#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Checks that the library's files call only files below them, that each group of members of tmini_t
# is written only by the file that owns it, and that ports and examples use no member:
#
#   test/layers.sh LIBRARY.a
#
# The table below lists the allowed calls: FILE, then the files that it may call. Any other call is
# an error, so there are no circular calls. Calls are read from the objects' symbols.

set -eu

archive=$1
root=$(cd "$(dirname "$0")/.." && pwd)

may_call='
tmini_ring
tmini_frame     tmini_ring
tmini_parser    tmini_ring tmini_frame
tmini_packet    tmini_ring tmini_frame
tmini_reply
tmini_ct
tmini_builder   tmini_ring tmini_packet
tmini_decoder   tmini_parser tmini_packet tmini_ct tmini_builder
tmini_line      tmini_ring
tmini_command   tmini_ring tmini_parser tmini_reply
tmini_recovery  tmini_command
tmini_monitor   tmini_packet tmini_ct
tmini           tmini_ring tmini_parser tmini_frame tmini_packet tmini_reply tmini_ct tmini_decoder
tmini           tmini_command tmini_recovery tmini_monitor tmini_line tmini_builder
tmini_blocking  tmini tmini_command
tmini_sectors   tmini_packet tmini_frame
tmini_ranges
tmini_mount
tmini_cartesian
tmini_fields    tmini_cartesian
tmini_isolated
tmini_steps
tmini_names
tmini_units
'

# Prints "FILE SYMBOL TYPE" of every symbol in the archive.
symbols() {
    nm -A "$archive" |
        sed -n 's/^[^:]*:\([a-z_]*\)\.c\.o:[0-9a-f ]* \([A-Za-z]\) \([a-z_0-9]*\)$/\1 \3 \2/p'
}

calls=$({
    printf '%s\n' "$may_call" | sed 's/^/allow /'
    symbols | sed 's/^/symbol /'
} | awk '
    $1 == "allow" && NF > 1 { known[$2] = 1; for (i = 3; i <= NF; i++) allowed[$2, $i] = 1 }
    $1 == "symbol" && $4 ~ /[TRDB]/ { owner[$3] = $2; files[$2] = 1 }
    $1 == "symbol" && $4 == "U" { uses[$2, $3] = 1 }
    END {
        for (file in files) if (!(file in known)) print "not in the table of layers: " file ".c"
        for (use in uses) {
            split(use, part, SUBSEP)
            callee = owner[part[2]]
            if (callee != "" && callee != part[1] && !((part[1], callee) in allowed))
                print part[1] ".c must not call " part[2] "() of " callee ".c"
        }
        for (file in known) if (!(file in files)) print "no such file in the library: " file ".c"
    }')

# written_outside MEMBER OWNER: prints assignments to lidar->MEMBER in files other than OWNER. OWNER
# is - if the owner gets only a pointer to the member and does not use tmini_t.
written_outside() {
    for file in "$root"/lib/src/*.c; do
        [ "$(basename "$file")" = "$2" ] ||
            grep -nE -e "lidar->$1\.[a-z_.]+ *([-+|&]?=[^=]|\+\+|--)" \
                -e "tmini_$1_t \*const [a-z]+ = &lidar" "$file" |
            grep -v "const tmini_$1_t" |
            sed "s|^|$(basename "$file"):|; s|$|  (only $2 writes lidar->$1)|"
    done
}

written=$(
    written_outside command tmini_command.c
    written_outside recovery tmini_recovery.c
    written_outside monitor -
    written_outside link tmini.c
    written_outside ring -
    written_outside line tmini_line.c
    written_outside decoder -
)

members=$(sed -n '/^struct tmini_lidar {/,/^};/s/^ .*[ *]\([a-z_]*\);.*/\1/p' \
    "$root/lib/include/tmini/tmini.h" | paste -s -d '|' -)
# A name followed by ( is a method of a class, not a member of tmini_t.
access="(lidar|driver)_?(\[[a-z0-9]+\])?(\.|->)($members)([^a-z_(]|\$)"
touched=$(cd "$root" && grep -rnE --include='*.[ch]' --include='*.cpp' --include='*.ino' \
    --include='*.py' "$access" port examples |
    sed 's|$|  (members of tmini_t are private)|')

if [ -n "$calls$written$touched" ]; then
    printf '%s\n' "$calls" "$written" "$touched"
    exit 1
fi
echo "every call goes downwards, every member has one writer, and ports and examples touch none"
