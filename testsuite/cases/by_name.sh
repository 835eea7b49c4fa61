# Bundled models are given by name, patterns come out of models, and a record works from any folder.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
model=$TESTSUITE/../models/e2lf-n4.safetensors
"$E2LF" simulate demo/scene -m e2lf-n4 -o named.npz --quiet
"$E2LF" simulate demo/scene -m "$model" -o path.npz --quiet
cmp named.npz path.npz
"$E2LF" reconstruct named.npz -m e2lf-n4.safetensors -o named --quiet
"$E2LF" model info e2lf-n8 >info.txt
grep -q "e2lf-n8" info.txt || fail "$(cat info.txt)"
fails 1 "e2lf-n4-capture" "$E2LF" simulate demo/scene -m e2lf-n5 -o out.npz
# A file of exactly this name goes before the bundled one.
cp "$TESTSUITE/../models/e2lf-n8.safetensors" e2lf-n4
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
mv named.npz gone.npz
fails 1 "named.npz" "$E2LF" reconstruct --config moved/run.json -o again
