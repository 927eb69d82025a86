#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tools/site makes pages whose links all lead somewhere, says of one that does not, and their search finds things.
#
#   site_test.sh SOURCE    exits 77 where cmark-gfm or Doxygen are missing
set -euo pipefail
source=$1

for need in cmark-gfm doxygen; do
  command -v "$need" >/dev/null || { echo "skipped: no $need here (tools/bootstrap --site)"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
site=$work/site

fail() {
  echo "site_test: $*" >&2
  exit 1
}

"$source/tools/site" --as-is "$site"
[ -s "$site/reference/classfathom_1_1Scorer.html" ] || fail "the reference lacks fathom::Scorer"
grep -q fathom_open "$site/reference/fathom_8h.html" || fail "the reference lacks fathom_open"
grep -q 'id="from-a-clone"' "$site/install.html" || fail "a heading has no name"

# What is somebody else's is not emptied.
mkdir "$work/mine"
touch "$work/mine/letter"
! "$source/tools/site" --as-is "$work/mine" 2>/dev/null || fail "a folder with something else was taken"
[ -e "$work/mine/letter" ] || fail "a folder with something else was emptied"

# The check of links can fail, for pages and for names in them.
echo '<a href="nobody.html">x</a><a href="install.html#nowhere">y</a>' >"$site/wrong.html"
! PYTHONDONTWRITEBYTECODE=1 python3 "$source/packaging/site/links.py" "$site" >"$work/links" || fail "broken links pass"
[ "$(grep -c '^leads nowhere: wrong.html: ' "$work/links")" = 2 ] || fail "not both broken links are named"

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$browser" ]; then
  echo "skipped: the search was not tried: no Chromium here (tools/bootstrap --dev)"
  exit 77
fi
"$browser" --headless --no-sandbox --disable-gpu --user-data-dir="$work/browser" --virtual-time-budget=10000 --dump-dom \
  "file://$site/search.html?q=backlash+play" >"$work/found.html" 2>"$work/complaints"
grep -q 'places have all of: backlash play' "$work/found.html" || { tail "$work/complaints"; fail "the search did not run"; }
grep -q '<a href="glossary.html#' "$work/found.html" || fail "the search does not find the glossary's backlash"
