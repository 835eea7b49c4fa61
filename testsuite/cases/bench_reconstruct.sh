# A small image through the reconstruction benchmark: every row is there; sizes that the network does not take are refused. Speed itself is never tested.
"$E2LF-bench" reconstruct --width 48 --height 32 --runs 1 --json --quiet >report.json
[ "$(json report.json "(j['image'], j['float32']['seconds']['median'] > 0)")" = "([32, 48], True)" ] || fail "report"
model=$TESTSUITE/../models/e2lf-n4.safetensors
grep -q "the peer knows only the paper's network" <<<"$("$E2LF-bench" reconstruct -m "$model" --width 48 --height 32 --runs 1 --quiet)" || fail "table"
fails 1 "--width: 1284 pixels" "$E2LF-bench" reconstruct -m "$model" --width 1284
fails 1 "multiple of 8" "$E2LF-bench" reconstruct -m "$model" --height 721
if [ -e "$E2LF_BUILD/onnx/.installed" ] && command -v node >/dev/null; then
  "$E2LF-bench" reconstruct -m "$model" --width 48 --height 32 --runs 2 --onnx "$E2LF_BUILD/onnx" --json --quiet >onnx.json
  check "$(json onnx.json "j['onnx_runtime']['seconds']['min'] > 0 and j['float32']['ratio_to_onnx_runtime'] > 0")"
fi
grep -q "ONNX Runtime does not run" <<<"$("$E2LF-bench" reconstruct -m "$model" --width 48 --height 32 --runs 1 --onnx . --quiet)" || fail "no ONNX Runtime"
for option in width height runs; do
  fails 2 "--$option" "$E2LF-bench" reconstruct --$option 0
done
for option in width height; do
  fails 2 "--$option" "$E2LF-bench" simulate --$option 0
done
