# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=bash
#
# bash completion for tmini: commands, options, ports and files.

_tmini()
{
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=
    local i
    for ((i = 1; i < COMP_CWORD; i++)); do
        case ${COMP_WORDS[i]} in
            -*) ;;
            *)
                case ${COMP_WORDS[i - 1]} in # An option's value is no command.
                    -[pnso] | --port | --count | --seconds | --output) ;;
                    --stats | --scan | --max-samples | --front | --offset | --mask) ;;
                    *) command=${command:-${COMP_WORDS[i]}} ;;
                esac
                ;;
        esac
    done
    case $before in
        -p | --port)
            mapfile -t COMPREPLY < <(compgen -W \
                "$("$1" ports 2>/dev/null | sed 's/  (.*//')" -- "$word")
            return
            ;;
        -n | --count | -s | --seconds | --scan | --max-samples | --front | --offset | --mask) return ;;
        -o | --output | --stats)
            mapfile -t COMPREPLY < <(compgen -f -- "$word")
            return
            ;;
    esac
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$("$1" help ${command:+"$command"} 2>/dev/null |
            sed -n 's/^  -., \(--[a-z-]*\) .*/\1/p; s/^      \(--[a-z-]*\) .*/\1/p')" -- "$word")
    elif [[ -z $command || $command == help ]]; then
        mapfile -t COMPREPLY < <(compgen -W "help $("$1" help 2>/dev/null |
            sed -n 's/^  tmini \([a-z]*\) .*/\1/p')" -- "$word")
    else
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
    fi
}

complete -o filenames -F _tmini tmini
