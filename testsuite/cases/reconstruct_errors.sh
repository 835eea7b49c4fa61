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
fails 1 "folder" "$E2LF" reconstruct events.npz -m model.safetensors -o taken/file/wall
[ -z "$(find . -name '*.part')" ] || fail "temporary files were left behind"
