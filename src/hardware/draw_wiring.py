#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""draw_wiring.py RIG.yaml OUTPUT.svg: how board and drives of a rig are wired, motors or pressure channels: the pins as the page
beside this script lists them, the drives in the order of the rig's file."""
import os
import re
import sys

import yaml

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'README.md')
LINES = ('select', 'clock', 'MOSI', 'MISO')
COLOURS = {'select': '#7b3fa0', 'clock': '#1565c0', 'MOSI': '#2e7d32', 'MISO': '#c62828', 'chain': '#2e7d32', 'supply': '#b36b00', 'ground': '#444', 'air': '#5b9bd5'}
DRIVER, GAP, TOP = 150, 70, 150


def pins():
    with open(PAGE) as file:
        found = dict(re.findall(r'^\| (\w+) \| (D\d+) \|$', file.read(), re.M))
    missing = [line for line in LINES if line not in found]
    if missing:
        sys.exit('%s names no pin for %s' % (PAGE, ', '.join(missing)))
    return found


def air_pins():
    """Of each channel: sensor, fill, vent; and the supply's."""
    with open(PAGE) as file:
        page = file.read()
    rows = re.findall(r'^\| (\d) \| (A\d) \| (D\d+) \| (D\d+) \|$', page, re.M)
    supply = re.search(r"supply's valve is on (D\d+)", page)
    if len(rows) != 4 or not supply:
        sys.exit('%s names no pins of four channels and a supply' % PAGE)
    return [row[1:] for row in rows], supply.group(1)


def drives(path, kind, most):
    with open(path) as file:
        rig = yaml.safe_load(file)
    found = rig.get(kind) or []
    if not 1 <= len(found) <= most:
        sys.exit('%s: %d %s, must have [1, %d]' % (path, len(found), kind, most))
    return found


class Drawing:
    def __init__(self, width, height):
        self.width, self.height, self.parts = width, height, []

    def box(self, x, y, width, height, title, fill):
        self.parts.append('<rect x="%d" y="%d" width="%d" height="%d" rx="6" fill="%s" stroke="#333" stroke-width="1.5"/>' %
                          (x, y, width, height, fill))
        self.text(x + width / 2, y + 20, title, 'middle', 'bold')

    def wire(self, points, what, width=2.2):
        text = ' '.join('%d,%d' % point for point in points)
        self.parts.append('<polyline points="%s" fill="none" stroke="%s" stroke-width="%g"/>' % (text, COLOURS[what], width))

    def joint(self, x, y, what):
        self.parts.append('<circle cx="%d" cy="%d" r="3.5" fill="%s"/>' % (x, y, COLOURS[what]))

    def text(self, x, y, words, anchor='start', weight='normal', size=13):
        self.parts.append('<text x="%d" y="%d" text-anchor="%s" font-weight="%s" font-size="%d">%s</text>' % (x, y, anchor, weight, size, words))

    def svg(self):
        return ('<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" viewBox="0 0 %d %d" font-family="sans-serif" fill="#222">\n'
                '<rect width="100%%" height="100%%" fill="white"/>\n%s\n</svg>\n' %
                (self.width, self.height, self.width, self.height, '\n'.join(self.parts)))


