#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# sofa_meshes.sh PYTHON SIMULATE: SOFA's published finger and PneuNet (SoftRobots, examples/tutorials: CableGripper/details/data/mesh
# and PneunetGripper/details/data/mesh), imported as they come and run. They lie in the folder SOFA_MESHES; without it, nothing is tested.
set -euo pipefail
python=$1 simulate=$2
for mesh in finger pneunetCutCoarse; do
  [[ -r ${SOFA_MESHES:-}/$mesh.vtk ]] || { echo "skipped: SOFA_MESHES names no folder that has $mesh.vtk"; exit 77; }
done
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
for mesh in finger pneunetCutCoarse; do
  "$python" "$here/../../launch/import_mesh.py" "$SOFA_MESHES/$mesh.vtk" --unit mm --held +x
done
# The published way of the finger's cable, out along one side and back along the other, pulled by 5 %.
cat >pulled.yaml <<'YAML'
include: finger.yaml
gravity_m_s2: [0, 0, 0]
cables:
  - name: pull
    plug_radius_m: 0.002
    points_m: [[-0.0175, 0.0125, 0.0025], [-0.0325, 0.0125, 0.0025], [-0.0475, 0.0125, 0.0025], [-0.0625, 0.0125, 0.0025],
      [-0.0775, 0.0125, 0.0025], [-0.0835, 0.0125, 0.0045], [-0.0855, 0.0125, 0.0065], [-0.0855, 0.0125, 0.0085], [-0.0835, 0.0125, 0.0105],
      [-0.0775, 0.0125, 0.0125], [-0.0625, 0.0125, 0.0125], [-0.0475, 0.0125, 0.0125], [-0.0325, 0.0125, 0.0125], [-0.0175, 0.0125, 0.0125]]
run: {mode: equilibrium, commands: [{time_s: 0, pull: 0.95}]}
YAML
"$simulate" pulled.yaml --result finger.json
"$simulate" pneunetCutCoarse.yaml --result pneunet.json
"$python" - <<'PYTHON'
import json
finger, pneunet = (json.load(open(name + '.json')) for name in ('finger', 'pneunet'))
assert finger['markers']['tip']['displacement_m'][1] > 0.002, 'the finger does not bend towards its cable'
assert finger['cables']['pull']['tension_n'] > 0
assert pneunet['chambers']['cavity']['volume_m3'] > 1.1 * pneunet['chambers']['cavity']['initial_volume_m3']
PYTHON
