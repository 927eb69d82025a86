#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What libfathom.so shows is what its public headers declare, and nothing else; and nothing that abi.txt lists is
# gone, for programs that are built already may call it.
#
#   exports_test.sh LIBFATHOM HEADERS...
#   exports_test.sh --write LIBFATHOM     makes abi.txt anew: after FATHOM_ABI was raised, or names were added
#
# FATHOM_ABI_COMPLETE=1: what is shown and not yet listed is a failure, too (a release lists all).
set -euo pipefail
list=$(dirname "$0")/abi.txt

# Functions and data that programs link with: not what the compiler makes of inline code as it likes.
strong_names() { nm -DC --defined-only "$1" | sed -n 's/^[0-9a-f]* [TDBR] //p' | LC_ALL=C sort -u; }

if [ "$1" = --write ]; then
  strong_names "$2" >"$list"
  exit
fi
library=$1
shift

fail() { echo "exports_test: $*" >&2; exit 1; }

names=$(nm -DC --defined-only "$library" | cut -c20- | sort -u)
foreign=$(grep -vE '^((typeinfo|typeinfo name|vtable) for )?fathom(::|_)' <<<"$names" || true)
[ -z "$foreign" ] || fail "names that are not its own: $foreign"

# The class or function right behind fathom:: and its namespaces stands in a public header.
roots=$(grep -oE 'fathom::(optics::)?[A-Za-z_0-9]+' <<<"$names" | sed 's/.*:://' | sort -u)
declared=$(cat "$@" | grep -oE '[A-Za-z_0-9]+' | sort -u)
hidden=$(comm -23 <(echo "$roots") <(echo "$declared"))
[ -z "$hidden" ] || fail "names that no public header declares: $hidden"

# And what a program needs is there: one name of each kind.
for wanted in fathom_score fathom::read_picture fathom::optics::airy_radius_um fathom::Plan::submit \
  'typeinfo for fathom::Error' 'vtable for fathom::Observer' fathom::Session::focus; do
  grep -q "^$wanted" <<<"$names" || fail "no $wanted"
done

gone=$(LC_ALL=C comm -13 <(strong_names "$library") "$list")
[ -z "$gone" ] || fail "programs may call what is no longer there (raise FATHOM_ABI, then --write): $gone"
new=$(LC_ALL=C comm -23 <(strong_names "$library") "$list")
[ -z "$new" ] || [ "${FATHOM_ABI_COMPLETE:-0}" != 1 ] || fail "not listed yet (--write): $new"

count=$(wc -l <<<"$names")
[ "$count" -lt 600 ] || fail "$count names; is something shown that need not be?"
echo "$count names"
