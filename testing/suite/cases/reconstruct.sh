# e2lf reconstruct.

part reconstruct_network
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
[ "$(json triple_out/run.json 'j["options"]["precision"]')" = float32 ] || fail "precision of a network that was not checked"
py - <<'PY'
import numpy as np
assert np.array_equal(np.load("twice/lightfield.npy"), 2 * np.load("plain/lightfield.npy")), "gain, or threads, change the values"
PY
# The record keeps what is wrong with the events of a cycle.
py -c 'import numpy as np; events = np.zeros((3, 40, 72), np.int16); events[:, 5, 5:9] = 1; np.savez("dark.npz", events=events)'
"$E2LF" reconstruct dark.npz -m model.safetensors -o dark --quiet 2>warning.txt
[ "$(json dark/run.json 'j["notes"]["cycles"][0]["findings"][0]["code"]')" = events-few ] || fail "no finding in the record"
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
bundled=$SOURCES/models/e2lf-n4.safetensors
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
grep -q "patterns-foreign" warning.txt || fail "no warning: $(cat warning.txt)"
"$E2LF" reconstruct demo/events.npz -m "$bundled" -o right 2>silence.txt >log.txt
if grep -q "patterns-" silence.txt; then fail "a warning about the model's own patterns"; fi
"$E2LF" reconstruct other.npz -m "$bundled" --method inversion -o with_model --format npy --quiet
"$E2LF" reconstruct other.npz --method inversion -o alone --format npy --quiet
cmp with_model/lightfield.npy alone/lightfield.npy

part reconstruct_errors
# Every kind of bad input is refused with a message that says what and where, and leaves nothing behind.
make release weights
"$E2LF" model import --release weights -o model.safetensors --quiet
make events events.npz
run() { fails "$1" "$2" "$E2LF" reconstruct "${@:3}" -o out; absent out; }

make events wrong_n.npz transitions=2
run 1 "2" wrong_n.npz -m model.safetensors
make events nan.npz nan=1
run 1 "nan.npz" nan.npz -m model.safetensors
head -c 100000 model.safetensors >truncated.safetensors
run 1 "truncated.safetensors" events.npz -m truncated.safetensors
printf '\xff\xff\xff\xff\xff\xff\x00\x00{}' >huge_header.safetensors
run 1 "huge_header.safetensors" events.npz -m huge_header.safetensors
make release wrong_shape transpose=1
fails 1 "conv1.weight" "$E2LF" model import --release wrong_shape -o wrong.safetensors
absent wrong.safetensors
py - <<'PY'
data = open("model.safetensors", "rb").read()
open("unknown.safetensors", "wb").write(data.replace(b"conv-graph", b"conv-grape"))
PY
run 1 "conv-grape" events.npz -m unknown.safetensors
run 1 "missing.npz" missing.npz -m model.safetensors
run 2 "--gian" events.npz -m model.safetensors --gian 2
run 1 "\"bright\" is not a gain" events.npz -m model.safetensors --gain bright
run 2 "did you mean" events.npz -m model.safetensors --set precison=float32

# Codes that cannot have made these events.
py -c 'import json; json.dump({"patterns": [["00000000"] * 8] + [["01000000"] * 8] * 4}, open("five.json", "w"))'
run 1 "the codes have 5 patterns" events.npz -m model.safetensors --codes five.json

# Existing output stays as it is without --overwrite.
mkdir taken && echo keep >taken/file
fails 1 "(--overwrite)" "$E2LF" reconstruct events.npz -m model.safetensors -o taken
[ "$(cat taken/file)" = keep ] || fail "the existing output was touched"
# An output that cannot be written (its parent is a file) is refused before work starts.
fails 1 "taken/file" "$E2LF" reconstruct events.npz -m model.safetensors -o taken/file/wall
[ -z "$(find . -name '*.part')" ] || fail "temporary files were left behind"

