#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the packages in a bare Debian 12 and uses them as a stranger would: the program, its pages and
# completion, programs in C++ and C, Python; then removes them. Needs root and a mirror, or says what is missing.
#
#   debian_test.sh FOLDER_WITH_DEBS [ROOT]
#
# ROOT: a folder with a bare Debian 12, which is copied; else debootstrap fetches one, from $DEBIAN_MIRROR.
set -euo pipefail
packages=$1 root=${2-}
here=$(cd "$(dirname "$0")" && pwd)
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}

skip() { echo "debian_test: SKIPPED: $*"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "needs root for chroot"
[ -n "$root" ] || command -v debootstrap >/dev/null || skip "needs debootstrap (apt-get install debootstrap)"

work=$(mktemp -d)
bare=$work/root
leave() {
  mountpoint -q "$bare/proc" && umount "$bare/proc"
  rm -rf --one-file-system "$work"
}
trap leave EXIT

if [ -n "$root" ]; then
  cp -a "$root" "$bare"
else
  echo "debian_test: fetching a bare Debian 12"
  debootstrap --variant=minbase bookworm "$bare" "$mirror" >"$work/log" 2>&1 ||
    { tail -n 5 "$work/log"; skip "debootstrap cannot fetch from $mirror"; }
fi
# What the machine goes out by, a proxy or another mirror, serves in there, too.
cp /etc/resolv.conf "$bare/etc/resolv.conf" 2>/dev/null || true
grep -ls '^ *Acquire' /etc/apt/apt.conf.d/* | xargs -r cp -t "$bare/etc/apt/apt.conf.d/"
mount -t proc proc "$bare/proc" || skip "may not mount /proc"
mkdir "$bare/debs"
cp "$packages"/*.deb "$bare/debs/"
cp "$here/../../examples/"{score_window.cpp,focus.c} "$bare/root/"
cp "$here/debian_steps.sh" "$bare/root/"
env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
  DEBUG="${DEBUG-}" http_proxy="${http_proxy-}" https_proxy="${https_proxy-}" \
  chroot "$bare" bash /root/debian_steps.sh
