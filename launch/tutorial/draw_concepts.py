#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""draw_concepts.py OUTPUT.svg: draws what drive, via points, plug, contraction and frames are, from a bar that `simulate`
pulls, so that the drawing is what the simulator does."""
import json
import os
import subprocess
import sys
import tempfile

CONTRACTION = 0.85
HALF_WIDTH_M, LENGTH_M = 0.01, 0.1
HEIGHTS_M = [-LENGTH_M * i / 10 for i in range(11)]
PLUG_RADIUS_M = 0.003
DRIVE_M = [-0.006, 0, 0.022]
POINTS_M = [[-0.006, 0, -0.01 - 0.02 * i] for i in range(5)]
SCENE = {
    'body': {
        'solid': {'box': {'size_m': [0.02, 0.02, LENGTH_M], 'center_m': [0, 0, -LENGTH_M / 2]}},
        'element_size_m': 0.012,
        'material': {'preset': 'ecoflex_00_50'},
        'fixed': [{'box': {'min_m': [-1, -1, -1e-6], 'max_m': [1, 1, 1]}}],
    },
    'gravity_m_s2': [0, 0, -9.81],
    'cables': [{
        'name': 'left', 'drive_points_m': [DRIVE_M], 'points_m': POINTS_M, 'plug_radius_m': PLUG_RADIUS_M,
    }],
    'markers': [{'name': '%s_%d' % (side, i), 'position_m': [x, 0, z]} for side, x in (('l', -HALF_WIDTH_M), ('r', HALF_WIDTH_M))
                for i, z in enumerate(HEIGHTS_M)] +
               [{'name': 'c_%d' % i, 'position_m': point} for i, point in enumerate(POINTS_M)] +
               [{'name': 'tip', 'position_m': [0, 0, -LENGTH_M]}],
}
SCALE = 3000  # pixels per metre
TOP, LEFT, WIDTH, HEIGHT = 140, 150, 900, 590


def simulate(contraction):
    scene = dict(SCENE, run={'commands': [{'time_s': 0, 'left': contraction}]})
    with tempfile.TemporaryDirectory() as folder:
        path, result = os.path.join(folder, 'bar.yaml'), os.path.join(folder, 'result.json')
        with open(path, 'w') as file:
            json.dump(scene, file)  # which is YAML too
        subprocess.run(['rosrun', 'soft_robot_lab', 'simulate', path, '--result', result], check=True, stdout=subprocess.DEVNULL)
        with open(result) as file:
            return json.load(file)


class Drawing:
    def __init__(self):
        self.parts = []

    def line(self, points, colour, width, more=''):
        text = ' '.join('%.1f,%.1f' % point for point in points)
        self.parts.append('<polyline points="%s" fill="none" stroke="%s" stroke-width="%g" %s/>' % (text, colour, width, more))

    def area(self, points, fill, stroke):
        text = ' '.join('%.1f,%.1f' % point for point in points)
        self.parts.append('<polygon points="%s" fill="%s" stroke="%s" stroke-width="1.5"/>' % (text, fill, stroke))

    def dot(self, point, radius, fill, stroke='none'):
        self.parts.append('<circle cx="%.1f" cy="%.1f" r="%g" fill="%s" stroke="%s" stroke-width="2"/>' % (*point, radius, fill, stroke))

    def text(self, point, words, anchor='start', size=15, weight='normal'):
        self.parts.append('<text x="%.1f" y="%.1f" text-anchor="%s" font-size="%d" font-weight="%s">%s</text>' %
                          (*point, anchor, size, weight, words))

    def note(self, at, label, words, anchor='start'):
        """Words with a thin line to what they are about."""
        self.line([at, label], '#777', 1)
        self.text((label[0] + (5 if anchor == 'start' else -5), label[1] + 5), words, anchor)

    def svg(self):
        return ('<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" viewBox="0 0 %d %d" font-family="sans-serif" fill="#222">\n'
                '<rect width="100%%" height="100%%" fill="white"/>\n%s\n</svg>\n' % (WIDTH, HEIGHT, WIDTH, HEIGHT, '\n'.join(self.parts)))


class View:
    """Seen from in front, against y: x to the right, z up."""

    def __init__(self, drawing, left_px, result):
        self.drawing, self.left_px, self.result = drawing, left_px, result

    def place(self, point_m):
        return self.left_px + SCALE * point_m[0], TOP - SCALE * point_m[2]

    def marker(self, name):
        return self.place(self.result['markers'][name]['position_m'])

    def draw(self):
        d = self.drawing
        count = len(HEIGHTS_M)
        outline = [self.marker('l_%d' % i) for i in range(count)] + [self.marker('r_%d' % i) for i in reversed(range(count))]
        d.area(outline, '#a9d6e8', '#3a7f99')
        clamp = self.place([-0.022, 0, 0.004]), self.place([0.022, 0, 0])
        d.area([clamp[0], (clamp[1][0], clamp[0][1]), clamp[1], (clamp[0][0], clamp[1][1])], '#999', '#555')
        path = self.path()
        d.line(path, '#b5364b', 3)
        for point in path[1:-1]:
            d.dot(point, 4.5, 'white', '#b5364b')
        (x, y), (bx, by) = path[-1], path[-2]
        along = ((x - bx) ** 2 + (y - by) ** 2) ** 0.5
        side = (SCALE * PLUG_RADIUS_M * (y - by) / along, -SCALE * PLUG_RADIUS_M * (x - bx) / along)
        d.line([(x + side[0], y + side[1]), (x - side[0], y - side[1])], '#222', 7)
        d.dot(path[0], 13, '#ddd', '#444')
        d.dot(path[0], 3, '#444')
        d.dot(self.marker('tip'), 6, '#1a40cc')

    def path(self):
        return [self.place(DRIVE_M)] + [self.marker('c_%d' % i) for i in range(len(POINTS_M))]

    def axes(self):
        d, (x, y) = self.drawing, self.place([0, 0, 0])
        for to, colour, name in (((x + 42, y), '#c62828', 'x'), ((x, y - 42), '#1565c0', 'z')):
            d.line([(x, y), to], colour, 3)
            d.text((to[0] + 4, to[1] + (5 if name == 'x' else 0)), name, size=14)


def draw(rest, pulled):
    drawing = Drawing()
    left, right = View(drawing, LEFT + 60, rest), View(drawing, LEFT + 470, pulled)
    for view in (left, right):
        view.draw()
    left.axes()
    path = left.path()
    notes_px = LEFT - 30
    drawing.note((path[0][0] - 13, path[0][1]), (notes_px, path[0][1] - 12), 'drive', 'end')
    drawing.note((path[2][0] - 5, path[2][1]), (notes_px, path[2][1]), 'via points', 'end')
    drawing.note((path[-1][0] - 10, path[-1][1]), (notes_px, path[-1][1]), 'plug', 'end')
    drawing.note(left.place([0.012, 0, 0.002]), (LEFT + 170, TOP - 45), 'clamp (body.fixed)')
    drawing.note(left.place([0.002, 0, -0.001]), (LEFT + 170, TOP + 40), 'frame robot_base')
    tip = left.marker('tip')
    drawing.note((tip[0] + 6, tip[1]), (LEFT + 130, tip[1] + 28), 'marker tip, frame simulated/tip')
    drawing.text((LEFT + 60, 28), 'at rest: contraction 1', 'middle', 17, 'bold')
    drawing.text((LEFT + 470, 28), 'pulled: contraction %g' % CONTRACTION, 'middle', 17, 'bold')
    rest_m, length_m = rest['cables']['left']['rest_length_m'], pulled['cables']['left']['length_m']
    drawing.text((WIDTH / 2, HEIGHT - 68), 'contraction = commanded length / rest length, from drive to plug: '
                 '%.1f mm / %.1f mm' % (1e3 * CONTRACTION * rest_m, 1e3 * rest_m), 'middle')
    drawing.text((WIDTH / 2, HEIGHT - 42), 'The cable is then %.1f mm long, and pulls with %.1f N. Its force acts where its way bends, and on '
                 'the plug.' % (1e3 * length_m, pulled['cables']['left']['tension_n']), 'middle')
    drawing.text((WIDTH / 2, HEIGHT - 16), 'Between two via points it runs straight; the silicone guides it at each of them.', 'middle')
    return drawing.svg()


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    svg = draw(simulate(1.0), simulate(CONTRACTION))
    with open(sys.argv[1], 'w') as file:
        file.write(svg)


if __name__ == '__main__':
    main()
