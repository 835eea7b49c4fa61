#!/usr/bin/env python3
"""Draws docs/experiments/motion.svg from the table in motion.md that `e2lf-bench motion` produces.

    python3 scripts/draw_motion.py
"""

import re
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "docs/experiments"
ROW = re.compile(r"\| (scenes that move|turntable at) ([\d.]+) (?:px per cycle|rpm) \| ([\d.]+) \| ([\d.]+) \|")
PANELS = (("scenes that move", "speed, px per cycle"), ("turntable at", "turntable, rpm"))
CURVES = (("lit transitions", "#d95f02"), ("whole cycle", "#1b6ca8"))
WIDTH, HEIGHT, LEFT, TOP, GAP = 300, 220, 60, 40, 90


def panel(points: list, label: str, left: int) -> list:
    """Returns the elements of one diagram of (speed, PSNR of each curve)."""
    values = [value for _, *both in points for value in both]
    low, high, most = int(min(values)), int(max(values)) + 1, max(speed for speed, *_ in points)
    at_x = lambda speed: left + WIDTH * speed / most
    at_y = lambda value: TOP + HEIGHT * (high - value) / (high - low)
    parts = [f'<rect x="{left}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>']
    for value in range(low, high + 1):
        parts.append(f'<line x1="{left}" x2="{left + WIDTH}" y1="{at_y(value):.1f}" y2="{at_y(value):.1f}" stroke="#ddd"/>')
        parts.append(f'<text x="{left - 6}" y="{at_y(value) + 4:.1f}" text-anchor="end">{value}</text>')
    for speed in range(0, int(most) + 1, 1 if most <= 6 else 2):
        parts.append(f'<text x="{at_x(speed):.1f}" y="{TOP + HEIGHT + 16}" text-anchor="middle">{speed}</text>')
    parts.append(f'<text x="{left + WIDTH / 2}" y="{TOP + HEIGHT + 34}" text-anchor="middle">{label}</text>')
    for curve, (_, colour) in enumerate(CURVES):
        places = [(at_x(speed), at_y(both[curve])) for speed, *both in points]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in places]
    return parts


def main() -> None:
    rows = ROW.findall((FOLDER / "motion.md").read_text())
    width = LEFT + 2 * WIDTH + GAP + 20
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {TOP + HEIGHT + 44}" width="{width}" '
             'font-family="sans-serif" font-size="12">', '<rect width="100%" height="100%" fill="white"/>',
             f'<text x="8" y="{TOP - 12}">PSNR, dB</text>']
    for place, (name, label) in enumerate(PANELS):
        points = [tuple(map(float, row[1:])) for row in rows if row[0] == name]
        parts += panel(points, label, LEFT + place * (WIDTH + GAP))
    for curve, (name, colour) in enumerate(CURVES):
        x = LEFT + 120 + 160 * curve
        parts.append(f'<line x1="{x}" x2="{x + 24}" y1="18" y2="18" stroke="{colour}" stroke-width="2"/>')
        parts.append(f'<text x="{x + 30}" y="22">{name}</text>')
    (FOLDER / "motion.svg").write_text("\n".join([*parts, "</svg>"]) + "\n")


if __name__ == "__main__":
    main()
