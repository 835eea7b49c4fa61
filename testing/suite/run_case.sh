#!/usr/bin/env bash
# run_case.sh <case.sh>: runs one command-line case in a new empty folder.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
case_file=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
export TESTSUITE=$here SOURCES=${here%/testing/suite}
folder=$(mktemp -d)
remove_folder() { rm -rf "$folder"; }
trap remove_folder EXIT
cd "$folder"
# shellcheck source=lib.sh
source "$here/lib.sh"
# shellcheck disable=SC1090
source "$case_file"
