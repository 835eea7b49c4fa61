# Files beside tables of events that are none: what they are and what to do about it.
py - <<'PY'
import os
open("pointer.raw", "w").write("version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12345\n")
open("list.json", "w").write(str([[i, 1, 2, 1] for i in range(100)]))
open("table.feather", "wb").write(b"ARROW1" + bytes(300))
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
fails 1 "Feather" "$E2LF" convert table.feather out.npz
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
