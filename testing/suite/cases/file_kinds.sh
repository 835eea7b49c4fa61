# Kinds of files.

part file_kinds
# Every verb sees a file as the same kind of thing, and says so where it is no input of its own.
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" simulate demo/scene -m "$model" -o rec.raw --cycles 2 --quiet
"$E2LF" simulate demo/scene -m "$model" -o events.npz --quiet
"$E2LF" reconstruct rec.raw -m "$model" -o cycles --format npy --quiet
"$E2LF" convert demo/scene scene.npy --quiet
py - <<'PY'
import numpy as np
events = np.load("events.npz")["events"]
np.save("counts.npy", events[0])
np.savez_compressed("field.npz", LF=np.load("scene.npy"))
PY
kind() { "$E2LF" info "$1" --json | py -c 'import json, sys; print(json.load(sys.stdin)["kind"])'; }
expect() { # <kind> <path...>
  local kind=$1 path
  for path in "${@:2}"; do [ "$(kind "$path")" = "$kind" ] || fail "$path: $(kind "$path") instead of $kind"; done
}
expect recording rec.raw
expect "event images" events.npz counts.npy
expect "light field" demo/scene scene.npy field.npz cycles/cycle_00000
expect cycles cycles
expect model "$model"
# A folder with lightfield.npy is a light field for every verb.
"$E2LF" convert cycles/cycle_00000 views --quiet
"$E2LF" eval demo/scene cycles/cycle_00000 --quiet
# Light fields and models are no events; event images, models and folders of cycles have no other format.
for input in scene.npy field.npz demo/scene; do
  fails 1 "light field" "$E2LF" reconstruct "$input" -m "$model" -o out
done
fails 1 "e2lf-n4.safetensors" "$E2LF" reconstruct "$model" -m "$model" -o out
fails 1 "cycles/cycle_00000" "$E2LF" reconstruct cycles -m "$model" -o out
fails 1 "event images" "$E2LF" convert events.npz out
fails 1 "e2lf-n4.safetensors" "$E2LF" convert "$model" out
fails 1 "give one, e.g. cycles/cycle_00000" "$E2LF" convert cycles out
fails 1 "give one, e.g. cycles/cycle_00000" "$E2LF" eval demo/scene cycles
fails 1 "none" "$E2LF" convert none out
mkdir empty
fails 1 "empty" "$E2LF" info empty
fails 1 "empty" "$E2LF" convert empty out
fails 1 "empty" "$E2LF" reconstruct empty -m "$model" -o out
if grep -q -- --export <<<"$("$E2LF" view --help)"; then
  fails 1 "empty" "$E2LF" view empty --export page.html
