# SPDX-License-Identifier: BSD-3-Clause
"""README.md, from tables and what is stored of them."""
import re

from sections import FOREWORD, SECTIONS

MOST_LINES = 500


def number(value):
    """With four significant digits, as a reader writes it."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value).replace('|', '\\|')
    if value == int(value) and abs(value) < 1e6:
        return str(int(value))
    if 1e4 <= abs(value) < 1e6:
        return '%.0f' % value
    text = '%.4g' % value
    return re.sub(r'e([+-])0*(\d)', lambda found: 'e' + found.group(1).replace('+', '') + found.group(2), text)


def rows_text(table, result):
    shown = [result['columns'].index(name) for name in table.columns or result['columns']]
    lines = ['| ' + ' | '.join(result['columns'][i] for i in shown) + ' |', '|' + '---|' * len(shown)]
    return lines + ['| ' + ' | '.join(number(row[i]) for i in shown) + ' |' for row in result['rows']]


def measured_text(result, changed):
    measured = result['measured']
    commands = measured['commands']
    text = '`%s`' % commands[0] + (' and %d like it' % (len(commands) - 1) if len(commands) > 1 else '')
    text += ', %s, commit %s' % (measured['date'], measured['commit'])
    if measured.get('changed_sources'):
        text += ' with changes'
    if 'cpu_s' in measured:
        text += ', %s CPU-s at a load of %s to %s' % (number(measured['cpu_s']), *sorted(measured['load']))
    if measured.get('not_rerun'):
        text += '; kept from then, not measured by this program'
    if changed:
        text += '. **Older than its subject**: changed since then: ' + ', '.join('`%s`' % name for name in changed)
    return '*' + text + '.*' if not changed else text + '.'


def sentences(notes):
    return [note.strip()[0].upper() + note.strip()[1:] for note in notes if note.strip()]


def item_text(table, result, changed):
    """One line of a list, of a table that is not shown but for what it finds."""
    parts = [table.text][:bool(table.text)] + sentences(result['notes']) + [measured_text(result, changed)]
    parts += ['![%s](../../config/doc/%s)' % (table.title, name) for name in result['pictures']]
    return ['- **%s**: ' % table.title + ' '.join(' '.join(part.split()) for part in parts)]


def table_text(table, result, changed):
    lines = ['### ' + table.title] if table.title else []
    lines += [line for line in (table.text, measured_text(result, changed)) if line] + ['']
    for name in result['pictures']:
        lines += ['![%s](../../config/doc/%s)' % (table.title or table.section, name), '']
    lines += rows_text(table, result) + ['']
    if result['notes'] and table.notes:
        lines += sentences(result['notes']) + ['']
    return lines


def machines(results):
    """Of all tables, the most frequent one first."""
    all_of_them = [result['measured']['machine'] + ', %d cores' % result['measured']['cores']
                   for result in results.values() if 'machine' in result['measured']]
    return sorted(set(all_of_them), key=lambda name: (-all_of_them.count(name), name))


def text(tables, results, changed):
    dates = sorted(result['measured']['date'] for result in results.values())
    lines = ['# Results, and how to repeat them', ''] + FOREWORD.strip().split('\n') + ['']
    if results:
        lines += ['Measured from %s to %s on: %s.' % (dates[0], dates[-1], '; '.join(machines(results))), '']
    shown = [section for section in SECTIONS if any(table.section == section for table in tables)]
    lines += [', '.join('[%s](#%s)' % (section, section.lower().replace(' ', '-')) for section in shown) + '.', ''] if shown else []
    for section in shown:
        lines += ['## ' + section] + ([SECTIONS[section]] if SECTIONS[section] else [])
        there = [table for table in tables if table.section == section and table.name in results]
        missing = ['`%s`' % table.name for table in tables if table.section == section and table.name not in results]
        lines += ['Not measured yet: %s.' % ', '.join(missing)] if missing else []
        for only_found, write in ((True, item_text), (False, table_text)):
            some = [table for table in there if (table.columns == []) == only_found]
            if some and (only_found or some[0].title) and lines[-1]:
                lines.append('')
            for table in some:
                lines += write(table, results[table.name], changed.get(table.name, []))
        lines += [''] if lines[-1] else []
    return '\n'.join(lines).rstrip() + '\n'
