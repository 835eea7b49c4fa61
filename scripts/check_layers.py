#!/usr/bin/env python3
"""Refuses an include that layers.txt does not allow, and arrows of layers.txt that run in a circle.

A folder may include itself, and the folders on its line with all that lies in them. Tests may include more: see there.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TOPS = ("src/e2lf", "python", "bench")
INCLUDE = re.compile(r'^\s*#\s*include\s*"(?:e2lf/([a-z0-9_/]+)/[^/"]+|(bench|python|testing)/[^"]+)"', re.MULTILINE)


def read_layers():
    """What each folder may include, and what its tests may include in addition."""
    layers, tests = {}, {}
    for line in (ROOT / "layers.txt").read_text().splitlines():
        line = line.split("#")[0].strip()
        if not line:
            continue
        name, allowed = line.split(":")
        if name.endswith(" tests"):
            tests[name.removesuffix(" tests")] = set(allowed.split())
        else:
            layers[name.strip()] = set(allowed.split())
    return layers, tests


def inside(folder, parent):
    return folder == parent or folder.startswith(parent + "/")


def allows(layer, allowed, folder):
    """Whether a layer may include from a folder. A folder that the layer itself lies in is allowed alone, without what
    lies in it."""
    return folder == layer or any(
        folder == name or (inside(folder, name) and not inside(layer, name)) for name in allowed)


def deepest(folder, names):
    """The deepest of the names that the folder lies in; None when it lies in none."""
    return max((name for name in names if inside(folder, name)), key=len, default=None)


def circles(layers):
    """Folders that reach themselves by going from folder to folder."""
    for start in layers:
        seen, waiting = set(), [start]
        while waiting:
            here = waiting.pop()
            for name in layers:
                if name != here and name not in seen and allows(here, layers[here], name):
                    seen.add(name)
                    waiting.append(name)
        if start in seen:
            yield f"layers.txt: {start} includes itself by way of others"


def refused_includes(layers, tests):
    paths = [path for top in TOPS for path in (ROOT / top).rglob("*") if path.suffix in {".h", ".cpp"}]
    for path in sorted(paths):
        folder = str(path.parent.relative_to(ROOT)).removeprefix("src/e2lf/")
        layer, module = deepest(folder, layers), folder.split("/")[0]
        if layer is None:
            yield f"{path.relative_to(ROOT)}: its folder is not in layers.txt"
            continue
        is_test = path.stem.endswith("_test")
        test_extras = layers.get(module, set()) | tests.get(module, set()) | {"testing"}
        for included, support in INCLUDE.findall(path.read_text()):
            of = included or support
            of = deepest(of, layers) or of
            if allows(layer, layers[layer], of):
                continue
            if module == "bench" and support and support.startswith("testing"):
                continue
            if not is_test or not (inside(of, module) or any(inside(of, extra) for extra in test_extras)):
                yield f"{path.relative_to(ROOT)}: {layer} may not include {of}"


def main():
    layers, tests = read_layers()
    problems = [*circles(layers), *refused_includes(layers, tests)]
    print("\n".join(problems) or "layers: every include follows layers.txt")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
