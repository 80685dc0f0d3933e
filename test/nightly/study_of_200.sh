# SPDX-License-Identifier: BSD-3-Clause
# Source this with STUDY SOURCE FOLDER: a study of 200 tasks in $run, and Debian's packages without installing them.
study=$1 source=$2 folder=$3
rm -rf "$folder/run"
mkdir -p "$folder/packages" "$folder/run"
run=$(cd "$folder/run" && pwd)
packages=$(cd "$folder/packages" && pwd)
cat >"$run/short.yaml" <<SCENE
include: $source/config/scenes/cantilever.yaml
body: {element: linear}
SCENE
cat >"$run/study.yaml" <<STUDY
program: simulate
scene: short.yaml
method: sobol
samples: 200
parameters:
  body.material.youngs_modulus_pa: {range: [1.0e+5, 1.0e+6]}
  body.solid.box.size_m[1]: {values: [0.018, 0.02, 0.022]}
STUDY

unpack() { # PACKAGES...
  (cd "$packages" && apt-get download -qq "$@")
  local package
  for package in "$packages"/*.deb; do dpkg -x "$package" "$packages"; done
}

require_serial_table() { # OUTPUT
  "$study" "$run/study.yaml" --output "$run/serial" --workers 1 >/dev/null 2>&1
  cmp "$1/results.csv" "$run/serial/results.csv"
}
