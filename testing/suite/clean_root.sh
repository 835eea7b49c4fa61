#!/usr/bin/env bash
# clean_root.sh KEPT COMMAND...: runs a command where nothing exists of the sources and their builds but the folder KEPT, as on
# the machine of somebody who installed e2lf. Where the system permits no namespaces, it only runs the command.
set -euo pipefail
unshare --map-root-user --mount true 2>/dev/null || exec "${@:2}"
sources=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
export sources
exec unshare --map-root-user --mount bash -ec '
  mount --bind "$0" /mnt
  mount -t tmpfs none "$sources"
  case $0 in
    "$sources"/*) mkdir -p "$0" && mount --bind /mnt "$0" ;;
  esac
  cd "$PWD"
  exec "$@"' "$(realpath "$1")" "${@:2}"
