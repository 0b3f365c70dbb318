#!/usr/bin/env bash
# Installs a build into a folder of its own, then uses it as a stranger does.
#
#   install.sh BUILD SOURCE
set -euo pipefail
build=$1 source=$2
temp=$(mktemp -d /tmp/brume_install.XXXXXX)
trap 'rm -rf "$temp"' EXIT
prefix=$temp/prefix
fail() { echo "install test: $*" >&2; exit 1; }

cmake --install "$build" --prefix "$prefix" >"$temp/log" || { cat "$temp/log"; exit 1; }

# The program finds its stages where it is installed; the pages are there.
"$prefix/bin/brume" stages | grep -q '^height_fog' || fail "brume stages knows no height_fog"
[ -s "$prefix/share/man/man1/brume.1" ] || fail "no man page"
[ -s "$prefix/share/bash-completion/completions/brume" ] || fail "no completion"

# OpenEXR's codecs lie beside the stages; without them other files go on, and those that need them say what is missing.
frame=$source/data/valley_validation_480x270.exr
apply() { "$prefix/bin/brume" apply "$source/data/scenes/nothing.toml" "$@" -q; }
apply "$frame" -o "$temp/piz.exr" --compression piz || fail "PIZ cannot be written"
apply "$temp/piz.exr" -o "$temp/zip.exr" --compression zip || fail "PIZ cannot be read"
codecs=$(find "$prefix" -name openexr.so)
mv "$codecs" "$temp"
apply "$frame" -o "$temp/zip2.exr" --compression zips || fail "ZIP needs OpenEXR"
if apply "$temp/piz.exr" -o "$temp/lost.exr" --compression zip 2>"$temp/log"; then fail "PIZ read without its codec"; fi
grep -q 'piz compression needs the module openexr.so' "$temp/log" || { cat "$temp/log"; fail "what is missing is not said"; }
[ ! -e "$temp/lost.exr" ] || fail "an output without pixels"
mv "$temp/openexr.so" "$codecs"

# A program with find_package(brume). It finds the stages through BRUME_PLUGIN_PATH.
cmake -G Ninja -S "$source/tests/install/program" -B "$temp/program" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_BUILD_TYPE=Debug ${CXXFLAGS:+-DCMAKE_CXX_FLAGS="$CXXFLAGS"} >"$temp/log" 2>&1 ||
  { cat "$temp/log"; fail "find_package(brume) does not work"; }
cmake --build "$temp/program" >"$temp/log" 2>&1 ||
  { cat "$temp/log"; fail "an outside program does not build"; }
plugins=$(dirname "$(find "$prefix" -name brume_height_fog.so)")
BRUME_PLUGIN_PATH=$plugins "$temp/program/outside" >"$temp/out"
# 1 - exp(-0.01/m 100 m) = 0.632121; six digits are a float's.
grep -q '^R 0.63212' "$temp/out" || { cat "$temp/out"; fail "the fog is not 1 - exp(-1)"; }

# A plugin with nothing but the installed header.
cc -std=c99 -Wall -Werror -shared -fPIC -I"$prefix/include/brume" -I"$prefix/include" \
  "$source/plugins/null/stage.c" -o "$temp/brume_null.so" || fail "null does not build outside"
BRUME_PLUGIN_PATH=$temp "$prefix/bin/brume" stages null | grep -q "$temp/brume_null.so" ||
  fail "a plugin built outside is not found"
echo "install test: passed"
