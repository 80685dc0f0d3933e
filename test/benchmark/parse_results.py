# SPDX-License-Identifier: BSD-3-Clause
"""What programs write, as columns and rows. Each function takes the texts of its table's commands, {label: text}."""
import csv
import io
import json
import re
import statistics


def table(columns, rows, notes=()):
    return {'columns': list(columns), 'rows': [list(row) for row in rows], 'notes': [note for note in notes if note]}


def of_dicts(rows, columns=None, notes=()):
    columns = columns or list(dict.fromkeys(key for row in rows for key in row))
    return table(columns, ([row.get(column, '') for column in columns] for row in rows), notes)


def experiment(texts):
    """The table of `experiment --result`, and what it finds."""
    result = json.loads(only(texts))
    failed = '' if result['converged'] else 'Not all of it converged: ' + result['message']
    return of_dicts(result['table'], notes=[result['we_find'], failed])


def policies(texts):
    """Of 7.3.1: each method over all targets, beside the nearest end of any method."""
    close_mm, best, rows = 0.1, {}, []
    result = json.loads(only(texts))
    for row in result['table']:
        best[row['target']] = min(row['distance [mm]'], best.get(row['target'], float('inf')))
    for method in dict.fromkeys(row['method'] for row in result['table']):
        own = [row for row in result['table'] if row['method'] == method]
        farther = [row['distance [mm]'] - best[row['target']] for row in own]
        rows.append({'method': method, 'farther than the best, median [mm]': round(statistics.median(farther), 5), 'at most [mm]': round(max(farther), 5),
                     'targets within %g mm of it' % close_mm: '%d of %d' % (sum(mm <= close_mm for mm in farther), len(own)),
                     'equilibria': span(own, 'equilibria'), 'CPU time [s]': span(own, 'CPU [s]')})
    return of_dicts(rows, notes=experiment(texts)['notes'])


def span(rows, key):
    return '%.4g to %.4g' % (min(row[key] for row in rows), max(row[key] for row in rows))


def only(texts):
    if len(texts) != 1:
        raise ValueError('one command is expected')
    return next(iter(texts.values()))


def google_benchmark(names, counters, column='CPU time [ms]', second_ms=None):
    """Rows of --benchmark_format=json: `names` {benchmark: row}, `counters` {counter: column}; the least where repeated.
    `second_ms`: of a simulated second, in the unit of its times."""
    def parse(texts):
        rows = []
        for run in json.loads(only(texts))['benchmarks']:
            name = run['run_name'].split('/iterations:')[0].split('/repeats:')[0].split('/min_time:')[0]
            if run.get('aggregate_name', 'min') == 'min' and name in names:
                row = {'': names[name], column: run['cpu_time']}
                if second_ms:
                    row['times real time'] = second_ms / run['cpu_time']
                row.update({title: run[counter] for counter, title in counters.items() if counter in run})
                rows.append(row)
        if len(rows) != len(names):
            raise ValueError('found %d of %d benchmarks' % (len(rows), len(names)))
        return of_dicts(rows)
    return parse


NUMBER = r'([-\d.e+]+)'


def reduced(texts):
    """Of benchmark_reduced: newton, then blocks of a model each."""
    speed = r'^%s +' + NUMBER + r' us a step, +' + NUMBER + ' times'
    rows = []
    for robot, text in texts.items():
        step_us, times = re.search(speed % 'newton', text, re.M).groups()
        rows.append({'robot': robot, 'model': '`newton`', 'CPU a step [us]': float(step_us), 'times real time': float(times)})
        for block in text.split('\nN = ')[1:]:
            modes, points, training_s = re.search(r'^(\d+), .*?(\d+) points.*trained in ' + NUMBER, block).groups()
            step_us, times = re.search(speed % 'reduced', block, re.M).groups()
            row = {'robot': robot, 'model': '%s modes, %s points' % (modes, points), 'CPU a step [us]': float(step_us), 'times real time': float(times)}
            for what, title in (('equilibria', 'equilibria'), ('transient', 'motion')):
                rms, most = re.search(what + r' +rms ' + NUMBER + ' mm, max ' + NUMBER, block).groups()
                row[title + ', rms [mm]'], row[title + ', largest [mm]'] = float(rms), float(most)
            states, near = re.search(r'^audits +(\d+) states: (\d+) within', block, re.M).groups()
            row['audits within a factor of two'], row['training [CPU-s]'] = '%s of %s' % (near, states), float(training_s)
            rows.append(row)
    return of_dicts(rows)


def references(texts):
    """Of gtest's --gtest_output=json: what expect_near_reference() recorded."""
    rows, failed = [], []
    for text in texts.values():
        for suite in json.loads(text)['testsuites']:
            for test in suite['testsuite']:
                failed += [test['name']] if test.get('failures') else []
                for what, both in test.items():
                    if isinstance(both, str) and what.count(' | ') == 2:
                        found, reference = map(float, both.split(' of '))
                        rows.append(what.split(' | ') + [found, reference, round(100.0 * (found / reference - 1.0), 2) if reference else ''])
    rows = sorted(rows, key=lambda row: [float(word) if re.fullmatch(r'[\d.]+', word) else word
                                         for word in re.split(r'([\d.]+)', row[0] + ' ' + row[2] + ' ' + row[1])])
    return table(['case', 'elements', 'quantity', 'found', 'reference', 'difference [%]'], rows,
                 ['Tests that failed: ' + ', '.join(failed)] if failed else [])


