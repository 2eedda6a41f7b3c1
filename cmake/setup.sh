#!/bin/bash
# Installs the Debian packages that are missing, and nothing else.
# usage: cmake/setup.sh GROUP...   (groups: build, demo, ci; see the table below)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# package | group | need | why.  "optional": without it things work, slower or with a stand-in.
packages='
g++                | build | required | the C++20 compiler
cmake              | build | required | configures the build
ninja-build        | build | required | runs the build
pkg-config         | build | required | finds OSMesa and OpenImageIO
ccache             | build | optional | makes the next build faster
libglm-dev         | build | required | vectors and matrices
libeigen3-dev      | build | required | linear algebra: normals from neighbours
libnanoflann-dev   | build | required | k-d tree for nearest neighbours
libfmt-dev         | build | required | text formatting
libcli11-dev       | build | required | the command line
nlohmann-json3-dev | build | required | JSON reports
doctest-dev        | build | required | unit tests
libosmesa6-dev     | build | required | OpenGL pictures without a display
libglfw3-dev       | build | required | the window on the desktop
libimgui-dev       | build | required | the buttons and fields in the window
libfreetype-dev    | build | required | letters that are sharp at any size
libsystemd0        | build | optional | the file dialog of the desktop; else our own
fonts-dejavu-core  | build | optional | the typeface of the window; else a coarser one that is built in
libopenimageio-dev | build | required | reads and writes images
libpng-dev         | build | required | reads swatches that are plain PNGs
python3-glad       | build | required | writes the OpenGL loader at build time
python3            | build | required | writes the man page and the completions
glmark2-data       | demo  | optional | the bunny that the demo textures
clang-format       | ci    | required | checks the format of the sources
universal-ctags    | ci    | required | checks the length of functions
desktop-file-utils | ci    | required | checks the menu entry
appstream          | ci    | required | checks the metainfo
'

die() { printf '\nset-up failed: %s\n' "$1" >&2; exit 1; }

# The table's rows of the groups asked for.
wanted() {
  local package group need why asked
  while IFS='|' read -r package group need why; do
    for asked in "$@"; do
      if [[ ${group// /} == "$asked" ]]; then echo "${package// /}|${need// /}|${why# }"; fi
    done
  done <<<"$packages"
}

installed() {
  dpkg-query -W -f='${db:Status-Status}|${Package}\n' "$@" 2>/dev/null | sed -n 's/^installed|//p' || true
}

as_root() {
  if ((EUID == 0)); then "$@"; else sudo "$@"; fi
}

apt() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 -o Acquire::Retries=2 \
    -o Acquire::http::Timeout=20 -o Acquire::https::Timeout=20 "$@" >>"$log" 2>&1
}

for group in "$@"; do
  [[ $group =~ ^(build|demo|ci)$ ]] || die "no group \"$group\". The groups are build, demo and ci."
done
rows=$(wanted "$@")
mapfile -t names <<<"$(cut -d'|' -f1 <<<"$rows")"
command -v dpkg-query >/dev/null ||
  die "this is not a Debian system. Install by hand what these Debian packages hold: ${names[*]}"

present=" $(installed "${names[@]}" | tr '\n' ' ')"
required=() optional=()
while IFS='|' read -r package need why; do
  [[ $present == *" $package "* ]] && continue
  if [[ $need == required ]]; then required+=("$package"); else optional+=("$package"); fi
  ((${#required[@]} + ${#optional[@]} > 1)) || echo "Installing from Debian:"
  printf '  %-19s %s%s\n' "$package" "$why" "$([[ $need == required ]] || echo ' (optional)')"
done <<<"$rows"
missing=("${required[@]}" "${optional[@]}")
((${#missing[@]})) || exit 0

if ((EUID != 0)); then
  if ! command -v sudo >/dev/null || ! sudo -v; then
    remedy="As root, run: apt-get install --no-install-recommends ${missing[*]}"
    ((${#required[@]} == 0)) || die "installing packages needs root or sudo. $remedy"
    echo "Without root or sudo nothing is installed; going on without ${optional[*]}."
    exit 0
  fi
fi
log=build/setup.log
mkdir -p build
: >"$log"
echo "Fetching (what apt says goes to $log) ..."
apt update || echo "Some package lists could not be renewed; trying with those that are here."
apt install -y --no-install-recommends "${missing[@]}" && exit 0

if ((${#optional[@]})) && { ((${#required[@]} == 0)) ||
  apt install -y --no-install-recommends "${required[@]}"; }; then
  echo "Not to be had just now, going on without: ${optional[*]}."
  exit 0
fi
tail -n 15 "$log" >&2
die "apt-get could not install: ${required[*]}
Its last lines are above, all of them in $log. Check the network and the lists in /etc/apt, then run
this again; or install the packages by hand: apt-get install --no-install-recommends ${required[*]}"
