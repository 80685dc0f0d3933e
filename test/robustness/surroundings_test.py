#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""surroundings_test.py CASE PROGRAMS ROOT: programs under one kind of surroundings: paths, locale, masks, user, disk, signals.

PROGRAMS is the folder of `simulate`, ROOT the package's. What each must do stands in README.md beside this file. Status 77: the machine
does not allow what the case needs.
"""
import json
import os
import re
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import zipfile

BAR = '''body:
  solid: {box: {size_m: [0.02, 0.02, 0.06], center_m: [0, 0, -0.03]}}
  element: linear
  element_size_m: 0.02
  material: {youngs_modulus_pa: 264200.5, poissons_ratio: 0.39}
  fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]
cables: [{name: left, points_m: [[-0.006, 0, 0], [-0.006, 0, -0.06]]}]
markers: [{name: tip, position_m: [0, 0, -0.06]}]
'''
TETS = '''# vtk DataFile Version 2.0
t
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 double
0 0 0 10.5 0 0 0 10.5 0 0 0 10.5 10.5 10.5 10.5
CELLS 2 10
4 0 1 2 3
4 1 2 3 4
CELL_TYPES 2
10 10
'''
RESULTS = {'simulate': ['r.json'], 'rollouts': ['o.npz', 'o.json'], 'check_casting': [], 'make_mould': ['mould'], 'optimise': ['p.yaml', 'p.json'],
           'export_solid': ['body.stl'], 'import_mesh.py': ['tets.msh', 'tets.yaml']}
NOBODY = 65534
CASE, PROGRAMS, ROOT = sys.argv[1], os.path.abspath(sys.argv[2]), os.path.abspath(sys.argv[3])


def words_of(program, robot, results):
    at = [os.path.join(results, name) for name in RESULTS[program]]
    return {'simulate': [robot, '--result', *at],
            'rollouts': [robot, '--random', '2', '--duration', '0.1', '--output', at and at[0], '--result', at and at[-1]],
            'check_casting': [robot],
            'make_mould': [robot, '--output', *at],
            'optimise': [robot, '--marker', 'tip', '--target', '0.0125', '0', '-0.055', '--iterations', '2', '--policy', at and at[0], '--result',
                         at and at[-1]],
            'export_solid': [robot, '--output', *at],
            'import_mesh.py': [os.path.join(os.path.dirname(robot), 'tets.vtk'), '--unit', 'mm', '--held', '-z']}[program]


def path_of(program):
    return os.path.join(ROOT, 'launch', program) if program.endswith('.py') else os.path.join(PROGRAMS, program)


class Surroundings:
    """A folder with a robot, a home and a place for results, and how programs are started there."""

    def __init__(self, folder, **variables):
        self.robot_folder, self.home, self.results = (os.path.join(folder, name) for name in ('robots', 'home', 'results'))
        for name in (self.robot_folder, self.home, self.results):
            os.makedirs(name)
        self.robot = self.write('bar.yaml', BAR)
        self.write('tets.vtk', TETS)
        kept = {name: os.environ[name] for name in ('PATH', 'LD_LIBRARY_PATH') if name in os.environ}
        self.environment = {**kept, 'HOME': self.home, 'OPENBLAS_NUM_THREADS': '1', **variables}
        self.before = None

    def write(self, name, text):
        path = os.path.join(self.robot_folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def empty_results(self):
        for name in os.listdir(self.results):
            path = os.path.join(self.results, name)
            shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)

    def start(self, program, other):
        words = [path_of(program), *words_of(program, self.robot, self.results)]
        for name, value in other.items():
            if name in words:
                words[words.index(name) + 1] = value
            else:
                words += [name, value]
        words = ['/usr/bin/python3', '-B', *words] if program.endswith('.py') else words
        environment = {**self.environment, 'PATH': PROGRAMS + ':' + self.environment.get('PATH', '/usr/bin:/bin')}
        return subprocess.Popen(words, env=environment, cwd=self.results, preexec_fn=self.before, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def run(self, program):
        process = self.start(program, {})
        said, errors = process.communicate()
        return process.returncode, said.decode('utf-8', 'replace'), errors.decode('utf-8', 'replace')

    def require_good(self, program):
        status, said, errors = self.run(program)
        assert status == 0, (program, status, said, errors)
        for name in RESULTS[program]:
            assert os.path.exists(os.path.join(self.results, name)), (program, name)
        return said

    def require_refused(self, program, status, words):
        ended, said, errors = self.run(program)
        assert ended == status and words in errors, (program, ended, said, errors)
        for words_of_a_library in ('filesystem error', 'exception', 'Traceback', 'work.'):
            assert words_of_a_library not in errors, (program, errors)


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(below) for key, below in value.items() if not key.endswith(('cpu_s', 'wall_s'))}
    return [without_times(below) for below in value] if isinstance(value, list) else value


def content(path):
    if path.endswith('.json'):
        with open(path, encoding='utf-8') as file:
            return without_times(json.load(file))
    if path.endswith('.npz'):
        with zipfile.ZipFile(path) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    with open(path, 'rb') as file:
        return file.read()


def numbers(said):
    return [re.sub(r'[0-9.e-]+ s\b.*', '', line) for line in said.splitlines() if 'real time' not in line and '/' not in line]


def check_paths(folder):
    """Spaces, quotes, words of shells and letters beyond ASCII in every folder's name, under the plainest of locales too."""
    for name, locale in (('größe 漢字  #1', 'C'), ('-it\'s "here" %n $HOME `id`', 'C.UTF-8')):
        there = Surroundings(os.path.join(folder, name), LC_ALL=locale)
        for program in RESULTS:
            there.require_good(program)


