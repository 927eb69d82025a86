#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What bash, zsh and fish offer behind "fathom ", and whether man takes its pages. Shells that are not there
# are skipped with a word.
#
#   completion_test.sh FATHOM
set -euo pipefail
program=$1

fail() { echo "completion_test: $*" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$program" help --write "$work/share"
cd "$work"
mkdir stack
touch rig.toml

# offers LINE WORDS: what stands behind the cursor's end, sorted.
offers() {
  local given
  given=$(
    # shellcheck disable=SC1091
    . "$work/share/bash-completion/completions/fathom"
    COMP_LINE=$1 COMP_POINT=${#1}
    _fathom
    printf '%s\n' "${COMPREPLY[@]}" | LC_ALL=C sort | tr '\n' ' '
  )
  [ "${given% }" = "$2" ] || fail "bash: '$1' gives '${given% }', not '$2'"
}

offers "fathom foc" "focus"
offers "fathom focus --ri" "--rig"
offers "fathom focus --rig si" "sim"
offers "fathom focus --rig replay:st" "stack"
offers "fathom focus --rig=ri" "rig.toml"
offers "fathom focus --search gol" "golden"
offers "fathom focus --json --metric walsh-seq" "walsh-sequency walsh-sequency:64"
offers "fathom bench --depth " "16 8"
offers "fathom focus --from " ""
offers "fathom rigs " "check home list"
offers "fathom rigs check --js" "--json"
offers "fathom help sea" "searches"
offers "fathom runs show la" "last"

if command -v fish >/dev/null; then
  given=$(HOME=$work fish -c "source share/fish/vendor_completions.d/fathom.fish
    complete -C 'fathom foc'; complete -C 'fathom rigs ch'; complete -C 'fathom focus --sear'
    complete -C 'fathom focus --search gol'" 2>/dev/null | cut -f1 | tr '\n' ' ')
  [ "$given" = "focus check --search golden " ] || fail "fish gives '$given'"
else
  echo "SKIPPED: no fish here"
fi

if command -v zsh >/dev/null; then
  zsh -n share/zsh/site-functions/_fathom || fail "zsh cannot read its file"
  given=$(zsh -f -c 'compdef() { :; }; source share/zsh/site-functions/_fathom
    compadd() { shift; [[ $1 == -- ]] && shift; print -r -- ${(M)@:#gol*}; }; compset() { false; }; _files() { :; }
    words=(fathom focus --search gol) CURRENT=4; _fathom')
  [[ $given == golden* ]] || fail "zsh gives '$given'"
else
  echo "SKIPPED: no zsh here"
fi

if command -v mandoc >/dev/null; then
  # Pages carry no date, so that a build comes out alike on any day.
  words=$(mandoc -T lint -W warning share/man/man?/* | grep -v 'missing date' || true)
  [ -z "$words" ] || fail "mandoc: $words"
else
  echo "SKIPPED: no mandoc here"
fi
for page in focus rigs-check runs-prune; do [ -s "share/man/man1/fathom-$page.1" ] || fail "no page on $page"; done
