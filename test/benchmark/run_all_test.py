#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of run_all.py and its parts."""
import json
import os
import re
import sys
import tempfile
import unittest
from unittest import mock

import page
import parse_results as parse
import provenance
import run_all
from sections import SECTIONS
from tables import TABLES, Command, Table


def write(folder, name, text):
    path = os.path.join(folder, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    return path


class Subject(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = folder.name
        write(self.root, 'config/experiments/one.yaml', 'robot: robots/bar/robot.yaml  # a bar\n')
        write(self.root, 'config/robots/bar/robot.yaml', 'include: ../base.yaml\nsize: 1\n')
        write(self.root, 'config/robots/base.yaml', 'gravity: 9.81\n')
        self.patterns = ['config/experiments/one.yaml']
        self.stored = provenance.subject(self.patterns, self.root)

    def test_holds_all_files_that_are_named(self):
        self.assertEqual(sorted(self.stored), ['config/experiments/one.yaml', 'config/robots/bar/robot.yaml', 'config/robots/base.yaml'])

    def test_changes_with_a_file_that_another_includes(self):
        write(self.root, 'config/robots/base.yaml', 'gravity: 1.62\n')
        self.assertEqual(provenance.changed_files(self.stored, self.patterns, self.root), ['config/robots/base.yaml'])

    def test_stays_where_only_comments_change(self):
        write(self.root, 'config/robots/base.yaml', '# on earth\ngravity: 9.81  # m/s^2\n\n')
        self.assertEqual(provenance.changed_files(self.stored, self.patterns, self.root), [])

    def test_changes_with_a_file_that_is_not_named_any_more(self):
        write(self.root, 'config/robots/bar/robot.yaml', 'size: 1\n')
        self.assertEqual(provenance.changed_files(self.stored, self.patterns, self.root),
                         ['config/robots/bar/robot.yaml', 'config/robots/base.yaml'])

    def test_a_pattern_without_a_file_is_refused(self):
        self.assertRaises(ValueError, provenance.subject, ['config/robots/none.yaml'], self.root)


def small_table(**more):
    return Table('small', 'Speed', 'Small', 'One beside another.', [Command(['one'])], parse.experiment, ['config/one.yaml'], **more)


def small_result(**more):
    measured = {'date': '2026-01-02', 'commit': 'abc', 'machine': 'A', 'cores': 2, 'load': [2.5, 1.0], 'cpu_s': 3.25, 'commands': ['one --fast']}
    return {'columns': ['a', 'b [mm]'], 'rows': [['x', 0.123456], ['y', 5]], 'notes': ['It is so.'], 'pictures': {}, 'measured': {**measured, **more}, 'subject': {}}


class Page(unittest.TestCase):
    def test_shows_rows_notes_and_what_was_measured_when(self):
        text = page.text([small_table()], {'small': small_result()}, {})
        for part in ('## Speed', '### Small', 'One beside another.', '| a | b [mm] |', '| x | 0.1235 |', '| y | 5 |', 'It is so.',
                     '*`one --fast`, 2026-01-02, commit abc, 3.25 CPU-s at a load of 1.0 to 2.5.*', 'A, 2 cores'):
            self.assertIn(part, text)
        self.assertNotIn('Older', text)

    def test_marks_a_table_that_is_older_than_its_subject(self):
        text = page.text([small_table()], {'small': small_result()}, {'small': ['config/robot.yaml']})
        self.assertIn('**Older than its subject**: changed since then: `config/robot.yaml`', text)

    def test_marks_what_was_not_measured_by_the_program(self):
        self.assertIn('kept from then', page.text([small_table()], {'small': small_result(not_rerun=True)}, {}))

    def test_shows_the_columns_asked_for(self):
        text = page.text([small_table(columns=['b [mm]'], notes=False)], {'small': small_result()}, {})
        self.assertIn('\n| b [mm] |\n|---|\n| 0.1235 |\n', text)
        self.assertNotIn('It is so', text)

    def test_writes_what_is_found_in_a_line_where_no_column_is_shown(self):
        text = page.text([small_table(columns=[])], {'small': small_result()}, {})
        self.assertIn('\n- **Small**: One beside another. It is so. *`one --fast`', text)
        result = {**small_result(), 'pictures': {'small.png': 'abc'}}
        self.assertIn('.* ![Small](../../config/doc/small.png)\n', page.text([small_table(columns=[])], {'small': result}, {}))
        self.assertNotIn('| a |', text)

    def test_names_tables_without_a_result(self):
        self.assertIn('Not measured yet: `small`', page.text([small_table()], {}, {}))

    def test_writes_numbers_with_four_digits(self):
        self.assertEqual([page.number(value) for value in (1234567.0, 12345.6, 0.5, 1.23456e-9, 12345, 'a|b')],
                         ['1.235e6', '12346', '0.5', '1.235e-9', '12345', 'a\\|b'])


class Checks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = write(folder.name, 'README.md', '')
        self.results = {'small': small_result()}
        os.makedirs(os.path.join(folder.name, 'results'))
        os.makedirs(os.path.join(folder.name, 'config', 'doc'))
        self.folder = folder.name
        write(folder.name, 'config/one.yaml', 'a: 1\n')
        self.results['small']['subject'] = provenance.subject(['config/one.yaml'], folder.name)
        for patch in (mock.patch.object(run_all, 'TABLES', [small_table()]), mock.patch.object(run_all, 'HERE', folder.name),
                      mock.patch.object(run_all, 'ROOT', folder.name), mock.patch.object(run_all.older, '__defaults__', (folder.name,))):
            patch.start()
            self.addCleanup(patch.stop)
        write(folder.name, 'README.md', page.text([small_table()], self.results, {}))

    def test_accept_a_page_that_is_what_is_stored(self):
        self.assertEqual(run_all.faults_of_page(self.results, self.path) + run_all.faults_of_subjects(self.results), [])

    def test_refuse_a_page_in_which_a_number_was_typed(self):
        text = page.text([small_table()], self.results, {}).replace('0.1235', '0.1234')
        write(self.folder, 'README.md', text)
        self.assertIn('is not what', run_all.faults_of_page(self.results, self.path)[0])

    def test_refuse_a_table_that_is_older_than_its_subject(self):
        write(self.folder, 'config/one.yaml', 'a: 2\n')
        self.assertIn('small is older than its subject: config/one.yaml changed', run_all.faults_of_subjects(self.results)[0])

    def test_refuse_another_picture(self):
        write(self.folder, 'config/doc/small.png', 'drawn anew')
        self.results['small']['pictures'] = {'small.png': 'abc'}
        write(self.folder, 'README.md', page.text([small_table()], self.results, {}))
        self.assertEqual(run_all.faults_of_page(self.results, self.path), ['config/doc/small.png is not the picture of table small'])

    def test_shows_commands_without_where_files_go(self):
        self.assertEqual(run_all.shown(['experiment', 'one', '--result', '{out}/result.json', '--output', '{out}']), 'experiment one')
        self.assertEqual(run_all.shown(['test', '--gtest_filter=*A*', '--gtest_output=json:{out}/test.json']), 'test --gtest_filter=*A*')

    def test_refuse_a_result_of_no_table(self):
        write(self.folder, 'results/gone.json', '{}')
        self.assertEqual(run_all.faults_of_page(self.results, self.path), ['results/gone.json belongs to no table'])

    def test_refuse_a_page_that_is_too_long(self):
        self.results['small']['rows'] = [['x', 1]] * page.MOST_LINES
        write(self.folder, 'README.md', page.text([small_table()], self.results, {}))
        self.assertIn('at most', run_all.faults_of_page(self.results, self.path)[0])


class Parsers(unittest.TestCase):
    def test_experiment(self):
        result = {'table': [{'a': 1.5, 'b': 'x'}], 'we_find': 'So.', 'converged': False, 'message': 'c did not'}
        self.assertEqual(parse.experiment({'': json.dumps(result)}), {
            'columns': ['a', 'b'], 'rows': [[1.5, 'x']], 'notes': ['So.', 'Not all of it converged: c did not']})

    def test_policies_compare_each_method_with_the_best_end_for_a_target(self):
        rows = [{'target': target, 'method': method, 'distance [mm]': mm, 'equilibria': count, 'CPU [s]': 0.5}
                for target, method, mm, count in (('1', 'a', 5.0, 7), ('1', 'b', 7.0, 90), ('2', 'a', 3.05, 9), ('2', 'b', 3.0, 100))]
        found = parse.policies({'': json.dumps({'table': rows, 'we_find': '', 'converged': True})})
        self.assertEqual(found['rows'], [['a', 0.025, 0.05, '2 of 2', '7 to 9', '0.5 to 0.5'], ['b', 1.0, 2.0, '1 of 2', '90 to 100', '0.5 to 0.5']])

    def test_google_benchmark_takes_the_least_and_misses_none(self):
        run = {'run_name': 'Go/bar/iterations:2/repeats:5', 'cpu_time': 2.0, 'nodes': 7.0}
        text = json.dumps({'benchmarks': [{**run, 'aggregate_name': 'mean', 'cpu_time': 3.0}, {**run, 'aggregate_name': 'min'}]})
        found = parse.google_benchmark({'Go/bar': 'bar'}, {'nodes': 'nodes'}, second_ms=1e3)({'': text})
        self.assertEqual((found['columns'], found['rows']), (['', 'CPU time [ms]', 'times real time', 'nodes'], [['bar', 2.0, 500.0, 7.0]]))
        self.assertRaises(ValueError, parse.google_benchmark({'Go/other': ''}, {}), {'': text})

    def test_reduced(self):
        text = ('newton    1700.5 us a step,     9.8 times real time, 1 iterations\n'
                'N = 12, 5 multipliers, 26 points, 420 snapshots, trained in 3.4 CPU-s\n'
                'reduced     13.0 us a step,  1270.0 times real time, 2 iterations\n'
                '         equilibria  rms 0.2200 mm, max 1.0700 mm, 0 of 20 unsolved\n'
                '         transient   rms 0.1900 mm, max 0.9800 mm, 0 of 360 unsolved\n'
                'audits   200 states: 199 within a factor of 2 (2.5 % 0.9)\n')
        self.assertEqual(parse.reduced({'bar': text})['rows'][1], ['bar', '12 modes, 26 points', 13.0, 1270.0, 0.22, 1.07, 0.19, 0.98, '199 of 200', 3.4])

    def test_references_in_the_order_of_their_numbers(self):
        test = {'name': 'A', 'R10, bar | 5 mm | force [N]': '1.02 of 1', 'R7, bar | 5 mm | force [N]': '2 of 2',
                'R7, bar | 5 mm | way [m]': '1e-9 of 0', 'failures': [{}]}
        found = parse.references({'a': json.dumps({'testsuites': [{'testsuite': [test]}]})})
        self.assertEqual(found['rows'], [['R7, bar', '5 mm', 'force [N]', 2.0, 2.0, 0.0], ['R7, bar', '5 mm', 'way [m]', 1e-9, 0.0, ''],
                                         ['R10, bar', '5 mm', 'force [N]', 1.02, 1.0, 2.0]])
        self.assertEqual(found['notes'], ['Tests that failed: A'])

    def test_stability(self):
        text = ('body,method,case,default,outcome,message\n"bar","newton","a",1,survived,""\n'
                '"bar","newton","b",1,failed silently,"no rest"\n"bar","xpbd","a",0,too slow,""\n')
        found = parse.stability({'': text})
        self.assertEqual(found['rows'], [['bar', 'newton', 1, 1, 0], ['bar', 'xpbd', 0, 0, 1]])
        self.assertEqual(found['notes'], ['Of the default solver: bar, newton, b, failed silently: no rest.'])

    def test_chart(self):
        text = json.dumps({'motion': [{'method': 'newton', 'rms_mm': 0.5}, {'method': 'reduced', 'rms_mm': 0.25, 'modes': 12}]})
        self.assertEqual(parse.chart('motion', {'method': 'method', 'modes': 'modes'})({'': text})['rows'], [['newton', ''], ['reduced', 12]])
        self.assertRaises(ValueError, parse.chart('motion', {'gone': 'gone'}), {'': text})

    def test_nodes(self):
        series = {'method': 'newton', 'question': 'motion', 'exponent': 1.8, 'meshes': [{'nodes': 9, 'cpu_s': 0.15}, {'nodes': 90, 'cpu_s': 1.5}]}
        self.assertEqual(parse.nodes({'': json.dumps({'nodes': [series]})})['rows'], [['newton', 'motion', '9, 90', '0.15, 1.5', 1.8]])

    def test_learned(self):
        text = 'trained in 181 s, 224 CPU-s (of which 10 wandering); rewards\nlearned: median 0.13 mm, 90 % within 0.71 mm, largest 6.50 mm; 96 % within 1.5 mm\n'
        found = parse.learned({'': text})
        self.assertEqual((found['rows'], found['notes']), ([['learned', 0.13, 0.71, 6.5, 96.0]], ['trained in 181 s, 224 CPU-s (of which 10 wandering)']))

    def test_published(self):
        text = 'a: 1\npublished:\n  - name: "rod"\n    unknowns: 3\n    times_real_time: 4.6\n    source: "page: 3"\n'
        self.assertEqual(parse.published({'': text}), parse.table(['name', 'times real time', 'source'], [['rod', '4.6', 'page: 3']]))

    def test_casting_and_moulds(self):
        verdict = {'castable': False, 'tests': {'cavities': {'passed': False}, 'thickness': {'passed': True, 'worst_m': 0.002}}}
        self.assertEqual(parse.casting({'bar': json.dumps(verdict)})['rows'], [['bar', 'no', 'cavities', 2.0, '']])
        mould = {'closure': 1e-7, 'cavity_distance_m': 1e-5, 'parts': [{'volume_m3': 1.0, 'size_m': [0.04, 0.1, 0.02], 'watertight': True}]}
        self.assertEqual(parse.moulds({'bar': json.dumps(mould)})['rows'], [['bar', 1, 1e-7, 0.01, '40 x 100 x 20', 'yes']])


class Texts(unittest.TestCase):
    def test_hold_no_measured_number(self):
        names = r'`[^`]*`|R\d+|[A-Z]\.\d|\d\.\d\.\d'
        for text in list(SECTIONS.values()) + [table.text + table.title for table in TABLES]:
            self.assertIsNone(re.search(r'\d', re.sub(names, '', text)), text)

    def test_tables_stand_in_sections_and_have_names_of_their_own(self):
        self.assertEqual(len({table.name for table in TABLES}), len(TABLES))
        self.assertEqual({table.section for table in TABLES} - set(SECTIONS), set())


if __name__ == '__main__':
    sys.exit(unittest.main())