def draw(names, pin):
    left = 250  # of the first driver
    end = left + len(names) * (DRIVER + GAP)
    d = Drawing(max(end, 640) + 20, 540)
    d.box(20, TOP - 40, 130, 190, 'Board', '#dfeaf5')
    rows = {line: TOP + 5 + 30 * i for i, line in enumerate(LINES)}
    for line, y in rows.items():
        d.text(142, y + 5, '%s %s' % (line, pin[line]), 'end')
    d.text(142, TOP + 132, '5 V, GND', 'end')
    for i, name in enumerate(names):
        x = left + i * (DRIVER + GAP)
        d.box(x, TOP - 40, DRIVER, 190, 'L6470, %d of %d' % (i + 1, len(names)), '#f3ead9')
        for pin_name, y in (('CS', rows['select']), ('CK', rows['clock']), ('SDI', rows['MOSI'])):
            d.text(x + 8, y + 5, pin_name)
        d.text(x + DRIVER - 8, rows['MOSI'] + 5, 'SDO', 'end')
        d.text(x + DRIVER / 2, TOP + 112, 'reset: high', 'middle')
        d.text(x + DRIVER / 2, TOP + 136, 'A+ A- B+ B-', 'middle')
        d.box(x + 25, TOP + 190, DRIVER - 50, 50, name, '#e4e4e4')
        d.text(x + DRIVER / 2, TOP + 230, '200 steps a turn', 'middle', size=11)
        for k in range(4):
            d.wire([(x + 45 + 20 * k, TOP + 150), (x + 45 + 20 * k, TOP + 190)], 'ground', 1.5)
    for line, above in (('select', 60), ('clock', 75)):  # to all drivers
        y, bus = rows[line], TOP - above
        d.wire([(150, y), (175 + (above - 60), y), (175 + (above - 60), bus), (end - GAP - DRIVER - 20 - (above - 60), bus)], line)
        for i in range(len(names)):
            x = left + i * (DRIVER + GAP)
            drop = x - 20 - (above - 60)
            d.wire([(drop, bus), (drop, y), (x, y)], line)
            d.joint(drop, bus, line)
    y = rows['MOSI']  # through all drivers, and back
    d.wire([(150, y), (left, y)], 'MOSI')
    for i in range(len(names) - 1):
        x = left + i * (DRIVER + GAP) + DRIVER
        d.wire([(x, y), (x + GAP, y)], 'chain')
    last = left + (len(names) - 1) * (DRIVER + GAP) + DRIVER
    back = TOP + 260
    d.wire([(last, y), (last + 25, y), (last + 25, back), (195, back), (195, rows['MISO']), (150, rows['MISO'])], 'MISO')
    d.text(last + 30, y + 40, 'back', size=12)
    words = ('Select and clock go to every driver.', 'Data go through one driver after the other, and from the last one back.')
    for i, sentence in enumerate(words):
        d.text(20, 26 + 20 * i, sentence, size=14)
    words = ('Not drawn: 8 to 45 V for the motors at each driver, with a switch within reach;',
             '5 V and ground of the logic at each driver; and one common ground.',
             'Switch the supply off before you unplug a motor: an open phase destroys its driver.')
    for i, sentence in enumerate(words):
        d.text(20, 460 + 22 * i, sentence)
    return d.svg()


def draw_channel(d, x, channel, pins_of_channel):
    """A column: sensor, fill and vent with their wires to the board's row of pins, and the chamber that they reach by tubes."""
    regulated = 'regulator' in channel
    for i, (title, pin) in enumerate(zip(('sensor', 'regulator' if regulated else 'fill valve', 'vent valve'), pins_of_channel)):
        left = x + 92 * i
        d.box(left, 250, 86, 56, title, '#f3ead9')
        d.text(left + 43, 292, ('0.5 to 4.5 V', 'through a filter' if regulated else 'off: shut', 'off: open')[i], 'middle', size=10)
        d.wire([(left + 43, 120), (left + 43, 250)], ('select', 'MOSI', 'MISO')[i])
        d.text(left + 47, 140, pin)
        d.wire([(left + 43, 306), (left + 43, 360)], 'air', 4)
    d.wire([(x + 104, 206), (x + 104, 250)], 'air', 4)  # from the supply's line
    d.wire([(x + 41, 340), (x + 229, 340)], 'air', 4)
    d.box(x + 20, 360, 230, 44, 'chamber ' + str(channel['name']), '#e4e4e4')


def draw_air(channels, pins_of_channels, supply):
    left, width = 30, 300
    d = Drawing(left + max(3, len(channels)) * width + 20, 560)
    d.box(left, 70, len(channels) * width - 20, 50, 'Board', '#dfeaf5')
    d.text(left + 8, 110, '%s: valve of the supply, three ways; without current the line below is open to the air' % supply, size=11)
    d.wire([(left + 10, 120), (left + 10, 186)], 'clock')
    d.text(left + 14, 140, supply)
    d.box(left - 20, 186, 66, 40, 'supply', '#f3ead9')
    d.wire([(left + 46, 206), (left + 126 + (len(channels) - 1) * width, 206)], 'air', 4)
    for i, channel in enumerate(channels):
        draw_channel(d, left + 20 + i * width, channel, pins_of_channels[i])
    words = ('Blue, broad: air. Thin: a wire, by a MOSFET with a diode and 10 kOhm from gate to ground for each valve.',)
    for i, sentence in enumerate(words):
        d.text(20, 26 + 20 * i, sentence, size=14)
    words = ('Not drawn: 5 V and ground of the sensors from the board, 100 kOhm from each sensor\'s input to ground;',
             'the valves\' own supply; a regulator for the air ahead of the supply\'s valve, with a relief valve;',
             'one common ground. Vent valves end in the open air.')
    for i, sentence in enumerate(words):
        d.text(20, 450 + 22 * i, sentence)
    return d.svg()


def draw_rig(path):
    with open(path) as file:
        if 'channels' in yaml.safe_load(file):
            return draw_air(drives(path, 'channels', 4), *air_pins())
    return draw([str(motor['name']) for motor in drives(path, 'motors', 6)], pins())


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    svg = draw_rig(sys.argv[1])
    with open(sys.argv[2], 'w') as file:
        file.write(svg)


if __name__ == '__main__':
    main()
