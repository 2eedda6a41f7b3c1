#!/bin/bash
# Draws the pictures of the README with the program itself.
# usage: assets/pictures/make_pictures.sh [SCAN]      (the default is the scan of ./demo)
# demo.png is the picture at the top; NAME_METHOD.png are those of the table of methods; closeup_*
# show the swatch inside the splats, directions_* what strokes do.
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
    -o "$work/textured.ply" --source-map --quiet "$@"
  draw "$swatch" "$picture" --view "$view"
}

# The last textured scan.
draw() {
  local swatch=$1 picture=$2
  shift 2
  "$dapple" render "$work/textured.ply" --swatch "assets/swatches/$swatch.png" \
    -o "$pictures/$picture.png" --size "$size" --quiet "$@"
}

size=960x720 view=front
texture scales auto demo  # as in ./demo

size=480x360
for swatch in pebbles leopard lichen; do
  texture "$swatch" hybrid "${swatch}_hybrid"
done
texture bricks tiling bricks_tiling
texture knit coordinates knit_coordinates
texture wood coordinates wood_coordinates
for method in patches match triplanar; do
  texture scales "$method" "scales_$method"
done

# The swatch inside the splats, which is three times as fine as the scan, and without.
size=640x480
texture leopard hybrid closeup --scale 0.35
for texels in off on; do
  draw leopard "closeup_$texels" --texels "$texels" --eye 0.2,0.1,2.6 --target 0,0.1,0
done
rm "$pictures/closeup.png"

# Directions: as published, and along strokes (of the demo's bunny).
if [[ $scan == */bunny.obj ]]; then
  size=480x360
  texture stripes hybrid directions --scale 0.7 --field up --no-follow
  draw stripes directions_up --view "$view" --overlay directions
  texture stripes hybrid directions --scale 0.7 --strokes "$pictures/bunny_strokes.json"
  draw stripes directions_strokes --view "$view" --overlay directions
  rm "$pictures/directions.png"
fi

# The editor, as its tests leave it.
build/release/dapple_editor_tests --test-case='from the start screen*' >/dev/null
cp build/release/tests/editor/sample.png "$pictures/editor.png"
