# SPDX-License-Identifier: BSD-3-Clause
"""One page that holds its pictures: what became of a robot, step by step."""
import base64
import html
import os
import time

_STYLE = '''<style>
body { font-family: "DejaVu Sans", Arial, sans-serif; max-width: 64em; margin: 2em auto; padding: 0 1em; line-height: 1.45; color: #222; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: 0.25em 0.8em; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
img { max-width: 100%; border: 1px solid #eee; }
pre { background: #f6f6f6; padding: 1em; overflow-x: auto; font-size: 85%; }
.refused, .failed { color: #a00; font-weight: bold; }
</style>'''
_TYPES = {'.svg': 'image/svg+xml', '.png': 'image/png', '.jpg': 'image/jpeg'}


def write(path, robot, journal, titles):
    lines = ['<!DOCTYPE html>', '<html lang="en"><head><meta charset="utf-8"><title>%s</title>' % html.escape(robot), _STYLE, '</head><body>',
             '<h1>The life of %s</h1>' % html.escape(robot), '<p>%s. %s.</p>' % (html.escape(journal.robot), time.strftime('%Y-%m-%d %H:%M')),
             '<table><tr><th>step</th><th></th><th>wall [s]</th><th>CPU [s]</th><th>why</th></tr>']
    for step, outcome in journal.outcomes.items():
        lines.append('<tr><td><a href="#%s">%s</a></td><td class="%s">%s</td><td class="number">%.1f</td><td class="number">%.1f</td><td>%s</td></tr>'
                     % (step, html.escape(titles[step]), outcome.state, outcome.state, outcome.wall_s, outcome.cpu_s, html.escape(outcome.why)))
    total = [sum(getattr(outcome, name) for outcome in journal.outcomes.values()) for name in ('wall_s', 'cpu_s')]
    lines.append('<tr><th>all</th><th></th><td class="number">%.1f</td><td class="number">%.1f</td><td></td></tr></table>' % tuple(total))
    for step, outcome in journal.outcomes.items():
        lines += _section(journal, step, titles[step], outcome)
    part = path + '.part'
    with open(part, 'w', encoding='utf-8') as file:
        file.write('\n'.join(lines + ['</body></html>', '']))
    os.replace(part, path)


def _section(journal, step, title, outcome):
    lines = ['<h2 id="%s">%s</h2>' % (step, html.escape(title))]
    if outcome.why:
        lines.append('<p class="%s">%s: %s</p>' % (outcome.state, outcome.state.capitalize(), html.escape(outcome.why)))
    if outcome.says:
        rows = ''.join('<tr><td>%s</td><td>%s</td></tr>' % (html.escape(name), html.escape(text)) for name, text in outcome.says)
        lines.append('<table>%s</table>' % rows)
    lines += ['<p><img alt="%s" src="%s"></p>' % (html.escape(picture), _address(journal.path(step, picture))) for picture in outcome.pictures]
    if outcome.commands:
        lines.append('<pre>%s</pre>' % html.escape('\n'.join(outcome.commands)))
    return lines


def _address(path):
    with open(path, 'rb') as file:
        return 'data:%s;base64,%s' % (_TYPES[os.path.splitext(path)[1]], base64.b64encode(file.read()).decode())