part several_cycles
# Light fields of several cycles: how many there are, which inputs they take, and what is refused.
told=$SOURCES/models/e2lf-n4-capture.safetensors own=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" codes show -o codes.json --quiet >codes.txt
"$E2LF" simulate demo/scene --codes codes.json --camera evk4-lcos --cycles 5 -o five.npz --quiet
"$E2LF" reconstruct five.npz -m "$told" --cycles-per-field 2 -o pairs --format npy --gain 1 --quiet 2>warnings.txt
exists pairs/cycle_00000/lightfield.npy pairs/cycle_00001/lightfield.npy
absent pairs/cycle_00002
[ "$(json pairs/run.json '[(l["reason"], l["count"]) for l in j["notes"]["left_out"]]')" = "[('left_over_cycles', 1)]" ] || fail "the fifth cycle"
"$E2LF" reconstruct five.npz -m "$told" --cycles-per-field 3 -o three --json 2>warnings.txt >three.json
[ "$(json three.json '[(l["reason"], l["count"]) for l in j["left_out"]]')" = "[('left_over_cycles', 2)]" ] || fail "two cycles"
grep -q "left out 2 of the complete cycles" warnings.txt || fail "$(cat warnings.txt)"
"$E2LF" reconstruct five.npz -m "$told" --cycles-per-field 5 -o all --format npy --gain 1 --quiet 2>warnings.txt
exists all/lightfield.npy

# Cycles that are all alike, of a camera without noise: their mean is each of them, and the network knows of how many.
py -c 'import numpy as np; e = np.load("five.npz"); np.savez("alike.npz", events=np.repeat(e["events"][:1], 4, axis=0), codes=e["codes"])'
"$E2LF" reconstruct alike.npz -m "$told" --cycles-per-field 4 -o four --format npy --gain 1 --quiet 2>warnings.txt
"$E2LF" reconstruct five.npz -m "$told" -o single --format npy --gain 1 --quiet 2>warnings.txt
cat >compare.py <<'PY'
import numpy as np
four, one = np.load("four/lightfield.npy"), np.load("single/cycle_00000/lightfield.npy")
assert four.shape == one.shape == (8, 8, 48, 64)
assert 0 < np.abs(four - one).mean() < 0.3 * one.mean(), np.abs(four - one).mean()
PY
py compare.py

# Fused cycles of a still scene are their mean, in the units of fused counts, for each cycle and as many pixels.
"$E2LF" reconstruct alike.npz -m "$told" --fuse 4 -o fused --format npy --gain 1 --quiet 2>warnings.txt
[ "$(json fused/run.json 'j["notes"]["cycles"][3]["fused_cycles"]')" = 4.0 ] || fail "not all pixels rest on four cycles"
py -c 'import numpy as np; a, b = np.load("four/lightfield.npy"), np.load("fused/cycle_00003/lightfield.npy"); assert np.abs(a - b).max() < 1e-4, np.abs(a - b).max()'
fails 1 "--fuse" "$E2LF" reconstruct alike.npz -m "$own" --fuse 4 -o x
fails 1 "--fuse" "$E2LF" reconstruct alike.npz --method inversion --fuse 4 -o x
fails 1 "--fuse" "$E2LF" reconstruct alike.npz -m "$told" --fuse 4 --cycles-per-field 2 -o x

# Of a recording too.
"$E2LF" simulate demo/scene --codes codes.json --camera evk4-lcos --cycles 5 -o five.raw --quiet
"$E2LF" reconstruct five.raw -m "$told" --cycles-per-field 2 -o recorded --quiet 2>warnings.txt
exists recorded/cycle_00000/00_00.png recorded/cycle_00001/00_00.png
absent recorded/cycle_00002

fails 1 'fewer than the 6' "$E2LF" reconstruct five.npz -m "$told" --cycles-per-field 6 -o x
fails 1 "--cycles-per-field" "$E2LF" reconstruct five.npz -m "$own" --cycles-per-field 2 -o x
fails 1 "--cycles-per-field" "$E2LF" reconstruct five.npz --method inversion --cycles-per-field 2 -o x
fails 2 'cycles-per-field' "$E2LF" reconstruct five.npz -m "$told" --cycles-per-field 0 -o x
absent x

# Weights in 16 bits.
"$E2LF" model store "$own" -o half.safetensors
py - <<'PY'
import json
with open("half.safetensors", "rb") as file:
    tensors = json.loads(file.read(int.from_bytes(file.read(8), "little")))
assert all(tensor["dtype"] == "BF16" for name, tensor in tensors.items() if name.endswith(".weight"))
PY
fails 1 'half.safetensors' "$E2LF" model store "$own" -o half.safetensors
# What faster arithmetic loses is measured and stored.
"$E2LF" model store "$own" -o checked.safetensors --check demo/scene
"$E2LF" model info checked.safetensors --json >checked.json
check "abs($(json checked.json "j['precision_loss']['int16_db']")) < 0.1"