def stability(texts):
    """Squares of stability_cells.csv, counted by body, method and outcome; those of the default solver that failed by name."""
    counts, outcomes, failed = {}, {}, []
    for cell in csv.DictReader(io.StringIO(only(texts))):
        outcomes[cell['outcome']] = None
        counts.setdefault((cell['body'], cell['method']), []).append(cell['outcome'])
        if cell['default'] == '1' and cell['outcome'] not in ('survived', 'recovered'):
            failed.append('%s, %s, %s, %s: %s.' % (cell['body'], cell['method'], cell['case'], cell['outcome'], cell['message']))
    rows = [{'body': key[0], 'method': key[1], **{word: found.count(word) for word in outcomes}} for key, found in counts.items()]
    return of_dicts(rows, notes=['Of the default solver: ' + ' '.join(failed)] if failed else [])


def casting(texts):
    rows = []
    for robot, text in texts.items():
        verdict = json.loads(text)
        tests = verdict['tests']
        rows.append({'robot': robot, 'castable': 'yes' if verdict['castable'] else 'no', 'not for': ', '.join(name for name, test in tests.items() if not test['passed']),
                     'thinnest [mm]': scaled(tests.get('thickness', {}).get('worst_m')), 'stretch to leave the mould': tests.get('stretch', {}).get('worst', '')})
    return of_dicts(rows)


def scaled(metres):
    return '' if metres is None else 1e3 * metres


def moulds(texts):
    rows = []
    for robot, text in texts.items():
        mould = json.loads(text)
        rows.append({'robot': robot, 'parts': len(mould['parts']), 'volumes close to': mould['closure'], 'cavity off the skin [mm]': scaled(mould['cavity_distance_m']),
                     'largest part [mm]': ' x '.join('%g' % round(1e3 * length, 1) for length in max(mould['parts'], key=lambda part: part['volume_m3'])['size_m']),
                     'watertight': 'yes' if all(part['watertight'] for part in mould['parts']) else 'no'})
    return of_dicts(rows)


def chart(part, columns):
    """A list of numbers of chart_speed_accuracy's speed_accuracy.json: `columns` {key: title}."""
    def parse(texts):
        rows = json.loads(only(texts))[part]
        absent = [key for key in columns if not any(key in row for row in rows)]
        if absent:
            raise ValueError('no row has ' + ', '.join(absent))
        return of_dicts([{title: row.get(key, '') for key, title in columns.items()} for row in rows])
    return parse


def fidelity(texts):
    """Of chart_fidelity: a row a tolerance."""
    columns = {'tolerance_mm': 'tolerance [mm]', 'scenes': 'scenes', 'met': 'met', 'misses': 'missed', 'refused': 'refused', 'near_buckling': 'near buckling',
               'median_regret': 'regret, median', 'worst_regret': 'regret, at most', 'worst_without_luck': 'without luck, at most',
               'judging_rest_states': 'choosing, median [rest states]'}
    return of_dicts([{title: row.get(key, '') for key, title in columns.items()} for row in json.loads(only(texts))])


def published(texts):
    """The block `published` of speed_accuracy.yaml: a key and a value in each line."""
    rows = []
    for line in only(texts).split('\npublished:\n')[1].splitlines():
        key, _, value = line.strip(' -').partition(': ')
        if key == 'name':
            rows.append({})
        if key in ('name', 'times_real_time', 'published', 'setting', 'source'):
            rows[-1][key.replace('_', ' ')] = value.strip('"')
    return of_dicts(rows)


def nodes(texts):
    """Cost over nodes of chart_speed_accuracy."""
    return of_dicts([{'method': one['method'], 'question': one['question'], 'nodes': ', '.join(str(mesh['nodes']) for mesh in one['meshes']),
                      'CPU time [s]': ', '.join('%.2g' % mesh['cpu_s'] for mesh in one['meshes']), 'power of the nodes': one['exponent'] or ''}
                     for one in json.loads(only(texts))['nodes']])


def learned(texts):
    """Of learn.py."""
    text = only(texts)
    pattern = r'^(.*): median ' + NUMBER + ' mm, 90 % within ' + NUMBER + ' mm, largest ' + NUMBER + ' mm; ' + NUMBER + ' % within'
    rows = [[name, float(median), float(most), float(largest), float(share)] for name, median, most, largest, share in re.findall(pattern, text, re.M)]
    return table(['policy', 'median [mm]', '90 % within [mm]', 'largest [mm]', 'within the asked distance [%]'], rows, re.findall(r'^(trained in .*?);', text, re.M))
