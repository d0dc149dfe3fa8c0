#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Installs the host tool into a folder, and compares the files installed with it with the tool
# itself: every command and option is in the man page and in bash's completion, and the udev rule
# has the same adapters.
#
#   test/host/share.sh BUILD_DIR WORK_DIR

set -eu

build=$1
work=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
failed=

complain() {
    echo "$*"
    failed=1
}

rm -rf "$work"
cmake --install "$build" --prefix "$work" >/dev/null
tmini=$work/bin/tmini
page=$work/share/man/man1/tmini.1
completion=$work/share/bash-completion/completions/tmini
rule=$root/examples/host/share/60-tmini.rules
[ ! -e "$work/lib/udev" ] || complain "the udev rule is installed without being asked for"
for file in "$tmini" "$page" "$completion" "$rule"; do
    [ -s "$file" ] || { echo "not installed: $file"; exit 1; }
done

commands=$("$tmini" help | sed -n 's/^  tmini \([a-z]*\) .*/\1/p')
[ "$(echo "$commands" | wc -l)" -ge 11 ] || complain "the tool does not list its commands"
"$tmini" help | grep -q '.\{81\}' && complain "the list of commands is too wide"
for command in $commands; do
    "$tmini" help "$command" | grep -q '.\{81\}' && complain "the help of $command is too wide"
done
options=$(for command in $commands; do
    "$tmini" help "$command" |
        sed -n 's/^  .., *\(--[a-z-]*\) .*/\1/p; s/^      \(--[a-z-]*\) .*/\1/p'
done | sort -u)
[ "$(echo "$options" | wc -l)" -ge 14 ] || complain "the tool does not list its options"

# The man page names all of them, and its formatter accepts it.
sed 's/\\-/-/g' "$page" >"$work/page"
for command in $commands; do
    grep -q "^\.BI\{0,1\} $command\$\|^\.BI $command " "$work/page" ||
        complain "the man page lacks the command $command"
done
for option in $options; do
    grep -q -e "^\.B.*$option" "$work/page" || complain "the man page lacks the option $option"
done
if command -v groff >/dev/null; then
    warnings=$(groff -man -Tascii -ww "$page" 2>&1 >/dev/null)
    [ -z "$warnings" ] || complain "groff warns: $warnings"
fi

# offers WORD…: prints the completions of the last word.
offers() {
    PATH=$work/bin:$PATH bash -c '
        source "$1"; shift
        COMP_WORDS=(tmini "$@"); COMP_CWORD=$#
        _tmini tmini; printf "%s\n" "${COMPREPLY[@]}"' _ "$completion" "$@"
}

if command -v bash >/dev/null; then
    for command in $commands; do
        offers "$(printf %.3s "$command")" | grep -qx "$command" ||
            complain "bash does not complete the command $command"
        for option in $("$tmini" help "$command" | sed -n 's/^ .*\(--[a-z-]*\) .*/\1/p'); do
            offers "$command" --quiet "$option" | grep -qx -e "$option" ||
                complain "bash does not complete $option of $command"
        done
    done
    [ "$(offers scan --js)" = --json ] || complain "bash offers more than --json for scan --js"
    for port in -p --port; do
        [ "$(offers "$port" /dev/x deco)" = decode ] || complain "bash takes the port for a command"
    done
    [ -z "$(offers info --cs)" ] || complain "bash offers --csv for info"
    cd "$work"
    touch "room one.bin"
    [ "$(offers decode room)" = "room one.bin" ] || complain "bash does not complete files"
fi

# The udev rule and the tool have the same adapters.
sed -n 's/.*idVendor}=="\(....\)".*idProduct}=="\(....\)".*/\1:\2/p' "$rule" | sort >"$work/ruled"
grep -o '"[0-9a-f]\{4\}:[0-9a-f]\{4\}"' "$root/examples/host/ports.c" | tr -d '"' |
    sort >"$work/known"
cmp "$work/ruled" "$work/known" || complain "rule and tool know different adapters"
sed -n 's/.*idVendor}=="\(....\)".*idProduct}=="\(....\)".*/\1:\2/p' \
    "$root/examples/host/share/95-tmini-brltty.rules" | sort | cmp - "$work/known" ||
    complain "the rule against brltty and the tool know different adapters"
! grep -q SYMLINK "$root"/examples/host/share/*.rules || complain "a rule makes a link"
grep -q 'ID_MM_DEVICE_IGNORE}="1"' "$rule" || complain "ModemManager is not kept away"

[ -z "$failed" ] || exit 1
echo "what is installed fits together"
