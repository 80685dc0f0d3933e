#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a robot of a mesh of tetrahedra that another program wrote: NAME.msh in metres, and NAME.yaml to begin with.

Reads legacy VTK files, as SOFA has them. Hollows inside become chambers. Overwrites nothing."""
import argparse
import collections
import os
import re
import sys

import numpy

UNITS_M = {'m': 1.0, 'cm': 0.01, 'mm': 0.001}
LONGEST_M, SHORTEST_M = 2.0, 0.005  # of robots that are cast by hand
TETRAHEDRON = 10


class VtkFile:
    """Words and numbers of a legacy VTK file, one section after the other."""

    def __init__(self, path):
        with open(path, 'rb') as file:
            self.data = file.read()
        self.at = 0
        head = [self.line() for _ in range(4)]
        if not head[0].startswith('# vtk DataFile') or head[3].split() != ['DATASET', 'UNSTRUCTURED_GRID']:
            raise ValueError('is no legacy VTK file of an unstructured grid')
        self.binary = head[2].strip() == 'BINARY'

    def line(self):
        end = self.data.find(b'\n', self.at)
        end = len(self.data) if end < 0 else end
        text = self.data[self.at:end].decode('ascii', 'replace')
        self.at = end + 1
        return text

    def numbers(self, count, kind):
        if self.binary:
            size = count * numpy.dtype(kind).itemsize
            part = self.data[self.at:self.at + size]
            self.at += size
            if len(part) < size:
                raise ValueError('ends in the middle of a list')
            return numpy.frombuffer(part, kind)
        words = []
        while len(words) < count:
            if self.at >= len(self.data):
                raise ValueError('ends in the middle of a list')
            words += self.line().split()
        return numpy.array(words, float)

    def sections(self):
        while self.at < len(self.data):
            words = self.line().split()
            if words and words[0] in ('POINTS', 'CELLS', 'CELL_TYPES'):
                yield words


def read_vtk(path):
    """Points (n x 3) and tetrahedra (m x 4)."""
    file = VtkFile(path)
    points, cells, types = None, None, None
    for words in file.sections():
        if words[0] == 'POINTS':
            points = file.numbers(3 * int(words[1]), '>f8' if words[2] == 'double' else '>f4').reshape(-1, 3).astype(float)
        elif words[0] == 'CELLS':
            cells = file.numbers(int(words[2]), '>i4').astype(int)
        else:
            types = file.numbers(int(words[1]), '>i4').astype(int)
    if points is None or cells is None or types is None or not numpy.isfinite(points).all():
        raise ValueError('has no points, no cells, or numbers that are not finite')
    tets, at = [], 0
    for kind in types:
        if kind == TETRAHEDRON:
            tets.append(cells[at + 1:at + 5])
        at += cells[at] + 1
    if not tets or numpy.min(tets) < 0 or numpy.max(tets) >= len(points):
        raise ValueError('has no tetrahedra of its points')
    return points, numpy.array(tets)


def clean(points, tets):
    """Without points that no tetrahedron uses, and every tetrahedron the right way round."""
    used, tets = numpy.unique(tets, return_inverse=True)
    points, tets = points[used], tets.reshape(-1, 4)
    a, b, c, d = (points[tets[:, i]] for i in range(4))
    turned = numpy.einsum('ij,ij->i', numpy.cross(b - a, c - a), d - a) < 0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    return points, tets


def skins(points, tets):
    """Outer triangles, the parts that hang together apart; the largest first."""
    owners = collections.defaultdict(list)
    for tet in tets:
        for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)):
            owners[tuple(sorted(tet[list(face)]))].append(tet[list(face)])
    outer = [faces[0] for faces in owners.values() if len(faces) == 1]
    parent = {}

    def root(node):
        while parent.setdefault(node, node) != node:
            node = parent[node]
        return node

    for one, two, three in outer:
        parent[root(one)] = root(two)
        parent[root(two)] = root(three)
    parts = collections.defaultdict(list)
    for face in outer:
        parts[root(face[0])].append(face)
    return sorted(parts.values(), key=lambda part: -numpy.prod(numpy.ptp(points[numpy.unique(part)], axis=0)))


def write_msh(path, points, tets, surfaces):
    lines = ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', str(len(surfaces) + 1)]
    lines += ['2 %d "%s"' % (i + 2, name) for i, name in enumerate(surfaces)] + ['3 1 "body"', '$EndPhysicalNames', '$Nodes', str(len(points))]
    lines += ['%d %r %r %r' % (i + 1, *map(float, point)) for i, point in enumerate(points)] + ['$EndNodes', '$Elements']
    elements = [(2, i + 2, face) for i, faces in enumerate(surfaces.values()) for face in faces] + [(4, 1, tet) for tet in tets]
    lines.append(str(len(elements)))
    lines += ['%d %d 2 %d %d %s' % (i + 1, kind, tag, tag, ' '.join(str(node + 1) for node in nodes)) for i, (kind, tag, nodes) in enumerate(elements)]
    with open(path, 'x', encoding='ascii') as file:
        file.write('\n'.join(lines) + '\n$EndElements\n')


def scene(name, source, points, cavities, side):
    low, high = points.min(axis=0), points.max(axis=0)
    axis, upper = 'xyz'.index(side[1]), side[0] == '+'
    reach = 0.02 * (high - low)[axis]
    box = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]
    box[0 if upper else 1][axis] = float(high[axis] - reach if upper else low[axis] + reach)
    tip = points[numpy.argmin(points[:, axis]) if upper else numpy.argmax(points[:, axis])]
    number = lambda values: '[' + ', '.join('%.6g' % value for value in values) + ']'
    text = '''# From %s. Lengths are in metres; config/README.md of soft_robot_lab explains every key.
body:
  mesh: %s.msh
  element: quadratic             # mid-edge nodes are added: four-node tetrahedra lock
  material: {preset: ecoflex_00_50}   # or youngs_modulus_pa, poissons_ratio, density_kg_m3; a mesh file has none
  fixed: [{box: {min_m: %s, max_m: %s}}]   # its %s end
gravity_m_s2: [0, 0, -9.81]
''' % (os.path.basename(source), name, number(box[0]), number(box[1]), side)
    if cavities:
        text += 'chambers:                        # its hollows; beta: amount of gas over that at rest\n'
        text += ''.join('  - {name: %s, surface: %s, max_beta: 2}\n' % (one, one) for one in cavities)
    else:
        text += '# cables: [{name: pull, path_m: [[...], [...]], plug_radius_m: 0.002}]   # from the drive to the plug, inside the body\n'
    text += 'markers:\n  - {name: tip, position_m: %s}\n' % number(tip)
    return text + 'run: {mode: equilibrium%s}\n' % (', commands: [{time_s: 0, %s: 1.2}]' % cavities[0] if cavities else '')


def check_size(points, unit):
    size = float(numpy.ptp(points, axis=0).max())
    for other, scale in reversed(UNITS_M.items()):
        if not SHORTEST_M <= size <= LONGEST_M and SHORTEST_M <= size / UNITS_M[unit] * scale <= LONGEST_M:
            raise ValueError('would be %.3g m long by --unit %s: is it in %s? --unit %s says so' % (size, unit, other, other))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('mesh', metavar='MESH.vtk', help='the file')
    parser.add_argument('--unit', choices=UNITS_M, default='m', help='of its lengths (m)')
    parser.add_argument('--held', choices=['+x', '-x', '+y', '-y', '+z', '-z'], default='+z', help='the end that is clamped (+z)')
    parser.add_argument('--name', help='of the robot (that of the file)')
    given = parser.parse_args()
    given.name = given.name or os.path.splitext(os.path.basename(given.mesh))[0]
    if not re.fullmatch(r'[A-Za-z][A-Za-z0-9_]*', given.name):
        parser.error("--name: '%s' must begin with a letter, and have only letters, digits and _" % given.name)
    return given


def main():
    given = arguments()
    try:
        points, tets = clean(*read_vtk(given.mesh))
        points = points * UNITS_M[given.unit]
        check_size(points, given.unit)
        parts = skins(points, tets)
        names = ['cavity' if i == 0 else 'cavity_%d' % (i + 1) for i in range(len(parts) - 1)]
        for path in (given.name + '.msh', given.name + '.yaml'):
            if os.path.exists(path):
                raise ValueError('%s is there already; --name chooses another' % path)
        write_msh(given.name + '.msh', points, tets, dict(zip(['skin'] + names, parts)))
        with open(given.name + '.yaml', 'x', encoding='utf-8') as file:
            file.write(scene(given.name, given.mesh, points, names, given.held))
    except (OSError, ValueError, IndexError) as error:
        print('import_mesh.py: %s: %s' % (given.mesh, error), file=sys.stderr)
        return 2
    print('wrote %s.msh and %s.yaml: %d tetrahedra, %s mm, %s' % (
        given.name, given.name, len(tets), ' x '.join('%.4g' % (1e3 * size) for size in numpy.ptp(points, axis=0)),
        'hollows: ' + ', '.join(names) if names else 'no hollow'))
    print('look at it    rosrun soft_robot_lab view.sh %s.yaml' % given.name)
    return 0


if __name__ == '__main__':
    sys.exit(main())
