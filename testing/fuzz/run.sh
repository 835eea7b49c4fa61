#!/usr/bin/env bash
# testing/fuzz/run.sh SECONDS JOBS [TARGET...]: runs fuzz targets of build/fuzz (default: all) for SECONDS each, JOBS at a time.
# With FUZZ_FIXED set, each target tries its seeds and a fixed number of new inputs, nearly the same each time, for at most
# SECONDS. The seeds are those of e2lf_fuzz_seeds, testing/fuzz/corpus/<target>/ (inputs that once broke a reader), the findings of
# earlier runs (build/fuzz/found/<target>/) and, if E2LF_DATA is set, the beginnings of its recordings, for this run only.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=$1 jobs=$2
shift 2
build=build/fuzz
export OMP_NUM_THREADS=1  # runs are repeatable

# Files are in memory if possible, because many readers require a file.
[ ! -w /dev/shm ] || export TMPDIR=/dev/shm
seeds=$(mktemp -d)
trap 'rm -rf "$seeds"' EXIT
mkdir "$seeds/tmp"
export TMPDIR=$seeds/tmp
"$build/bin/e2lf_fuzz_seeds" "$seeds"
if [ -d "${E2LF_DATA:-}/events" ]; then
  for file in "$E2LF_DATA"/events/*.raw "$E2LF_DATA"/events/*/*; do
    case $(basename "$file") in
      evt21*) target=evt2.1 ;;
      evt2*.raw) target=evt2 ;;
      *.raw) target=evt3 ;;
      *.dat) target=dat ;;
      *.aedat4) target=aedat4 ;;
      *.db3) target=rosbag ;;
      *) continue ;;
    esac
    head -c 6000 "$file" >"$seeds/$target/data_$(basename "$file")"
  done
fi

# The limits of a target: 256 MiB for one allocation, 1 GiB in total, 100 s for one input (inputs take at most 2 s, but machines
# may be busy). For a damaged file, the HDF5 library allocates the size that the file states, some GiB, before our driver
# refuses to read; such allocations fail. The library also leaks memory (leaks.txt).
run_target() {
  local target=$1 folder found=$build/found/$1 folders=() inputs=() malloc_limit=256 sanitizer=allocator_may_return_null=0
  case $target in
    hdf5 | dsec | light_field_hdf5) malloc_limit=0 sanitizer=allocator_may_return_null=1:max_allocation_size_mb=256 ;;
  esac
  if [ -n "${FUZZ_FIXED:-}" ]; then
    # Traced comparisons contain addresses and process ids, which would prevent repeatable inputs.
    # The code that a run reaches still varies slightly with the threads, so a run may have findings that the last one had not.
    inputs=(-seed=1 -use_cmp=0 -runs=20000)
    found=$SEEDS/found_$target
  fi
  mkdir -p "$found" "$build/logs"
  for folder in "$SEEDS/$target" "testing/fuzz/corpus/$target"; do [ ! -d "$folder" ] || folders+=("$folder"); done
  if ! ASAN_OPTIONS=$sanitizer LSAN_OPTIONS=suppressions=testing/fuzz/leaks.txt:print_suppressions=0 "$build/bin/fuzz_$target" \
    -max_total_time="$SECONDS_EACH" -max_len=8192 -timeout=100 -rss_limit_mb=1024 -malloc_limit_mb="$malloc_limit" "${inputs[@]}" \
    -print_final_stats=1 -artifact_prefix="$build/finding-$target-" "$found" "${folders[@]}" >"$build/logs/$target.txt" 2>&1; then
    tail -n 40 "$build/logs/$target.txt"
    echo "fuzz: $target found something; run $build/bin/fuzz_$target on the file that is named above"
    return 1
  fi
  awk -v target="$target" '
    /stat::number_of_executed_units/ { runs = $2 }
    /stat::average_exec_per_sec/ { rate = $2 }
    /cov:/ { for (i = 1; i < NF; ++i) if ($i == "cov:") edges = $(i + 1) }
    END {
      printf "fuzz: %-16s %10d inputs, %6d /s, %5d edges, nothing found\n", target, runs, rate, edges
      if (runs < 1000) printf "fuzz: %s tried fewer than 1000 inputs; make it faster or give it more time\n", target
    }' "$build/logs/$target.txt"
}
export -f run_target
export build SEEDS=$seeds SECONDS_EACH=$seconds

targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
  for program in "$build"/bin/fuzz_*; do targets+=("${program#"$build/bin/fuzz_"}"); done
fi
printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -I{} bash -euo pipefail -c 'run_target {}'
