#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What debian_test.sh does within the bare Debian.
set -euo pipefail
[ -z "${DEBUG-}" ] || set -x
cd /root
step=start
trap 'echo "debian_test: FAILED: $step" >&2' ERR

say() { step=$*; echo "debian_test: $*"; }
apt() { DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 "$@" >/tmp/apt.log 2>&1 || { tail -n 20 /tmp/apt.log; false; }; }

say "apt-get update"
apt update
say "install fathom alone, without recommendations"
apt install --no-install-recommends /debs/fathom_*.deb
if command -v gcc >/dev/null; then echo "debian_test: not so bare: there is a compiler"; fi

say "the program"
fathom --version
fathom calibrate --rig sim --distances 1400,1600,1800,2000,2200,2400,2600 -o cal.json | tail -n 2
fathom range --rig sim:distance=1780 --calibration cal.json | grep '^distance 17[78]' >/dev/null
status=0
fathom focus --rig sim:target=blank >/tmp/blank || status=$?
[ $status = 3 ]
fathom snap --rig sim:target=seedling -o snap.png | grep '^exposure' >/dev/null
[ -s snap.png ]
fathom runs list | grep 'runs in' >/dev/null
[ -s /usr/share/man/man1/fathom-focus.1.gz ] || dpkg-query -L fathom | grep man1/fathom-focus.1.gz >/dev/null
(
  # shellcheck disable=SC1091
  . /usr/share/bash-completion/completions/fathom
  export COMP_LINE="fathom foc" COMP_POINT=10
  _fathom
  [ "${COMPREPLY[*]}" = focus ]
)

say "programs in C++ and C"
apt install --no-install-recommends /debs/libfathom*.deb g++ pkg-config
flags=$(pkg-config --cflags --libs fathom)
# shellcheck disable=SC2086
g++ -std=c++20 score_window.cpp -o score_window $flags
# shellcheck disable=SC2086
gcc -std=c99 focus.c -o focus $flags
printf 'P5 128 128 255\n' >plain.pgm
head -c 16384 /dev/zero >>plain.pgm
printf 'P5 128 128 255\n' >grain.pgm
od -An -v -tu1 -w1 -N16384 /usr/bin/apt-get | tr -d ' ' | awk '{printf "%c", 32 + $1 % 90}' |
  head -c 16384 >>grain.pgm
./score_window grain.pgm walsh-sequency | grep 'sharpest at' >/dev/null
./focus plain.pgm grain.pgm | grep 'sharpest: grain.pgm' >/dev/null
cat >all.cpp <<'CPP'
#include <fathom.h>
#include <fathom.hpp>
#include <cstdio>
int main() { std::printf("%s %g\n", fathom_version(), fathom::optics::image_distance_mm(135, 1500)); }
CPP
# shellcheck disable=SC2086
g++ -std=c++20 all.cpp -o all $flags
./all

say "Python"
apt install --no-install-recommends /debs/python3-fathom_*.deb
python3 -c '
import fathom, numpy
print(fathom.__version__, fathom.score(numpy.random.default_rng(1).integers(0, 255, (128, 128), dtype=numpy.uint8)))'

say "documentation"
apt install --no-install-recommends /debs/fathom-doc_*.deb
[ -s /usr/share/doc/fathom-doc/docs/ranging.md ] || dpkg-query -L fathom-doc | grep docs/ranging.md >/dev/null

say "uninstall"
apt purge fathom 'libfathom*' python3-fathom fathom-doc
left=$(find /usr /etc /var/lib -iname '*fathom*' -not -path '/var/lib/dpkg/*' -not -path '/var/lib/apt/*')
[ -z "$left" ] || { echo "left behind: $left"; false; }
say "all is well"
