#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a robot of a mesh of tetrahedra that another program wrote: NAME.msh in metres, and NAME.yaml to begin with.

Reads what a scene's body.mesh may name: legacy VTK files, as SOFA and ParaView write them, and Gmsh's MSH files. Elements
whose nodes stand in the wrong order are turned, pieces whose nodes coincide are joined, and hollows inside become chambers.
Overwrites nothing."""
import argparse
import errno
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import numpy

UNITS_M = {'m': 1.0, 'cm': 0.01, 'mm': 0.001}
LONGEST_M, SHORTEST_M = 2.0, 0.005  # of robots that are cast by hand
ENDS = ['+x', '-x', '+y', '-y', '+z', '-z']


def mesher():
    """The program mesh_robot: beside this one, where this package is built, in a workspace, or on PATH."""
    here = os.path.dirname(os.path.realpath(__file__))
    spaces = [os.path.join(here, '..', 'devel')] + os.environ.get('CMAKE_PREFIX_PATH', '').split(':')
    folders = [here] + [os.path.join(space, 'lib', 'soft_robot_lab') for space in spaces if space]
    found = shutil.which('mesh_robot', path=os.pathsep.join(folders + [os.environ.get('PATH', '')]))
    if not found:
        raise ValueError('the program mesh_robot was not found: build this package, or source its setup.bash')
    return found


def quoted(text):
    return json.dumps(text, ensure_ascii=False)  # YAML in double quotes


def shown(path):
    """In one line, whatever a file is called."""
    return path if path.isprintable() else ascii(path)


def convert(source, unit, target):
    """Writes the mesh in metres; what was done to it, as lists of words by their first one."""
    request = os.path.join(os.path.dirname(target), 'request.yaml')
    with open(request, 'w', encoding='utf-8') as file:
        file.write('mesh_file: %s\nscale: %r\nimport: true\n' % (quoted(source), UNITS_M[unit]))
    done = subprocess.run([mesher(), request, target], stdin=subprocess.DEVNULL, capture_output=True, check=False)
    if done.returncode == 1:  # its words name a file that its user never named
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    if done.returncode != 0:
        raise ValueError(done.stderr.decode(errors='replace').strip() or 'the mesher ended with status %d' % done.returncode)
    words = {}
    for line in done.stdout.decode().split('\n'):
        key, _, rest = line.partition(' ')
        words.setdefault(key, []).extend([rest] if key == 'hollow' else rest.split())  # whose name is as the file has it
    return words


def chamber_names(surfaces):
    """Of one chamber for each surface, such as a scene takes."""
    names = []
    for surface in surfaces:
        plain = re.sub(r'\W+', '_', surface)[:80].strip('_')
        plain = plain if plain[:1].isalpha() else ('cavity_' + plain).rstrip('_')
        name, number = plain, 2
        while name in names:
            name, number = '%s_%d' % (plain, number), number + 1
        names.append(name)
    return names


def nodes(path):
    """Places of the nodes of a mesh that the mesher wrote, a row each."""
    with open(path, encoding='utf-8') as file:
        lines = iter(file)
        for line in lines:
            if line == '$Nodes\n':
                return numpy.array([next(lines).split()[1:] for _ in range(int(next(lines)))], float)
    raise ValueError('the mesher wrote no nodes')


def scene(name, source, points, cavities, side):
    chambers = chamber_names(cavities)
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
''' % (shown(os.path.basename(source)), name, number(box[0]), number(box[1]), side)
    if cavities:
        text += 'chambers:                        # its hollows; beta: amount of gas over that at rest\n'
        text += ''.join('  - {name: %s, surface: %s, max_beta: 2}\n' % (one, surface if one == surface else quoted(surface))
                        for one, surface in zip(chambers, cavities))
    else:
        text += '# cables: [{name: pull, path_m: [[...], [...]], plug_radius_m: 0.002}]   # from the drive to the plug, inside the body\n'
    text += 'markers:\n  - {name: tip, position_m: %s}\n' % number(tip)
    return text + 'run: {mode: equilibrium%s}\n' % (', commands: [{time_s: 0, %s: 1.2}]' % chambers[0] if chambers else '')


def check_size(points, unit):
    """Of robots that are cast by hand where another unit makes it one; else ten times as large or small does too."""
    size = float(numpy.ptp(points, axis=0).max())
    for other, scale in reversed(UNITS_M.items()):
        if not SHORTEST_M <= size <= LONGEST_M and SHORTEST_M <= size / UNITS_M[unit] * scale <= LONGEST_M:
            raise ValueError('would be %.3g m long by --unit %s: is it in %s? --unit %s says so' % (size, unit, other, other))
    if not SHORTEST_M / 10 <= size <= 10 * LONGEST_M:
        raise ValueError('would be %.3g m long by --unit %s, must be %g to %g m: no unit of --unit makes it a robot; scale it in the program '
                         'that wrote it' % (size, unit, SHORTEST_M / 10, 10 * LONGEST_M))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('mesh', metavar='MESH', help='the file, .vtk or .msh')
    parser.add_argument('--unit', choices=UNITS_M, default='m', help='of its lengths (m)')
    parser.add_argument('--held', choices=ENDS, default='+z', help='the end that is clamped (+z)')
    parser.add_argument('--name', help='of the robot (that of the file)')
    words = []
    for word in sys.argv[1:]:  # argparse takes the -x of --held -x for an option
        if words and len(words[-1]) > 2 and '--held'.startswith(words[-1]) and word in ENDS:
            words[-1] += '=' + word
        else:
            words.append(word)
    given = parser.parse_args(words)
    if given.held not in ENDS:  # argparse makes nothing of --held=--
        parser.error('--held: must be one of ' + ', '.join(ENDS))
    given.name = given.name or os.path.splitext(os.path.basename(given.mesh))[0]
    if given.mesh != given.mesh.encode(errors='replace').decode():
        parser.error('MESH: %s is no name in UTF-8; rename the file' % ascii(given.mesh))
    if not re.fullmatch(r'[A-Za-z][A-Za-z0-9_]*', given.name):
        parser.error("--name: '%s' must begin with a letter, and have only letters, digits and _" % given.name)
    return given


def make_robot(given):
    """Both files, or none of them. Returns what there is to say."""
    files = [given.name + '.msh', given.name + '.yaml']
    for path in files:
        if os.path.exists(path):
            raise ValueError('%s is there already; --name chooses another' % path)
    with tempfile.TemporaryDirectory(prefix='.import_mesh.', dir='.') as folder:
        new = [os.path.join(folder, path) for path in files]
        words = convert(os.path.abspath(given.mesh), given.unit, new[0])
        points, hollows = nodes(new[0]), words.get('hollow', [])
        check_size(points, given.unit)
        with open(new[1], 'x', encoding='utf-8') as file:
            file.write(scene(given.name, given.mesh, points, hollows, given.held))
        for path, target in zip(new, files):
            os.link(path, target)
    size = ' x '.join('%.4g' % (1e3 * size) for size in numpy.ptp(points, axis=0))
    text = '%s tetrahedra, %s mm, %s' % (words['elements'][0], size, 'hollows: ' + ', '.join(map(shown, hollows)) if hollows else 'no hollow')
    for key, what in (('turned', '%s elements turned'), ('joined', '%s nodes joined that two pieces had each')):
        if words[key] != ['0']:
            text += ', ' + what % words[key][0]
    return text


def main():
    given = arguments()
    try:
        text = make_robot(given)
    except OSError as error:
        print("import_mesh.py: %s: cannot be written: %s" % (os.getcwd(), error.strerror), file=sys.stderr)
        return 1 if error.errno == errno.ENOSPC else 2
    except ValueError as error:
        reason = str(error).replace(os.path.abspath(given.mesh), given.mesh)
        print('import_mesh.py: ' + (reason if reason.startswith(given.mesh + ':') else given.mesh + ': ' + reason), file=sys.stderr)
        return 2
    print('wrote %s.msh and %s.yaml: %s' % (given.name, given.name, text))
    print('look at it    rosrun soft_robot_lab view.sh %s.yaml' % given.name)
    return 0


if __name__ == '__main__':
    sys.exit(main())
