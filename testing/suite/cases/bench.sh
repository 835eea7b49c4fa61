# e2lf-bench: every row is there. Speed itself is never tested.

part bench_decode
# Small streams through the decoding benchmark: the shapes are there, counts are exact, rates are numbers. Speed itself is never tested.
"$E2LF-bench" decode --events 20000 --seconds 0 --json --quiet >synthesised.json
[ "$(json synthesised.json "[s['shape'] for s in j['streams']]")" = "['evt3 dense', 'evt3 sparse', 'evt3 vector', 'evt2', 'evt2.1']" ] || fail "shapes"
json synthesised.json "all(20000 <= s['events'] < 20032 for s in j['streams'])" | grep -q True || fail "events"
json synthesised.json "[round(s['bytes_per_event'], 1) for s in j['streams']]" >bytes.txt
grep -q '^\[2\.[5-9], [7-9]\.[0-9], 0\.9, 4\.[0-4], 0\.[5-7]\]$' bytes.txt || fail "bytes per event: $(cat bytes.txt)"
for part in one_thread all_threads reference; do
  json synthesised.json "all(s['$part'][k] > 0 for s in j['streams'] for k in ('columns',))" | grep -q True || fail "no rates of $part"
done
check "$(json synthesised.json "j['streams'][0]['skipping']['ratio_to_one_thread'] > 0 and 'skipping' not in j['streams'][3]")"
json synthesised.json "len(j['published_on_another_machine'])" | grep -q '^6$' || fail "published figures"

# A recording is repeated to the wanted length, with its clock going on.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
"$E2LF" simulate demo/scene -o recording.raw --quiet
"$E2LF" info recording.raw --json >info.json
events=$(json info.json "j['events']")
"$E2LF-bench" decode recording.raw --events $((3 * events)) --seconds 0 --no-reference --json --quiet >repeated.json
[ "$(json repeated.json "(len(j['streams']), j['streams'][0]['events'], 'reference' in j['streams'][0])")" = "(1, $((3 * events)), False)" ] || fail "repeated"
grep -q 'recording.raw, 1 times' <<<"$("$E2LF-bench" decode recording.raw --events 1000 --seconds 0 --quiet)" || fail "the table"
mkdir converted
"$E2LF-bench" decode recording.raw --events 1000 --seconds 0 --no-reference --convert converted --json --quiet >converted.json
[ "$(json converted.json "sorted(k for k, v in j['convert'].items() if v > 0)")" = "['csv', 'hdf5']" ] || fail "convert"
[ -z "$(ls -A converted)" ] || fail "something was left behind"
"$E2LF" convert recording.raw recording.npz --quiet
fails 1 "RAW recording" "$E2LF-bench" decode recording.npz
mkdir empty
fails 1 "RAW recording" "$E2LF-bench" decode empty
fails 1 "nowhere" "$E2LF-bench" decode nowhere
# Squares that move by 8 px per cycle need room.
"$E2LF" demo -o small --width 96 --height 96 --quiet
fails 1 "no room for a square" "$E2LF-bench" motion small/scene --quiet

part bench_reconstruct
# A small image through the reconstruction benchmark: every row is there; sizes that the network does not take are refused. Speed itself is never tested.
"$E2LF-bench" reconstruct --width 48 --height 32 --runs 1 --json --quiet >report.json
[ "$(json report.json "(j['image'], j['float32']['seconds']['median'] > 0)")" = "([32, 48], True)" ] || fail "report"
# Each peer that this build has computes the same network, in bfloat16 where the CPU has its products.
for peer in onednn torch; do
  if [ -e "$(dirname "$E2LF")/e2lf_${peer}_peer.so" ]; then check "$(json report.json "'absent' not in j['peers']['${peer/#torch/libtorch}']")"; fi
done
check "$(json report.json "all(p.get('absent') or (p['float32']['snr_to_float32_db'] > 100 and p['float32']['share_of_peak'] > 0) for p in j['peers'].values())")"
check "$(json report.json "all(p['bfloat16']['snr_to_float32_db'] > 30 for p in j['peers'].values() if 'bfloat16' in p)")"
check "$(json report.json "('bfloat16' in j) == ('bfloat16' in j['peers']['onednn']) or 'absent' in j['peers']['onednn']")"
check "$(json report.json "j['peak_gflops']['float32'] > 1 and ('bfloat16' in j) == (j['peak_gflops'].get('bfloat16', 0) > 0)")"
# Without oneDNN's kernels for an instruction set, it is left out.
E2LF_MAX_ISA=scalar "$E2LF-bench" reconstruct --width 48 --height 32 --runs 1 --json --quiet >scalar.json
check "$(json scalar.json "'absent' in j['peers']['onednn'] and 'times_onednn' not in j['float32']")"
model=$SOURCES/models/e2lf-n4.safetensors
grep -q "the peer knows only the paper's network" <<<"$("$E2LF-bench" reconstruct -m "$model" --width 48 --height 32 --runs 1 --quiet)" || fail "table"
fails 1 "--width: 1284 pixels" "$E2LF-bench" reconstruct -m "$model" --width 1284
fails 1 "multiple of 8" "$E2LF-bench" reconstruct -m "$model" --height 721
if [ -e "$E2LF_BUILD/onnx/.installed" ] && command -v node >/dev/null; then
  "$E2LF-bench" reconstruct -m "$model" --width 48 --height 32 --runs 2 --onnx "$E2LF_BUILD/onnx" --json --quiet >onnx.json
  check "$(json onnx.json "j['peers']['onnx_runtime']['float32']['seconds']['min'] > 0 and j['float32']['times_onnx_runtime'] > 0")"
fi
grep -q "ONNX Runtime does not run" <<<"$("$E2LF-bench" reconstruct -m "$model" --width 48 --height 32 --runs 1 --onnx . --quiet)" || fail "no ONNX Runtime"
for option in width height runs; do
  fails 2 "--$option" "$E2LF-bench" reconstruct --$option 0
done
for option in width height; do
  fails 2 "--$option" "$E2LF-bench" simulate --$option 0
done
"$E2LF-bench" simulate --width 45 --height 31 --seconds 0 --json --quiet >simulation.json
check "$(json simulation.json "len(j) == 4 and all(v > 0 for row in j.values() for v in row.values())")"

part bench_train
# Training and synthesis against plain libtorch: every row is there, on as many threads as asked for.
[ -x "$E2LF-bench-train" ] || exit 0
"$E2LF-bench" train --batch 1 --steps 1 --threads 1 --json >rows.json
[ "$(json rows.json "j['threads']")" = 1 ] || fail "threads"
[ "$(json rows.json "[r['ratio'] for r in j['rows'] if r['name'] == \"torch's sampling\"]")" = "[1.0]" ] || fail "synthesis by torch"
[ "$(json rows.json "sorted({r['job'] for r in j['rows']})")" = "['synthesis', 'training']" ] || fail "jobs"
[ "$(json rows.json "all(r['samples_per_s'] > 0 for r in j['rows'])")" = True ] || fail "speeds"
# The trainer keeps to the instruction sets that it may use, as e2lf does.
fails 1 "E2LF_MAX_ISA" env E2LF_MAX_ISA=avx9000 "$E2LF-bench-train" 1 1
env E2LF_MAX_ISA=scalar "$E2LF-bench-train" 1 1 >scalar.json
[ "$(json scalar.json "all(r['samples_per_s'] > 0 for r in j['rows'])")" = True ] || fail "with scalar kernels"