fi
# An archive is told by its headers: the data behind them are not read for it.
py - <<'PY'
import numpy as np
np.savez("stored.npz", events=np.load("events.npz")["events"])
data = bytearray(open("stored.npz", "rb").read())
data[len(data) // 2] ^= 255
open("damaged.npz", "wb").write(data)
PY
fails 1 "event images" "$E2LF" convert damaged.npz out
fails 1 "checksum" "$E2LF" info damaged.npz
absent out page.html
# Files of settings say what they are and show what matters.
"$E2LF" codes render -m e2lf-n4 -o rendered --quiet
"$E2LF" codes show -m e2lf-n4 -o patterns.npy --quiet
"$E2LF" codes show -m e2lf-n4 -o patterns.npz --quiet
printf '0 %% bias_diff\n30 %% bias_fo\n' >sensor.bias
says() {
  "$E2LF" info "$1" >said.txt || fail "$1"
  grep -q -- "$2" said.txt || fail "$1: $(cat said.txt)"
  "$E2LF" info "$1" --json >said.json
  [ "$(json said.json "j['kind']")" = "$3" ] || fail "$1: $(cat said.json)"
}
says "$SOURCES/cameras/evk4-lcos.json" "^constants threshold on uncertainty" camera
says "$SOURCES/cameras/paper.json" "^event model *reference-aware" camera
says rendered/schedule.json "^cycle us *947" schedule
says rendered/codes.json "^black first *yes" codes
says patterns.npy "^views *8, 8" codes
says patterns.npz "^views *8, 8" codes
says rendered/run.json "^verb *codes render" record
says "$SOURCES/configs/first-run.json" "for .e2lf train" "training settings"
says sensor.bias "bias_fo" biases
fails 1 "sensor.bias" "$E2LF" convert sensor.bias out.raw

part foreign_files
# Files beside tables of events that are none: what they are and what to do about it.
py - <<'PY'
import os
open("pointer.raw", "w").write("version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12345\n")
open("list.json", "w").write(str([[i, 1, 2, 1] for i in range(100)]))
open("long_header.csv", "w").write("".join("# setting %d of the camera\n" % i for i in range(1000)) + "t,x,y,p\n1000,2,3,1\n")
open("text.npy", "w").write("t,x,y,p\n1000,2,3,1\n")
os.mkdir("other")
open("other/images.txt", "w").write("0 a.png\n")
head = b"% evt 2.0\n% format EVT2;height=48;width=64\n% end\n"
open("wrong.raw", "wb").write(head + bytes.fromhex("ff6fff6f") * 4000)
PY
for input in long_header.csv text.npy; do
  "$E2LF" info "$input" --json >info.json
  check "$(json info.json "j['events'] == 1 and j['read_as']['columns'] == 't, x, y, p'")"
done
fails 1 "git lfs pull" "$E2LF" convert pointer.raw out.npz
fails 1 "JSON" "$E2LF" convert list.json out.npz
fails 1 "images.txt" "$E2LF" convert other out.npz
fails 1 "--event-format" "$E2LF" convert wrong.raw out.npz
cp long_header.csv ./-x.csv
fails 2 "./-x.csv" "$E2LF" info -x.csv
py - <<'PY'
import pickle
for name, begin in (("a.lfp", b"\x89LFP\r\n\x1a\n"), ("a.lfr", b"\x89LFP\r\n\x1a\n"), ("a.exr", bytes.fromhex("762f3101"))):
    open(name, "wb").write(begin + bytes(600))
pickle.dump(list(range(300)), open("a.pkl", "wb"))
header = b"MATLAB 5.0 MAT-file".ljust(124) + bytes.fromhex("0001494d")
open("events.mat", "wb").write(header)
PY
for word in "Lytro a.lfp" "Lytro a.lfr" "OpenEXR a.exr" "pickle a.pkl" ".csv events.mat"; do
  fails 1 "${word% *}" "$E2LF" info "${word#* }"
done
absent out.npz
# Folders of pictures that are not read, and of columns of events.
py - <<'PY'
import os
import numpy as np
os.mkdir("views")
for view in range(64):
    open(f"views/{view // 8:02d}_{view % 8:02d}.exr", "wb").write(bytes.fromhex("762f3101") + bytes(100))
os.mkdir("columns")
time, place = np.arange(2000) * 1e-6, np.arange(2000) % 48
for key, column in dict(t=time, xy=np.stack([place, place], 1), p=place % 2).items():
    np.save(f"columns/events_{key}.npy", column)
PY
for verb in info "convert -o field" "simulate -o field.npz" "depth -o field" "pack -o field.safetensors" "reconstruct -o field"; do
  # shellcheck disable=SC2086  # a verb and its option
  fails 1 "contains 64 pictures as .exr" "$E2LF" $verb views
done
"$E2LF" info columns --json >info.json
[ "$(json info.json "(j['kind'], j['events'], j['left_out'])")" = "('recording', 2000, [])" ] || fail "$(cat info.json)"
fails 1 "--sensor-width" "$E2LF" accumulate columns -o field.npz
absent field field.npz field.safetensors
