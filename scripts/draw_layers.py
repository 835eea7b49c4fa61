#!/usr/bin/env python3
"""Draws the modules of layers.txt, top to bottom, into ARCHITECTURE.md. With --check, fails if the picture is out of date.

The number of a module is the length of the longest path below it. The modules that it includes follow the arrow, without those
that it also reaches through another one.
"""
import pathlib
import sys

from check_layers import ROOT, read_layers

BEGIN, END = "<!-- layers: made by scripts/draw_layers.py -->\n```\n", "```\n<!-- end of layers -->"


def modules(layers):
    """Returns the folders that each top folder includes, where folders inside one count as the top folder."""
    graph = {}
    for name, allowed in layers.items():
        top = name.split("/")[0]
        graph.setdefault(top, set()).update(other.split("/")[0] for other in allowed)
    return {name: below & graph.keys() - {name} for name, below in graph.items()}


def reached(graph, name):
    return graph[name].union(*(reached(graph, below) for below in graph[name])) if graph[name] else set()


def height(graph, name):
    return 1 + max((height(graph, below) for below in graph[name]), default=-1)


def picture(graph):
    rows = {}
    for name in graph:
        rows.setdefault(height(graph, name), []).append(name)
    lines = []
    for level in sorted(rows, reverse=True):
        for name in sorted(rows[level]):
            direct = graph[name] - set().union(*(reached(graph, below) for below in graph[name]))
            arrow = " -> " + " ".join(sorted(direct, key=lambda below: (-height(graph, below), below))) if direct else ""
            lines.append(f"{level}  {name:<11}{arrow}".rstrip())
    return "\n".join(lines) + "\n"


def main():
    page = ROOT / "ARCHITECTURE.md"
    text = page.read_text()
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    drawn = text[:begin] + picture(modules(read_layers()[0])) + text[end:]
    if drawn == text:
        return 0
    if "--check" in sys.argv:
        print("ARCHITECTURE.md: the picture of the layers is old; run scripts/draw_layers.py")
        return 1
    page.write_text(drawn)
    return 0


if __name__ == "__main__":
    sys.exit(main())