def compile_locale(folder):
    """A locale whose decimal point is a comma."""
    os.makedirs(folder)
    name = os.path.join(folder, 'de_DE.UTF-8')
    made = shutil.which('localedef') and subprocess.run(['localedef', '-i', 'de_DE', '-f', 'UTF-8', name], capture_output=True, check=False)
    environment = {**os.environ, 'LOCPATH': folder, 'LC_ALL': 'de_DE.UTF-8'}
    shown = subprocess.run(['locale', '-k', 'decimal_point'], env=environment, capture_output=True, text=True, check=False).stdout
    if not made or '","' not in shown:
        print('skipped: no locale with a decimal comma can be compiled here:', made and made.stderr.decode())
        sys.exit(77)


def check_locale(folder):
    locales = os.path.join(folder, 'locales')
    compile_locale(locales)
    plain = Surroundings(os.path.join(folder, 'plain'), LC_ALL='C')
    comma = Surroundings(os.path.join(folder, 'comma'), LC_ALL='de_DE.UTF-8', LANG='de_DE.UTF-8', LOCPATH=locales)
    for program in RESULTS:
        assert numbers(plain.require_good(program)) == numbers(comma.require_good(program)), program
    for place, _, names in os.walk(plain.results):
        for name in names:
            if name.endswith(('.json', '.yaml', '.npz', '.stl', '.msh', '.html')):
                one = os.path.join(place, name)
                other = os.path.join(comma.results, os.path.relpath(one, plain.results))
                assert content(one) == content(other), name


def check_masks(folder):
    """Results obey the umask, what is kept at home is its owner's alone."""
    for mask in (0o000, 0o077):
        there = Surroundings(os.path.join(folder, '%03o' % mask))
        there.before = lambda mask=mask: os.umask(mask)
        for program in RESULTS:
            there.require_good(program)
        found = 0
        for place, folders, names in os.walk(there.results):
            for name in folders + names:
                mode = stat.S_IMODE(os.stat(os.path.join(place, name)).st_mode)
                assert mode == ((0o777 if name in folders else 0o666) & ~mask), (name, oct(mode))
                found += 1
        assert found >= 10, found
        for place, folders, names in os.walk(there.home):
            for name in folders + names:
                mode = stat.S_IMODE(os.stat(os.path.join(place, name)).st_mode)
                assert mode == (0o700 if name in folders else 0o600), (name, oct(mode))


def become_another_user(there, folder):
    """nobody, where we are root; else our own user, from whom its home is taken."""
    if os.geteuid() != 0:
        os.chmod(there.home, 0)
        return
    os.chmod(folder, 0o711)

    def change():
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)
    there.before = change
    os.chown(there.results, NOBODY, NOBODY)
    os.chmod(there.home, 0o700)
    seen = subprocess.run([path_of('simulate'), '--help'], preexec_fn=change, capture_output=True, check=False) if can_enter(change) else None
    if not seen or seen.returncode != 0:
        print('skipped: nobody may not run', path_of('simulate'))
        sys.exit(77)


def can_enter(change):
    return subprocess.run(['/usr/bin/test', '-x', path_of('simulate')], preexec_fn=change, check=False).returncode == 0


def check_user(folder):
    """As nobody with the home and files of root: meshes are kept in a folder of the user's own, and what may not be read or written is named."""
    temporary = os.path.join(folder, 'temporary')
    os.mkdir(temporary)
    os.chmod(temporary, 0o1777)
    there = Surroundings(os.path.join(folder, 'one'), TMPDIR=temporary)
    become_another_user(there, folder)
    for home in (there.home, '/nonexistent', ''):
        there.environment['HOME'] = home
        for program in RESULTS:
            there.require_good(program)
        there.empty_results()
    own = [os.path.join(temporary, name) for name in os.listdir(temporary)]
    assert len(own) == 1 and stat.S_IMODE(os.stat(own[0]).st_mode) == 0o700, own
    there.environment['XDG_CACHE_HOME'] = there.home  # asked for, so nothing else is taken
    there.require_refused('simulate', 2, 'soft_robot_lab: cannot be made: Permission denied; set HOME or XDG_CACHE_HOME to a folder of your own')
    del there.environment['XDG_CACHE_HOME']
    os.chmod(there.results, 0o555)
    os.chown(there.results, os.geteuid(), os.getegid())
    for program in ('simulate', 'rollouts', 'make_mould', 'optimise', 'export_solid', 'import_mesh.py'):
        there.require_refused(program, 2, 'cannot be written')
    os.chmod(there.results, 0o777)
    os.chmod(there.robot, 0)
    for program in ('simulate', 'rollouts', 'check_casting', 'make_mould', 'optimise', 'export_solid'):
        there.require_refused(program, 2, 'bar.yaml: cannot be read: Permission denied')


