#!/usr/bin/env bash
# fuzz/run.sh SECONDS JOBS [TARGET...]: runs the fuzz targets of build/fuzz for so long each, so many at a time; all by default.
# With FUZZ_FIXED set, each tries its seeds and a fixed number of new inputs, nearly the same ones each time, SECONDS at most.
# Seeds: what e2lf_fuzz_seeds writes, fuzz/corpus/<target>/ (inputs that broke something once), what earlier runs found
# (build/fuzz/found/<target>/), and where E2LF_DATA is set the beginnings of its recordings, for this run only.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
seconds=$1 jobs=$2
shift 2
build=build/fuzz

# In memory where there is such a folder: many readers take a file.
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

# How many inputs take about 10 s of a core; 1000 at least. Inside the HDF5 library no two runs are quite the same.
fixed_runs() {
  case $1 in
    hdf5 | dsec | light_field_hdf5) echo 1500 ;;
    mat | light_field_png | light_field_npy | view_folder | model | codes | event_images) echo 2500 ;;
    evt3 | evt2.1 | hdf5_chunks) echo 5000 ;;
    evt2 | dat) echo 10000 ;;
    rosbag) echo 2500 ;;
    aedat2 | aedat3 | aedat4 | mcap | packed | csv | txt | npy) echo 25000 ;;
    camera | schedule | settings) echo 25000 ;;
    safetensors | packed_data) echo 60000 ;;
    ecf | npz | side_triggers) echo 125000 ;;
    *) echo 500000 ;;
  esac
}

# What one target is allowed: 256 MiB in one allocation, 1 GiB in all, 100 s for one input (they take 2 s at most; machines
# may be busy). Where the HDF5 library reads a whole damaged file, it asks for what the file claims, some GiB, before our
# driver refuses to read them: it is told that there is no such memory. It also leaks (leaks.txt).
run_target() {
  local target=$1 folder found=$build/found/$1 folders=() inputs=() malloc_limit=256 sanitizer=allocator_may_return_null=0
  case $target in
    hdf5 | dsec | light_field_hdf5) malloc_limit=0 sanitizer=allocator_may_return_null=1:max_allocation_size_mb=256 ;;
  esac
  if [ -n "${FUZZ_FIXED:-}" ]; then
    # What is compared with what holds addresses and process ids: no guide to the same inputs.
    # Which code a run reaches still varies a little with threads, so a run may find what the one before did not.
    inputs=(-seed=1 -use_cmp=0 "-runs=$(fixed_runs "$target")")
    found=$SEEDS/found_$target
  fi
  mkdir -p "$found" "$build/logs"
  for folder in "$SEEDS/$target" "fuzz/corpus/$target"; do [ ! -d "$folder" ] || folders+=("$folder"); done
  if ! ASAN_OPTIONS=$sanitizer LSAN_OPTIONS=suppressions=fuzz/leaks.txt:print_suppressions=0 "$build/bin/fuzz_$target" \
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
export -f run_target fixed_runs
export build SEEDS=$seeds SECONDS_EACH=$seconds

targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
  for program in "$build"/bin/fuzz_*; do targets+=("${program#"$build/bin/fuzz_"}"); done
fi
printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -I{} bash -euo pipefail -c 'run_target {}'
