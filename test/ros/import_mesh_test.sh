#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# import_mesh_test.sh PYTHON SIMULATE: a hollow block of 20 x 20 x 50 mm, as another program would write it, is imported and inflated.
set -euo pipefail
python=$1 simulate=$2
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() { echo "import_mesh: $*" >&2; cat message >&2; exit 1; }
import() { "$python" "$here/../../launch/import_mesh.py" "$@" >message 2>&1; }
"$python" - <<'PYTHON' # cubes of six tetrahedra each; some the wrong way round, the one in the middle left out, a point too many
import itertools
sizes, edge = (4, 4, 5), (5, 5, 10)
place = {corner: i for i, corner in enumerate(itertools.product(*(range(n + 1) for n in sizes)))}
tets = []
for cube in itertools.product(*(range(n) for n in sizes)):
    if cube[0] in (1, 2) and cube[1] in (1, 2) and cube[2] in (1, 2, 3):
        continue
    for order in itertools.permutations(range(3)):
        corner, tet = list(cube), [place[cube]]
        for axis in order:
            corner[axis] += 1
            tet.append(place[tuple(corner)])
        tets.append(tet)
points = [' '.join(str(size * at) for size, at in zip(edge, corner)) for corner in place] + ['999 999 999']
with open('block.vtk', 'w') as file:
    file.write('# vtk DataFile Version 2.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d double\n' % len(points) + '\n'.join(points))
    file.write('\nCELLS %d %d\n' % (len(tets), 5 * len(tets)) + '\n'.join('4 ' + ' '.join(map(str, tet)) for tet in tets))
    file.write('\nCELL_TYPES %d\n' % len(tets) + '\n'.join(['10'] * len(tets)) + '\n')
PYTHON
import block.vtk && fail "50 m were accepted"
grep -q "would be 50 m long by --unit m: is it in mm? --unit mm says so" message || fail "the size was not questioned"
import block.vtk --unit mm || fail "was refused"
grep -q "408 tetrahedra, 20 x 20 x 50 mm, hollows: cavity" message || fail "says something else"
import block.vtk --unit mm && fail "files were written over"
head -c 3000 block.vtk >torn.vtk
import torn.vtk --unit mm && fail "half a file was accepted"
grep -q "torn.vtk: ends in the middle of a list" message || fail "half a file was not explained"
"$simulate" block.yaml --result result.json >message 2>&1 || fail "does not run"
"$python" - <<'PYTHON'
import json
chamber = json.load(open('result.json'))['chambers']['cavity']
assert abs(chamber['initial_volume_m3'] - 10e-3 * 10e-3 * 30e-3) < 1e-12, chamber
assert chamber['volume_m3'] > 1.05 * chamber['initial_volume_m3'] and chamber['gauge_pressure_pa'] > 0, chamber
PYTHON
