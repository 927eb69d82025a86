#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the build into a fresh folder and uses it as a stranger would: every header by itself, the
# examples through find_package and through pkg-config, the C interface from Python, the program.
#
#   install_test.sh CMAKE SOURCE BUILD CC CXX PYTHON
set -euo pipefail
cmake=$1 source=$2 build=$3 cc=$4 cxx=$5 python=$6

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix

fail() { echo "install_test: $*" >&2; exit 1; }

# expect TEXT COMMAND...: the command succeeds and its output contains the text.
expect() {
  local wanted=$1 output
  shift
  output=$("$@" 2>&1) || fail "status $? of: $*: $output"
  [[ $output == *"$wanted"* ]] || fail "no '$wanted' in the output of: $*: $output"
}

# Two 128 x 128 pictures: corner.pgm is black with fine grain in its lower right quarter, which is thus its
# sharpest window; plain.pgm is all black.
make_pictures() {
  "$python" - "$1" <<'PYTHON'
import pathlib, random, sys
grain, side = random.Random(1), range(128)
corner = bytes(grain.randrange(256) if x >= 64 and y >= 64 else 0 for y in side for x in side)
for name, pixels in ("corner", corner), ("plain", bytes(128 * 128)):
    pathlib.Path(sys.argv[1], f"{name}.pgm").write_bytes(b"P5 128 128 255\n" + pixels)
PYTHON
}

# expect_answers FOLDER: the examples built there give what the pictures were made to give.
expect_answers() {
  expect "sharpest at 64,64,64" "$1/score_window" "$work/corner.pgm" walsh-sequency
  expect "sharpest: $work/corner.pgm" "$1/focus" "$work/plain.pgm" "$work/corner.pgm"
}

# expect_page_answers FOLDER: so do those of docs/use-it-from-your-program.md, whose pictures are their own.
expect_page_answers() {
  expect "fft:64:hann: focus quality 0.000950" "$1/one_window"
  # Two coefficients of 80 / sqrt(2), squared, over the 356 of that ring; and nothing elsewhere.
  expect "up to 0.2500 cycles per pixel: 17.98" "$1/ring_powers"
  expect "sharpest of 40 frames: 25" "$1/stream"
  expect "cpu:0" "$1/choose_device" cpu
  ! "$1/choose_device" nonsense 2>"$work/log" || fail "choose_device takes nonsense"
  grep -q 'no backend "nonsense"; there are auto, cpu' "$work/log" || fail "choose_device: $(cat "$work/log")"
  expect "all alike, to the last bit" "$1/threads"
  expect "16 windows, 8 numbers each" "$1/windows"
  if [ -x "$1/opencv_mat" ]; then
    expect "the first is sharper" "$1/opencv_mat"
  else
    echo "SKIPPED: opencv_mat needs libopencv-imgproc-dev"
  fi
}

"$cmake" --install "$build" --prefix "$prefix" >"$work/log" || fail "cmake --install failed"
make_pictures "$work"

echo "the program"
expect "fathom" "$prefix/bin/fathom" --help

for file in man/man1/fathom.1 man/man1/fathom-rigs-check.1 man/man7/fathom-searches.7 \
  bash-completion/completions/fathom fish/vendor_completions.d/fathom.fish doc/fathom-doc/README.md; do
  [ -s "$prefix/share/$file" ] || fail "no share/$file"
done

echo "every header by itself"
while IFS= read -r header; do
  language=c++ standard=c++20 compiler=$cxx
  [[ $header == *.h ]] && { language=c standard=c99 compiler=$cc; }
  echo "#include <${header#"$prefix/include/"}>" |
    "$compiler" -x $language -std=$standard -Wall -Wextra -Wpedantic -Werror -fsyntax-only \
      -I "$prefix/include" - || fail "$header does not stand alone"
done < <(find "$prefix/include" -name '*.h' -o -name '*.hpp' | sort)

echo "find_package"
"$cmake" -S "$source/examples" -B "$work/examples" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" >"$work/log" \
  || { cat "$work/log"; fail "the examples do not configure"; }
"$cmake" --build "$work/examples" >"$work/log" || { cat "$work/log"; fail "the examples do not build"; }
expect_answers "$work/examples"
expect_page_answers "$work/examples"

echo "pkg-config"
libdir=$(dirname "$(find "$prefix" -name 'libfathom.so')")
flags() { PKG_CONFIG_PATH=$libdir/pkgconfig pkg-config "$@" fathom; }
read -ra cflags < <(flags --cflags)
read -ra libs < <(flags --libs)
"$cxx" -std=c++20 "${cflags[@]}" "$source/examples/score_window.cpp" -o "$work/score_window" "${libs[@]}"
"$cc" -std=c99 "${cflags[@]}" "$source/examples/focus.c" -o "$work/focus" "${libs[@]}"
export LD_LIBRARY_PATH=$libdir
cat >"$work/all.cpp" <<'CPP'
#include <fathom.h>
#include <fathom.hpp>

#include <cstdio>

int main() { std::printf("%s image at %.3f mm\n", fathom_version(), fathom::optics::image_distance_mm(135, 1500)); }
CPP
"$cxx" -std=c++20 "${cflags[@]}" "$work/all.cpp" -o "$work/all" "${libs[@]}"
expect "image at 148.352 mm" "$work/all"
expect_answers "$work"

echo "ctypes"
expect "sharpest at 64,64,64" "$python" "$source/examples/ctypes_score.py" \
  "$libdir/libfathom.so" "$work/corner.pgm"
