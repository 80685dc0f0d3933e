# SPDX-License-Identifier: BSD-3-Clause
# Source this: `usage FEWEST MOST "$@"` prints the script's head comment and ends with 0 where --help is asked for, and ends with 2 where
# there are fewer or more words, or one that looks like an option and is none of `known_options`.
known_options=
usage() {
  local fewest=$1 most=$2 word wrong=
  shift 2
  for word in "$@"; do
    case $word in
      -h | --help)
        sed -n '3,/^[^#]/{s/^# \{0,1\}//p}' "$0"
        exit 0
        ;;
      -*) [[ " $known_options " == *" $word "* ]] || wrong="unknown option $word" ;;
    esac
  done
  (($# >= fewest && $# <= most)) || wrong=${wrong:-"$# words, must be $fewest$( ((most == fewest)) || echo " to $most")"}
  [[ -z $wrong ]] || { echo "$(basename "$0"): $wrong" >&2; sed -n '3{s/^# \([^:]*\):.*/usage: \1/p}' "$0" >&2; exit 2; }
}
