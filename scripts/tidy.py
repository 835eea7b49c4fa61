#!/usr/bin/env python3
"""scripts/tidy.py BUILD JOBS FILE...: runs clang-tidy on many sources at a time.

clang-tidy spends nearly all of its time on the headers that a source includes. Sources with the same flags are therefore
checked together, by a file that includes them. Sources that the compiler rejects in this file, for example because two of
them define a static function of the same name, are checked in further files, and finally one by one."""
import concurrent.futures
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

AT_ONCE = 24
EXTRA = ["-Wno-unknown-warning-option", "-Wno-bitwise-instead-of-logical"]  # clang does not know all warnings of g++
DROPPED = {"-o", "-c", "-MF", "-MT"}  # with their value


def flags_of(entry):
    """Returns the options of a compile command that determine how the source is read."""
    words, kept = iter(shlex.split(entry["command"])), []
    for word in words:
        if word in DROPPED:
            next(words)
        elif word.startswith("-") and word != "-MD" and not word.startswith("-Werror"):
            kept.append(word)
            if word in ("-isystem", "-include", "-I"):
                kept.append(next(words))
    return tuple(kept)


def groups(build, files):
    commands = {entry["file"]: entry for entry in json.loads((build / "compile_commands.json").read_text())}
    by_flags = {}
    for file in files:
        path = str(pathlib.Path(file).resolve())
        if path not in commands:
            raise SystemExit(f"tidy: {file} is not built in {build}")
        # A source that includes itself for each instruction set is checked alone.
        alone = path if "HWY_TARGET_INCLUDE" in pathlib.Path(file).read_text() else ""
        by_flags.setdefault((flags_of(commands[path]), alone), []).append(path)
    for (flags, _), paths in by_flags.items():
        for at in range(0, len(paths), AT_ONCE):
            yield flags, paths[at:at + AT_ONCE]


def including(paths, folder):
    """Writes a file that includes these sources and returns its name."""
    with tempfile.NamedTemporaryFile("w", suffix=".cpp", dir=folder, delete=False) as file:
        file.write("".join(f'#include "{path}"\n' for path in paths))
    return file.name


def parts(flags, paths, folder):
    """Divides the sources into as few lists as possible that compile as one."""
    while len(paths) > 1:
        command = ["clang++", "-fsyntax-only", "-w", "-ferror-limit=0", *flags, including(paths, folder)]
        errors = subprocess.run(command, capture_output=True, text=True, check=False).stderr
        wrong = set(re.findall(r"^(/[^:\n]+):\d+:\d+: (?:fatal )?error:", errors, flags=re.M))
        later = [path for path in paths if path in wrong]
        if wrong and len(later) in (0, len(paths)):
            break
        yield [path for path in paths if path not in later]
        paths = later
    yield from ([path] for path in paths)


def problems(flags, paths, folder):
    """Returns the messages of clang-tidy about these sources."""
    source = paths[0] if len(paths) == 1 else including(paths, folder)
    command = ["clang-tidy", "--quiet", "--config-file=.clang-tidy", source, "--", *flags, *EXTRA]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout if done.returncode else ""


def check(flags, paths, folder):
    return "".join(problems(flags, part, folder) for part in parts(flags, paths, folder))


def main(build, jobs, *files):
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(int(jobs)) as pool:
        work = [pool.submit(check, flags, paths, folder) for flags, paths in groups(pathlib.Path(build), files)]
        found = "".join(each.result() for each in work)
    print(found, end="")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
