#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tools/quickstart --install in a build folder that is there: what it leaves can be run and found.
#
#   quickstart_test.sh SOURCE BUILD
set -euo pipefail
source=$1 build=$2
[ "$build" = "$source/build/release" ] || { echo "quickstart_test: SKIPPED: it installs build/release"; exit 77; }

fail() { echo "quickstart_test: $*" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
"$source/tools/quickstart" --install "$work/there" >"$work/log" 2>&1 || { cat "$work/log"; fail "status $?"; }
grep -q "^distance 17[78]" "$work/log" || fail "no distance in $(cat "$work/log")"
grep -q "PATH=$work/there/bin" "$work/log" || fail "it does not say how to reach the program"
[ "$("$work/there/bin/fathom" --version)" = "$("$build/fathom" --version)" ] || fail "another program"
for file in share/man/man1/fathom-focus.1 share/man/man7/fathom-rigs.7 share/zsh/site-functions/_fathom \
  share/bash-completion/completions/fathom share/fish/vendor_completions.d/fathom.fish include/fathom.hpp; do
  [ -s "$work/there/$file" ] || fail "no $file"
done
! "$source/tools/quickstart" --install "$work/log/below" >"$work/words" 2>&1 || fail "installs below a file"
grep -q 'another PREFIX' "$work/words" || fail "says no more than $(cat "$work/words")"
