# Functions for the command-line cases. A case is a bash script that is sourced after this file, in an empty folder of its own;
# $E2LF is the binary, $SOURCES the root of the repository, $TESTSUITE the folder of this file, $E2LF_DATA (maybe unset) the
# folder of test data. It fails at the first command that fails.
set -euo pipefail

# part <name>: begins a part of a case, in an empty folder of its own.
case_folder=$PWD
part() { mkdir "$case_folder/$1" && cd "$case_folder/$1"; }

# Debian's python3, which has numpy and h5py.
py() { /usr/bin/python3 "$@"; }

# make <kind> <path> [key=value ...]: see make_inputs.py.
make() { py "$TESTSUITE/make_inputs.py" "$@"; }

# other_codes <file.npy>: four patterns that no bundled model was trained for.
other_codes() {
  py - "$1" <<'CODES'
import numpy, sys
row, column = numpy.mgrid[:8, :8]
discs = [(row - y) ** 2 + (column - x) ** 2 <= 3 for y, x in ((5.5, 1.5), (5.5, 5.5), (1.5, 5.5))]
numpy.save(sys.argv[1], numpy.array([0 * discs[0], *discs], numpy.float32))
CODES
}

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# in_clean_root <command...>: runs it without the sources and the build, apart from the simulated camera that programs load.
in_clean_root() {
  local camera=$SOURCES/build/stand_in_hal/prefix
  [ -d "$camera" ] || camera=.
  "$TESTSUITE/clean_root.sh" "$camera" "$@"
}

# skip_sanitizers <reason>: the case says nothing of a build with sanitizers.
skip_sanitizers() {
  [ -z "${E2LF_SANITIZE:-}" ] || skip "$1"
}

# skip <reason>: the case needs something that is not here (CTest shows it as skipped).
skip() {
  echo "SKIPPED: $*"
  exit 77
}

need_data() {
  [ -n "${E2LF_DATA:-}" ] && [ -e "$E2LF_DATA/$1" ] || skip "no test data $1 (set E2LF_DATA)"
}

# fails <exit code> <text on stderr> <command...>: the command must end with that code and say that.
fails() {
  local code=$1 text=$2 got=0
  shift 2
  "$@" >stdout.txt 2>stderr.txt || got=$?
  [ "$got" -eq "$code" ] || fail "exit code $got instead of $code from: $* ($(cat stderr.txt))"
  grep -qF -- "$text" stderr.txt || fail "no \"$text\" in the message of: $*: $(cat stderr.txt)"
}

exists() {
  local path
  for path in "$@"; do [ -e "$path" ] || fail "$path was not written"; done
}

absent() {
  local path
  for path in "$@"; do [ ! -e "$path" ] || fail "$path is there but should not be"; done
}

# wait_for <path> <process id>: until the process has written it, however long that takes; fails when the process ends.
wait_for() {
  until [ -s "$1" ]; do
    kill -0 "$2" 2>/dev/null || [ -s "$1" ] || fail "the process ended before it wrote $1"
    sleep 0.1
  done
}

# json <file> <python expression on the parsed file j>: prints it.
json() {
  py -c 'import json, sys; j = json.load(open(sys.argv[1])); print(eval(sys.argv[2]))' "$1" "$2"
}

# check <python expression>: must be true.
check() {
  py -c 'import sys; sys.exit(0 if eval(sys.argv[1]) else 1)' "$1" || fail "not true: $1"
}
