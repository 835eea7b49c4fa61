# Names of files, and of what is bundled.

part by_name
# Bundled models are given by name, patterns come out of models, and a record works from any folder.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" simulate demo/scene -m e2lf-n4 -o named.npz --quiet
"$E2LF" simulate demo/scene -m "$model" -o path.npz --quiet
cmp named.npz path.npz
"$E2LF" reconstruct named.npz -m e2lf-n4.safetensors -o named --quiet
"$E2LF" model info e2lf-n8 >info.txt
grep -q "e2lf-n8" info.txt || fail "$(cat info.txt)"
fails 1 "e2lf-n4-capture" "$E2LF" simulate demo/scene -m e2lf-n5 -o out.npz
# A file of exactly this name goes before the bundled one.
cp "$SOURCES/models/e2lf-n8.safetensors" e2lf-n4
"$E2LF" simulate demo/scene -m e2lf-n4 -o file.npz --quiet
[ "$(py -c 'import numpy; print(numpy.load("file.npz")["codes"].shape[0])')" = 8 ] || fail "the file was not taken"
rm e2lf-n4
# Patterns of a model.
"$E2LF" simulate demo/scene --codes e2lf-n8 -o codes.npz --quiet
[ "$(py -c 'import numpy; print(numpy.load("codes.npz")["codes"].shape[0])')" = 8 ] || fail "not the patterns of e2lf-n8"
"$E2LF" reconstruct codes.npz -m e2lf-n8 --codes e2lf-n8 -o codes --quiet 2>err.txt || fail "$(cat err.txt)"
# Without any, the patterns of e2lf-n4, so that the next step finds its network.
"$E2LF" simulate demo/scene -o default.npz >said.txt 2>&1
grep -q "e2lf-n4" said.txt || fail "$(cat said.txt)"
"$E2LF" reconstruct default.npz -o default --quiet
# The record of a run works from any folder, and after its folder was moved.
mkdir elsewhere
mv named moved
(cd elsewhere && "$E2LF" reconstruct --config ../moved/run.json -o again --quiet)
cmp moved/03_04.png elsewhere/again/03_04.png
(cd elsewhere && "$E2LF" reconstruct --config ../moved -o of_folder --quiet)
cmp moved/03_04.png elsewhere/of_folder/03_04.png
"$E2LF" simulate --config named.npz -o of_file.npz --quiet
cmp named.npz of_file.npz
# As documents write it, from any folder.
(cd elsewhere && "$E2LF" model info models/e2lf-n4.safetensors >/dev/null)
cp "$model" patterns.safetensors
cp "$SOURCES/cameras/evk4-lcos.json" camera.json
"$E2LF" reconstruct named.npz --codes patterns.safetensors -o of_patterns --quiet
"$E2LF" reconstruct named.npz --camera camera.json -o of_camera --quiet
mv patterns.safetensors camera.json elsewhere
in_elsewhere() { (cd elsewhere && "$E2LF" "$@"); }
fails 1 "(--codes)" in_elsewhere reconstruct --config ../of_patterns -o again_patterns
grep -qF "$PWD/patterns.safetensors: there is no such" stderr.txt || fail "$(cat stderr.txt)"
fails 1 "(--camera)" in_elsewhere reconstruct --config ../of_camera -o again_camera
grep -qF "$PWD/camera.json: there is no such" stderr.txt || fail "$(cat stderr.txt)"
mv named.npz gone.npz
fails 1 "named.npz" "$E2LF" reconstruct --config moved/run.json -o again

part file_names
# Names of files may hold any byte but "/": what is said of them in JSON is valid all the same.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
odd=$(printf 'odd\377name')
cp -r demo/scene "$odd"
parsed() { py -c 'import json, sys; json.loads(sys.stdin.buffer.read().decode())'; }
"$E2LF" simulate "$odd" -o "$odd.raw" --cycles 2 --json | parsed
"$E2LF" info "$odd.raw" --json | parsed
"$E2LF" convert "$odd.raw" "$odd.csv" --json 2>stderr.txt | parsed
"$E2LF" accumulate "$odd.raw" -o "$odd.npz" --json | parsed
"$E2LF" reconstruct "$odd.raw" --method inversion -o "$odd.out" --json 2>stderr.txt | parsed
"$E2LF" eval "$odd" demo/recon -o "$odd.json" --json | parsed
"$E2LF" convert "$odd" "$odd.npy" --json | parsed
"$E2LF" codes show -o "codes$odd.json" --json | parsed
parsed <"$odd.json"
for record in "$odd".*.run.json "$odd.out/run.json"; do
  parsed <"$record" || fail "the record $record"
  py -c 'import json, sys; assert "odd\ufffdname" in open(sys.argv[1], encoding="utf-8").read()' "$record"
done
