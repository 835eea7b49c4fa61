# Light fields of several cycles: how many there are, which inputs they take, and what is refused.
told=$TESTSUITE/../models/e2lf-n4-capture.safetensors own=$TESTSUITE/../models/e2lf-n4.safetensors
"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" codes show -o codes.json --quiet >codes.txt
"$E2LF" simulate demo/scene --codes codes.json --camera evk4-lcos --cycles 5 -o five.npz --quiet
"$E2LF" reconstruct five.npz -m "$told" --cycles-per-field 2 -o pairs --format npy --gain 1 --quiet 2>warnings.txt
exists pairs/cycle_00000/lightfield.npy pairs/cycle_00001/lightfield.npy
absent pairs/cycle_00002
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

# Of a recording too.
"$E2LF" simulate demo/scene --codes codes.json --camera evk4-lcos --cycles 5 -o five.raw --quiet
"$E2LF" reconstruct five.raw -m "$told" --cycles-per-field 2 -o recorded --quiet 2>warnings.txt
exists recorded/cycle_00000/00_00.png recorded/cycle_00001/00_00.png
absent recorded/cycle_00002

fails 1 'fewer than the 6' "$E2LF" reconstruct five.npz -m "$told" --cycles-per-field 6 -o x
fails 1 'cycle' "$E2LF" reconstruct five.npz -m "$own" --cycles-per-field 2 -o x
fails 1 'cycle' "$E2LF" reconstruct five.npz --method inversion --cycles-per-field 2 -o x
fails 2 'cycles-per-field' "$E2LF" reconstruct five.npz -m "$told" --cycles-per-field 0 -o x
absent x

# Weights in 16 bits: half the size, nearly the same light field.
"$E2LF" model store "$own" -o half.safetensors
"$E2LF" model store "$own" -o full.safetensors --weights float32
check "$(stat -c %s half.safetensors) < 0.55 * $(stat -c %s full.safetensors)"
fails 1 'half.safetensors' "$E2LF" model store "$own" -o half.safetensors
