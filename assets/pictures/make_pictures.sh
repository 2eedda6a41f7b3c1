#!/bin/bash
# Draws the pictures of the README with the program itself.
# usage: assets/pictures/make_pictures.sh [SCAN]      (the default is the scan of ./demo)
# demo.png is the picture at the top; NAME_METHOD.png are those of the table of methods.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

dapple=build/release/dapple
[[ -x $dapple ]] || { echo "$dapple is not there: run ./demo or ./check first" >&2; exit 1; }
scan=${1:-/usr/share/glmark2/models/bunny.obj}
[[ -r $scan ]] || scan=assets/scans/creature.ply
pictures=assets/pictures
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# swatch, method, picture: the options after them go to `dapple texture`
texture() {
  local swatch=$1 method=$2 picture=$3
  shift 3
  echo "$picture: $swatch, $method"
  "$dapple" texture "$scan" --swatch "assets/swatches/$swatch.png" --method "$method" \
    -o "$work/textured.ply" --quiet "$@"
  "$dapple" render "$work/textured.ply" -o "$pictures/$picture.png" --size "$size" --view "$view"
}

size=960x720 view=front
texture scales hybrid demo  # as in ./demo

size=480x360
for swatch in pebbles leopard bricks knit lichen terrazzo; do
  texture "$swatch" hybrid "${swatch}_hybrid"
done
for method in patches match triplanar; do
  texture scales "$method" "scales_$method"
done