def fill(folder, left):
    """All of a small disk but so many bytes."""
    name = os.path.join(folder, 'fill')
    with open(name, 'wb', buffering=0) as file:
        try:
            while True:
                file.write(bytes(4096))
        except OSError:
            pass
        os.ftruncate(file.fileno(), max(0, os.fstat(file.fileno()).st_size - left))


def check_full_disk(there, small):
    fill(small, 0)
    there.environment['TMPDIR'] = small
    for program in RESULTS:
        there.require_good(program)
    there.empty_results()
    kept = there.environment['HOME']
    there.environment['HOME'] = small
    for left in (0, 4096):  # for nothing, for the request alone
        shutil.rmtree(os.path.join(small, '.cache'), ignore_errors=True)
        fill(small, left)
        for program in ('simulate', 'rollouts', 'check_casting', 'make_mould', 'optimise', 'export_solid'):
            there.require_refused(program, 1, small + '/.cache/soft_robot_lab: the mesh cannot be kept there: No space left on device; make space, or')
    there.environment['HOME'] = kept
    there.results = os.path.join(small, 'results')
    os.mkdir(there.results)
    fill(small, 0)
    for program in ('simulate', 'rollouts', 'make_mould', 'optimise', 'export_solid', 'import_mesh.py'):
        there.require_refused(program, 1, 'cannot be written: No space left on device')
    assert os.listdir(there.results) == [], os.listdir(there.results)


def check_disk(folder):
    """Full disks at the home, under the results, and at TMPDIR; in a namespace in which this may mount small ones."""
    if 'inside' not in sys.argv:
        for namespace in (['unshare', '--mount'], ['unshare', '--mount', '--map-root-user']):
            can = subprocess.run([*namespace, 'mount', '-t', 'tmpfs', 'tmpfs', folder], capture_output=True, check=False)
            if can.returncode == 0:
                sys.exit(subprocess.run([*namespace, sys.executable, '-B', *sys.argv, 'inside'], check=False).returncode)
        print('skipped: neither root nor a user namespace may mount a disk here')
        sys.exit(77)
    small = os.path.join(folder, 'small')
    os.mkdir(small)
    subprocess.run(['mount', '-t', 'tmpfs', '-o', 'size=256k', 'tmpfs', small], check=True)
    try:
        check_full_disk(Surroundings(os.path.join(folder, 'one')), small)
    finally:
        subprocess.run(['umount', '--lazy', small], check=True)


LONG = {'simulate': {}, 'rollouts': {'--random': '400', '--duration': '5000', '--hold': '100'},
        'optimise': {'--iterations': '1000000', '--method': 'cma_es'}}


def await_progress(process):
    """Until it says how far it is: then it is at work, and minds signals."""
    line = b''
    while b'%' not in line:
        line = process.stderr.readline()
        assert line, process.communicate()


def check_signals(folder):
    """SIGTERM and SIGINT keep what is done, SIGKILL leaves what was there, SIGSTOP and SIGCONT change nothing."""
    there = Surroundings(folder)
    there.robot = there.write('long.yaml', BAR + 'run: {mode: dynamic, duration_s: 100000, record_every_s: 1000}\n')
    for program, other in LONG.items():
        name = os.path.join(there.results, RESULTS[program][0])
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGKILL):
            with open(name, 'w', encoding='utf-8') as file:
                file.write('before')
            process = there.start(program, other)
            await_progress(process)
            process.send_signal(signal.SIGSTOP)
            os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WNOWAIT)
            process.send_signal(signal.SIGCONT)
            process.send_signal(number)
            errors = process.communicate()[1].decode()
            killed = number == signal.SIGKILL
            assert process.returncode == (-number if killed else 1), (program, number, process.returncode, errors)
            with open(name, 'rb') as file:
                assert (file.read() == b'before') == killed, (program, number)


def main():
    with tempfile.TemporaryDirectory() as folder:
        {'paths': check_paths, 'locale': check_locale, 'masks': check_masks, 'user': check_user, 'disk': check_disk,
         'signals': check_signals}[CASE](folder)


main()
