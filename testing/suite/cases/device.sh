# --device computes networks with torch: the same light fields as the engine, and an error before anything is computed.
"$E2LF" demo -o demo --width 64 --height 48 --quiet >demo.txt
"$E2LF" simulate demo/scene -m e2lf-n4 -o events.npz --quiet
reconstruct() { "$E2LF" reconstruct events.npz -m e2lf-n4 -o "$1" --format npy --gain 1 --precision float32 --quiet "${@:2}"; }
torch=$(dirname "$E2LF")/e2lf-torch
if [ -x "$torch" ]; then missing="CUDA devices"; else missing=$torch; fi
fails 1 "$missing" reconstruct cuda --device cuda:99
fails 1 "$missing" "$E2LF" depth events.npz -o cuda --device cuda:99
absent cuda
[ -x "$torch" ] || skip "e2lf was built without torch"
fails 1 "no device" reconstruct cuda --device cuda:x
fails 1 "no device" reconstruct cuda --device tpu
fails 1 "does not compute in int16" "$E2LF" reconstruct events.npz -m e2lf-n4 -o cuda --precision int16 --device torch-cpu
reconstruct cpu
reconstruct torch --device torch-cpu 2>torch.txt
[ ! -s torch.txt ] || fail "the program that continues says: $(cat torch.txt)"
py -c "
import numpy as np
cpu, torch = (np.load(name + '/lightfield.npy') for name in ('cpu', 'torch'))
assert 0 < abs(cpu - torch).max() < 1e-5, abs(cpu - torch).max()" || fail "another light field"
[ "$(json torch/run.json 'j["options"]["device"]')" = torch-cpu ] || fail "the record: $(json torch/run.json 'j["options"]')"

cat >compare.json <<'JSON'
{"name": "devices", "methods": [{"name": "network", "algorithm": "network", "model": "e2lf-n4"}],
 "scenes": [{"name": "demo", "scenes": ["demo:1"], "width": 64, "height": 48}], "pictures": false}
JSON
"$E2LF" compare compare.json -o compared --quiet
"$E2LF" compare compare.json -o compared --device torch-cpu --json >again.json
[ "$(json again.json 'j["new_results"]')" = 1 ] || fail "the results of another device were taken over"

"$E2LF" simulate demo/scene -m e2lf-n4 -o a.raw --cycles 3 --quiet
"$E2LF" live replay:a.raw -m e2lf-n4 --no-page --size full --last last.npy --device torch-cpu --quiet >live.txt 2>&1 ||
  fail "$(cat live.txt)"
