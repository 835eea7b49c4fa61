# Display frames: what an aperture display shows, readable by other programs, with a schedule that accumulate takes.
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" codes render -m "$model" -o display
[ "$(find display -name 'frame_*.png' | wc -l)" = 8 ] || fail "four patterns and their inverses"
exists display/schedule.json display/schedule.csv display/codes.json display/contact_sheet.png display/run.json
[ "$(identify -format '%wx%h %z' display/frame_05_a2.png)" = "1280x1024 8" ] || fail "the paper's display"
[ "$(head -1 display/schedule.csv)" = "index,file,name,begin_us,duration_us,event_image" ] || fail "the table"
[ "$(sed -n 6p display/schedule.csv)" = "4,frame_04_a1.png,a1,47368,15000," ] || fail "black: $(sed -n 6p display/schedule.csv)"

# Black is black, its inverse the open aperture of 800x800 px; the others add up with their inverses.
cat >frames.py <<'PY'
import subprocess, sys
import numpy as np
def pixels(path):
    raw = subprocess.run(["convert", path, "-depth", "8", "gray:-"], check=True, capture_output=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(1024, 1280).astype(int)
folder, end = sys.argv[1:]
first = [pixels(f"{folder}/frame_{i:02d}_inverse_a{i + 1}.{end}") for i in range(4)]
second = [pixels(f"{folder}/frame_{i + 4:02d}_a{i + 1}.{end}") for i in range(4)]
assert second[0].sum() == 0 and first[0].sum() == 255 * 800 * 800
for a, b in zip(first, second):
    assert (a + b)[112:912, 240:1040].min() == 255 and (a + b).sum() == 255 * 800 * 800
PY
py frames.py display png
"$E2LF" codes render -m "$model" -o turned --rotate 90 --flip-x
py frames.py turned png
"$E2LF" codes render -m "$model" -o png1 --bits 1 --quiet
echo mine >png1/notes
fails 1 "(--overwrite)" "$E2LF" codes render -m "$model" -o png1 --bits 1
fails 1 "notes" "$E2LF" codes render -m "$model" -o png1 --bits 1 --overwrite
rm png1/notes
"$E2LF" codes render -m "$model" -o png1 --bits 1 --quiet --overwrite
[ "$(od -An -tu1 -j24 -N1 png1/frame_05_a2.png | tr -d ' ')" = 1 ] || fail "one bit, as the file's header says"
py frames.py png1 png

# The schedule is one that the other verbs take.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" simulate demo/scene -m "$model" --cycles 2 -o rec.raw --quiet
"$E2LF" accumulate rec.raw --schedule display/schedule.json -o events.npz --quiet
[ "$(py -c 'import numpy as np; print(np.load("events.npz")["events"].shape)')" = "(2, 3, 48, 64)" ] || fail "the schedule"

fails 1 'does not fit' "$E2LF" codes render -m "$model" -o x --cell 200
py -c 'import numpy as np; c = np.zeros((2, 8, 8), np.float32); c[1] = 0.5; np.save("grey.npy", c)'
fails 1 'represent' "$E2LF" codes render --codes grey.npy -o x --bits 1
absent x
