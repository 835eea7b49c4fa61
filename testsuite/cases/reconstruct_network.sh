# Event images and an imported model to 64 views; float32 and its arithmetic twin agree; the gain is applied.
make release weights
"$E2LF" model import --release weights -o model.safetensors
exists model.safetensors model.safetensors.run.json
"$E2LF" model info model.safetensors --json >model.json
[ "$(json model.json "j['network']['parameters']")" = 948352 ] || fail "parameters of the paper's network"
make events events.npz height=40 width=72
make triple triple height=40 width=72
"$E2LF" reconstruct events.npz -m model.safetensors -o plain --format npy --gain 1 --precision float32
exists plain/lightfield.npy plain/contact_sheet.png plain/epi.png plain/run.json
py - <<'PY'
import numpy as np
plain = np.load("plain/lightfield.npy")
assert plain.shape == (8, 8, 40, 72) and plain.dtype == np.float32, (plain.shape, plain.dtype)
PY
"$E2LF" reconstruct events.npz -m model.safetensors -o twice --format npy --gain 2 --precision float32 --threads 1
"$E2LF" reconstruct triple -m model.safetensors -o triple_out
exists triple_out/00_00.png triple_out/07_07.png
py - <<'PY'
import numpy as np
assert np.array_equal(np.load("twice/lightfield.npy"), 2 * np.load("plain/lightfield.npy")), "gain, or threads, change the values"
PY
# Several cycles: a folder each.
make events cycles.npz cycles=3 height=16 width=24
"$E2LF" reconstruct cycles.npz -m model.safetensors -o cycles
exists cycles/cycle_00000/00_00.png cycles/cycle_00002/07_07.png cycles/run.json
# The configuration file and --set say the same as flags do.
echo '{"gain": "2", "format": "npy", "precision": "float32"}' >config.json
"$E2LF" reconstruct events.npz -m model.safetensors -o configured --config config.json
cmp configured/lightfield.npy twice/lightfield.npy
# Passes move the grid of a network that works at reduced resolution; the paper's has none, and makes one.
"$E2LF" reconstruct events.npz -m model.safetensors -o passes --format npy --gain 1 --precision float32 --passes 3
cmp passes/lightfield.npy plain/lightfield.npy
[ "$(json passes/run.json "j['notes']['passes']")" = 1 ] || fail "passes of a network without a grid"
bundled=$TESTSUITE/../models/e2lf-n4.safetensors
"$E2LF" reconstruct events.npz -m "$bundled" -o one --format npy --gain 1
"$E2LF" reconstruct events.npz -m "$bundled" -o two --format npy --gain 1 --passes 2
py - <<'PY'
import numpy as np
one, two = np.load("one/lightfield.npy"), np.load("two/lightfield.npy")
assert one.shape == two.shape and 0 < np.abs(one - two).mean() < 0.1, np.abs(one - two).mean()
PY
# Events that other patterns made are reconstructed with a warning; the inversion takes the patterns of the events.
"$E2LF" demo -m "$bundled" -o demo --width 96 --height 64 --quiet
other_codes other.npy
"$E2LF" simulate demo/scene --codes other.npy -o other.npz --quiet
"$E2LF" reconstruct other.npz -m "$bundled" -o warned 2>warning.txt >log.txt
grep -q "other patterns than e2lf-n4" warning.txt || fail "no warning: $(cat warning.txt)"
"$E2LF" reconstruct demo/events.npz -m "$bundled" -o right 2>silence.txt >log.txt
if grep -q "other patterns" silence.txt; then fail "a warning about the model's own patterns"; fi
"$E2LF" reconstruct other.npz -m "$bundled" --method inversion -o with_model --format npy --quiet
"$E2LF" reconstruct other.npz --method inversion -o alone --format npy --quiet
cmp with_model/lightfield.npy alone/lightfield.npy
