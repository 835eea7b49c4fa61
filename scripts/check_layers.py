#!/usr/bin/env python3
"""Refuses an include that layers.txt does not allow: a module may include itself and the modules listed on its line."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*"e2lf/([a-z0-9]+)/', re.MULTILINE)


def read_layers():
    layers = {}
    for line in (ROOT / "layers.txt").read_text().splitlines():
        line = line.split("#")[0].strip()
        if line:
            module, allowed = line.split(":")
            layers[module.strip()] = set(allowed.split()) | {module.strip()}
    return layers


def main():
    layers = read_layers()
    refused = []
    for path in sorted((ROOT / "src" / "e2lf").rglob("*")):
        if path.suffix not in {".h", ".cpp"}:
            continue
        module = path.relative_to(ROOT / "src" / "e2lf").parts[0]
        if module not in layers:
            refused.append(f"{path.relative_to(ROOT)}: module {module} is not in layers.txt")
            continue
        for included in INCLUDE.findall(path.read_text()):
            if included not in layers[module]:
                refused.append(f"{path.relative_to(ROOT)}: {module} may not include {included}")
    print("\n".join(refused) or "layers: every include follows layers.txt")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main())
