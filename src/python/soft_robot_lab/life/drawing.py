# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of robots and numbers, as SVG."""
import html

import numpy

_WIDTH, _HEIGHT, _MARGIN = 640, 480, 24
_TURN = numpy.radians(25.0)  # seen from -y, a little from the left and from above
_TILT = numpy.radians(12.0)
_AXES = numpy.array([[numpy.cos(_TURN), numpy.sin(_TURN), 0.0],
                     [-numpy.sin(_TURN) * numpy.sin(_TILT), numpy.cos(_TURN) * numpy.sin(_TILT), numpy.cos(_TILT)],
                     [-numpy.sin(_TURN) * numpy.cos(_TILT), numpy.cos(_TURN) * numpy.cos(_TILT), -numpy.sin(_TILT)]])  # right, up, away


def robots(skins, points):
    """skins: (name, nodes_m (n x 3), faces (m x 3 or 6), colour); points: (name, place in metres, colour), drawn over them."""
    placed = [numpy.asarray(nodes_m) @ _AXES.T for _, nodes_m, _, _ in skins]
    spots = [numpy.asarray(position_m) @ _AXES.T for _, position_m, _ in points]
    everything = numpy.vstack(placed + ([numpy.array(spots)] if spots else []))[:, :2]
    low, high = everything.min(axis=0), everything.max(axis=0)
    scale = min((_WIDTH - 2 * _MARGIN) / max(high[0] - low[0], 1e-9), (_HEIGHT - 2 * _MARGIN) / max(high[1] - low[1], 1e-9))
    middle = (low + high) / 2

    def at(place):
        return _WIDTH / 2 + scale * (place[0] - middle[0]), _HEIGHT / 2 - scale * (place[1] - middle[1])

    lines = []
    for (_, _, faces, colour), nodes in zip(skins, placed):
        lines += _skin(nodes, numpy.asarray(faces)[:, :3], colour, at)
    names = {}
    for (name, _, colour), spot in zip(points, spots):
        x, y = at(spot)
        lines.append('<circle cx="%.1f" cy="%.1f" r="4" fill="%s"/>' % (x, y, colour))
        names[name] = colour
    for name, _, _, colour in skins:
        names.setdefault(name, colour)
    return _svg(lines + _legend(names) + _bar_of_length(scale))


def _skin(nodes, faces, colour, at):
    corners = nodes[faces]
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = -normals[:, 2] / numpy.maximum(numpy.linalg.norm(normals, axis=1), 1e-30)
    order = [i for i in numpy.argsort(-corners[:, :, 2].mean(axis=1)) if facing[i] > 0.0]
    return ['<polygon points="%s" fill="%s" stroke="%s" stroke-width="0.5" fill-opacity="0.8"/>'
            % (' '.join('%.1f,%.1f' % at(corner) for corner in corners[i]), _shade(colour, facing[i]), _shade(colour, 0.8 * facing[i])) for i in order]


def _shade(colour, facing):
    return '#%02x%02x%02x' % tuple(int(int(colour[i:i + 2], 16) * (0.45 + 0.55 * facing)) for i in (1, 3, 5))


def _legend(names):
    lines = []
    for row, (name, colour) in enumerate(names.items()):
        y = 20 + 18 * row
        lines.append('<rect x="12" y="%d" width="12" height="12" fill="%s"/><text x="30" y="%d">%s</text>' % (y - 10, colour, y, html.escape(name)))
    return lines


def _bar_of_length(scale):
    length_m = next(size for size in (0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0001) if size * scale < 0.3 * _WIDTH or size == 0.0001)
    end = _WIDTH - 16
    return ['<path d="M%.1f %d H%d" stroke="#222" stroke-width="2"/><text x="%d" y="%d" text-anchor="end">%g mm</text>'
            % (end - length_m * scale, _HEIGHT - 14, end, end, _HEIGHT - 20, 1e3 * length_m)]


def bars(title, rows, unit):
    """rows: (name, value, colour); none below zero."""
    most = max([value for _, value, _ in rows] + [1e-12])
    step = 26
    lines = ['<text x="12" y="20">%s</text>' % html.escape('%s [%s]' % (title, unit))]
    for i, (name, value, colour) in enumerate(rows):
        y = 36 + step * i
        lines.append('<text x="190" y="%d" text-anchor="end">%s</text><rect x="200" y="%d" width="%.1f" height="16" fill="%s"/><text x="%.1f" y="%d">%.3g</text>'
                     % (y + 13, html.escape(name), y, 360 * value / most, colour, 206 + 360 * value / most, y + 13, value))
    return _svg(lines, 48 + step * len(rows))


def _svg(lines, height=_HEIGHT):
    return ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" width="%d" font-family="DejaVu Sans, Arial, sans-serif" font-size="12">\n'
            '<rect width="100%%" height="100%%" fill="#fff"/>\n%s\n</svg>\n' % (_WIDTH, height, _WIDTH, '\n'.join(lines)))
