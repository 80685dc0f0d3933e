#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# import_mesh_test.sh PYTHON SIMULATE: a hollow block of 20 x 20 x 50 mm, as another program would write it, is imported and inflated;
# other meshes are read as `simulate` reads them, or refused with a place. The program mesh_robot lies beside SIMULATE.
set -euo pipefail
python=$1 simulate=$2
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export PATH=$(dirname "$simulate"):$PATH
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
grep -q "torn.vtk:[0-9]*: the file ends too early" message || fail "half a file was not explained"
awk '/^.Elements$/ {print; getline; print 1; next} {print}' block.msh >short.msh
import short.msh --name other && fail "an MSH file that counts wrongly was accepted"
grep -q 'short.msh:[0-9]*: $Elements announces 1 lines, and has [0-9]*$' message || fail "a wrong count was not explained"
import nothing.vtk && fail "a file that is not there was accepted"
cp block.vtk block.vtu
import block.vtu --name other && fail "a .vtu file was accepted"
grep -q "block.vtu: .vtu is not read here; save it as a legacy VTK file" message || fail "a .vtu file was not explained"
"$simulate" block.yaml --result result.json >message 2>&1 || fail "does not run"
"$python" - <<'PYTHON'
import json
chamber = json.load(open('result.json'))['chambers']['cavity']
assert abs(chamber['initial_volume_m3'] - 10e-3 * 10e-3 * 30e-3) < 1e-12, chamber
assert chamber['volume_m3'] > 1.05 * chamber['initial_volume_m3'] and chamber['gauge_pressure_pa'] > 0, chamber
PYTHON

# What pieces, elements and formats there are besides: NAME of a grid of cubes of 10 mm, each of six tetrahedra.
"$python" - <<'PYTHON'
import itertools

def grid(cubes, first=0, node=lambda corner: corner):
    tets = []
    for cube in cubes:
        for order in itertools.permutations(range(3)):
            corner, tet = list(cube), [node(tuple(cube))]
            for axis in order:
                corner[axis] += 1
                tet.append(node(tuple(corner)))
            tets.append(tet)
    return tets

def write(name, tets, kind=10, version='2.0', move=lambda corner: corner):
    places = sorted({corner for tet in tets for corner in tet}, key=str)
    index = {corner: i for i, corner in enumerate(places)}
    rows = [[index[corner] for corner in tet] for tet in tets]
    cells = 'CELLS %d %d\n' % (len(rows), sum(len(row) + 1 for row in rows))
    cells += '\n'.join(' '.join(map(str, [len(row)] + row)) for row in rows)
    if version == '5.1':
        sizes = list(itertools.accumulate([0] + [len(row) for row in rows]))
        cells = 'CELLS %d %d\nOFFSETS vtktypeint64\n%s\nCONNECTIVITY vtktypeint64\n%s' % (
            len(sizes), sizes[-1], ' '.join(map(str, sizes)), ' '.join(' '.join(map(str, row)) for row in rows))
    with open(name + '.vtk', 'w') as file:
        file.write('# vtk DataFile Version %s\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %d double\n' % (version, len(places)))
        file.write('\n'.join(' '.join(str(10 * at) for at in move(corner)[:3]) for corner in places))
        file.write('\n%s\nCELL_TYPES %d\n%s\n' % (cells, len(rows), '\n'.join([str(kind)] * len(rows))))

row = [(x, 0, 0) for x in range(4)]
write('five', grid(row), version='5.1')
halves = grid(row[:2]) + grid(row[2:], node=lambda corner: corner + ('of the second',))
write('halves', halves)
write('apart', halves, move=lambda corner: (corner[0] + (len(corner) > 3), corner[1], corner[2]))
write('folded', grid(row), move=lambda corner: (0.7, 0.5, 0.5) if corner == (3, 1, 1) else corner)
write('hexahedra', [[(x, 0, 0), (x + 1, 0, 0), (x + 1, 1, 0), (x, 1, 0), (x, 0, 1), (x + 1, 0, 1), (x + 1, 1, 1), (x, 1, 1)] for x in range(4)], kind=12)
middle = lambda a, b: tuple((p + q) / 2 for p, q in zip(a, b))
pairs = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
write('quadratic', [tet + [middle(tet[a], tet[b]) for a, b in pairs] for tet in grid(row)], kind=24)
PYTHON
for name in five halves quadratic; do
  import $name.vtk --unit mm --held -x || fail "$name was refused"
  grep -q "24 tetrahedra, 40 x 10 x 10 mm, no hollow" message || fail "$name: says something else"
  grep -q "max_m: \[0.0008, 1, 1\]" $name.yaml || fail "$name is not held at its lower end"
  "$simulate" $name.yaml --result $name.json >message 2>&1 || fail "$name does not run"
done
! import five.vtk --unit mm --held=-- || fail "an end that there is not was accepted"
grep -q -e "--held: must be one of" message || fail "an end that there is not was not explained"
refused() { # NAME WORDS
  ! import $1.vtk --unit mm || fail "$1 was accepted"
  grep -q "$1.vtk:.*$2" message || fail "$1 was not explained"
  [[ ! -e $1.msh && ! -e $1.yaml ]] || fail "$1 left files"
}
refused apart "falls into 2 parts without a common face: element 0 at (.*) m"
refused folded "lie on the same side of the face that they share: one is folded over the other"
refused hexahedra "cell 0 is a hexahedron"
sed 's/POINTS /POINTS -/' five.vtk >negative.vtk
refused negative "'-20' is not a number of entries"

odd=$'od "d"\'s\nö #: name.vtk' # written into the request and the robot's file
cp five.vtk "$odd"
import "$odd" --unit mm --name odd || fail "a file with an odd name was refused"
"$simulate" odd.yaml --result odd.json >message 2>&1 || fail "the robot of an odd name does not run"
cp five.vtk $'latin_\xf6.vtk'
import $'latin_\xf6.vtk' --unit mm --name latin && fail "a name that is no UTF-8 was accepted"
grep -q "is no name in UTF-8; rename the file" message || fail "a name that is no UTF-8 was not explained"
sed -E '/^POINTS/,/^CELLS/{/^[-0-9]/s/[0-9.]+/&e6/g}' five.vtk >large.vtk
refused large "would be .* m long by --unit mm, must be 0.0005 to 20 m"

# A surface of the file is a chamber of the robot, whatever it is called.
for surface in "my chamber: #1" "air}, {name: x" größe 5; do
  rm -f block.msh block.yaml named.msh named.yaml
  import block.vtk --unit mm || fail "was refused"
  sed "s/\"cavity\"/\"$surface\"/" block.msh >named_so.msh
  import named_so.msh --name named || fail "a surface called $surface was refused"
  [[ $(grep -c "surface:" named.yaml) == 1 ]] || fail "a surface called $surface is several chambers: $(grep surface: named.yaml)"
  "$simulate" named.yaml --result named.json >message 2>&1 || fail "the robot of $surface does not run"
done
