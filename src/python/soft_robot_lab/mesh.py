# SPDX-License-Identifier: BSD-3-Clause
"""Meshes in and out, as NumPy arrays and as files that a scene's `body.mesh` names."""
import os

import numpy

_TETRAHEDRA = {4: 4, 10: 11}  # Gmsh's number of the kind, by nodes
_TRIANGLES = {3: 2, 6: 9}


class Mesh:
    """Tetrahedra, and named surfaces of them. nodes_m: (nodes, 3) metres; elements: (elements, 4 or 10) node indices from 0, in Gmsh's
    order; surfaces: dict by name of (faces, 3 or 6) node indices, outward."""

    def __init__(self, nodes_m, elements, surfaces=None):
        """ValueError for a wrong shape, an index out of range, and numbers that are not finite; whether the elements are sound is checked
        where a scene loads them."""
        self.nodes_m = numpy.array(nodes_m, dtype=float)
        if self.nodes_m.ndim != 2 or self.nodes_m.shape[1] != 3 or not numpy.isfinite(self.nodes_m).all():
            raise ValueError('nodes_m: of shape %s, must be (nodes, 3), all finite' % (self.nodes_m.shape,))
        self.elements = self._indices('elements', elements, _TETRAHEDRA)
        self.surfaces = {name: self._indices("surface '%s'" % name, faces, _TRIANGLES) for name, faces in (surfaces or {}).items()}
        for name in self.surfaces:
            if not isinstance(name, str) or not name or '"' in name or '\n' in name:
                raise ValueError('surfaces: %r is no name' % (name,))

    def _indices(self, what, given, kinds):
        indices = numpy.array(given)
        if indices.ndim != 2 or indices.shape[1] not in kinds or indices.dtype.kind not in 'iu':
            raise ValueError('%s: of shape %s, must be whole numbers, a row of %s for each' % (what, indices.shape, ' or '.join(map(str, kinds))))
        if indices.size and not 0 <= indices.min() <= indices.max() < len(self.nodes_m):
            raise ValueError('%s: an index is out of range [0, %d]' % (what, len(self.nodes_m) - 1))
        return indices

    def write(self, path):
        """Writes Gmsh's MSH 2.2, to every bit, whole or not at all; a scene reads it by `body: {mesh: PATH}`."""
        names = list(self.surfaces)
        lines = ['$MeshFormat', '2.2 0 8', '$EndMeshFormat', '$PhysicalNames', str(len(names) + 1)]
        lines += ['2 %d "%s"' % (i + 1, name) for i, name in enumerate(names)] + ['3 %d "body"' % (len(names) + 1), '$EndPhysicalNames']
        lines += ['$Nodes', str(len(self.nodes_m))]
        lines += ['%d %r %r %r' % (i + 1, *map(float, node)) for i, node in enumerate(self.nodes_m)]
        blocks = [(_TRIANGLES, i + 1, self.surfaces[name]) for i, name in enumerate(names)] + [(_TETRAHEDRA, len(names) + 1, self.elements)]
        rows = ['%d 2 %d %d %s' % (kinds[block.shape[1]], tag, tag, ' '.join(str(node + 1) for node in row))
                for kinds, tag, block in blocks for row in block]
        lines += ['$EndNodes', '$Elements', str(len(rows))] + ['%d %s' % (i + 1, row) for i, row in enumerate(rows)] + ['$EndElements', '']
        partial = '%s.%d' % (os.fspath(path), os.getpid())
        with open(partial, 'w', encoding='utf-8') as file:
            file.write('\n'.join(lines))
        os.replace(partial, path)

    @staticmethod
    def of(simulation):
        """The mesh of a Simulation at rest, with all its skin as the surface 'skin'."""
        return Mesh(simulation.rest_nodes_m, simulation.elements, {'skin': simulation.skin_faces})
