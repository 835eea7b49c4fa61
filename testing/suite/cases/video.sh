# A recording as frames: plain ones against a second implementation; those of a network by format, threads and record.
"$E2LF" demo -o demo --width 48 --height 40 --quiet
"$E2LF" simulate demo/scene -o rec.raw --cycles 2 --quiet
"$E2LF" convert rec.raw events.npz --quiet 2>/dev/null

# Windows by time begin at the first event or trigger, are half-open and hold every event once.
"$E2LF" video rec.raw -o plain --window-us 20000 --full-scale 4 --json --quiet >plain.json
exists plain/frame_000000.png plain/frames.csv plain/run.json
cat >plain.py <<'PY'
import csv, json, sys
import numpy as np
from read_png import read_png
events = np.load("events.npz")
rows = list(csv.DictReader(open("plain/frames.csv")))
report = json.load(open("plain.json"))
assert report["frames"] == len(rows) > 5 and report["events"] == len(events["t"]), report
assert all(int(b["begin_us"]) == int(a["end_us"]) == int(a["begin_us"]) + 20000 for a, b in zip(rows, rows[1:]))
for row in rows:
    inside = (events["t"] >= int(row["begin_us"])) & (events["t"] < int(row["end_us"]))
    assert inside.sum() == int(row["events"]), row
    sums = np.zeros((40, 48))
    np.add.at(sums, (events["y"][inside], events["x"][inside]), 2.0 * events["p"][inside] - 1)
    expected = np.floor(255 * np.clip(0.5 + 0.5 * sums / 4, 0, 1) + 0.5)
    assert np.array_equal(read_png(f"plain/frame_{int(row['frame']):06d}.png"), expected), row
PY
cat >read_png.py <<'PY'
import struct, zlib
import numpy as np
def read_png(path):
    """An 8-bit grey PNG without interlacing, decoded by the standard's rules."""
    data = open(path, "rb").read()
    place, packed = 8, b""
    while place < len(data):
        size, kind = struct.unpack(">I4s", data[place:place + 8])
        body = data[place + 8:place + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert (depth, colour) == (8, 0), (depth, colour)
        packed += body if kind == b"IDAT" else b""
        place += 12 + size
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, width + 1).astype(int)
    image = np.zeros((height + 1, width + 1), int)
    for y in range(height):
        for x in range(width):
            left, up, corner = image[y + 1, x], image[y, x + 1], image[y, x]
            paeth = min((left, up, corner), key=lambda v: abs(left + up - corner - v))
            base = (0, left, up, (left + up) // 2, paeth)[rows[y, 0]]
            image[y + 1, x + 1] = (rows[y, x + 1] + base) % 256
    return image[1:, 1:]
PY
py plain.py

# By count, and between triggers; a part of the recording.
"$E2LF" video rec.raw -o count --window-events 500 --quiet
py -c "
import csv
counts = [int(row['events']) for row in csv.DictReader(open('count/frames.csv'))]
assert all(count == 500 for count in counts[:-1]) and 0 < counts[-1] <= 500, counts"
"$E2LF" video rec.raw -o triggers --window-triggers --json --quiet >triggers.json
check "$(json triggers.json "j['frames'] == j['triggers'] - 1 and j['events'] + j['events_outside_of_windows'] == $(json plain.json "j['events']")")"
"$E2LF" video rec.raw -o part --window-us 10000 --from-us 120000 --to-us 140000 --quiet
[ "$(wc -l <part/frames.csv)" -eq 3 ] || fail "two frames and a heading: $(cat part/frames.csv)"
[ "$(sed -n 2p part/frames.csv | cut -d, -f2,3)" = "120000,130000" ] || fail "the part begins elsewhere: $(cat part/frames.csv)"

# A network: the same frames from any number of threads, from the record, and from another format.
make firenet checkpoint.safetensors
"$E2LF" model import --checkpoint checkpoint.safetensors -o net.safetensors --quiet
"$E2LF" model info net.safetensors >import.txt
grep -Eq "parameters +37777$" import.txt || fail "import: $(cat import.txt)"
"$E2LF" info net.safetensors --json >net.json
[ "$(json net.json "(j['kind'], j['measurement'], j['name'])")" = "('model of frames', 'voxel-grid', 'firenet+')" ] || fail "info"
"$E2LF" video rec.raw -m net.safetensors -o frames --tone robust --precision float32 --quiet
"$E2LF" convert rec.raw rec.hdf5 --quiet
"$E2LF" video rec.hdf5 -m net.safetensors -o again --tone robust --threads 1 --quiet
"$E2LF" video --config frames/run.json -o remade --quiet
for frame in frames/*.png; do
  cmp "$frame" "remade/$(basename "$frame")"
  cmp "$frame" "again/$(basename "$frame")"
done
[ "$(find frames -name '*.png' | wc -l)" -ge 3 ] || fail "frames"

# A network whose pixels see the whole image.
make etnet attention.safetensors channels=4
"$E2LF" model import --checkpoint attention.safetensors -o et-net.safetensors --quiet
"$E2LF" model info et-net.safetensors >import.txt
grep -Eq "receptive field px +-$" import.txt || fail "import: $(cat import.txt)"
"$E2LF" info et-net.safetensors --json >net.json
[ "$(json net.json "(j['name'], j['pad_multiple'], j['network']['receptive_field_px'])")" = "('et-net', 8, None)" ] || fail "info"
"$E2LF" video rec.raw -m et-net.safetensors -o attention --window-us 10000 --from-us 120000 --to-us 150000 --quiet
"$E2LF" video rec.raw -m et-net.safetensors -o attention-alone --window-us 10000 --from-us 120000 --to-us 150000 --threads 1 --quiet
for number in 0 1 2; do cmp "attention/frame_00000$number.png" "attention-alone/frame_00000$number.png"; done

# What does nothing, and what does not fit.
for option in "--edge both" "--channel 0" "--precision bfloat16" "--tone robust" "--full-scale 3 -m net.safetensors"; do
  # shellcheck disable=SC2086 # the option and its value
  fails 1 "${option%% *}" "$E2LF" video rec.raw -o x $option
done
fails 1 "e2lf video" "$E2LF" reconstruct rec.raw -m net.safetensors -o x
fails 1 "e2lf reconstruct" "$E2LF" video rec.raw -m "$SOURCES/models/e2lf-n4.safetensors" -o x
fails 2 "window-events" "$E2LF" video rec.raw -o x --window-us 5 --window-events 5
fails 2 "window-us" "$E2LF" video rec.raw -o x --window-us 9223372036854775000
fails 1 "demo/scene" "$E2LF" video demo/scene -o x
fails 1 "frame" "$E2LF" video rec.raw -o x --window-triggers --channel 7
fails 1 "rec.raw" "$E2LF" video rec.raw -o x --from-us 999999999
fails 1 "(--overwrite)" "$E2LF" video rec.raw -o plain
fails 1 "lost" "$E2LF" video rec.raw -o .
fails 2 "--window-us" "$E2LF" video rec.raw -o x --window-us 0
fails 1 "--checkpoint" "$E2LF" model import -o y.safetensors
fails 1 "other layers" "$E2LF" model import --checkpoint checkpoint.safetensors --as e2vid -o y.safetensors
absent x y.safetensors

# Ctrl-C leaves what is complete.
"$E2LF" simulate demo/scene -o long.raw --cycles 200 --quiet
"$E2LF" video long.raw -m net.safetensors -o stopped --window-us 200 --quiet 2>stderr.txt &
process=$!
until ls stopped.*.part/stopped/frame_000003.png >/dev/null 2>&1; do
  kill -0 "$process" 2>/dev/null || fail "ended before the signal: $(cat stderr.txt)"
  sleep 0.05
done
kill -INT "$process"
got=0
wait "$process" || got=$?
[ "$got" -eq 130 ] || fail "exit code $got: $(cat stderr.txt)"
exists stopped/frame_000003.png stopped/run.json
[ "$(($(wc -l <stopped/frames.csv) - 1))" -eq "$(find stopped -name '*.png' | wc -l)" ] || fail "the table is of other frames"

# The benchmark says how far libtorch's result is, where there is one. Speed itself is never tested.
"$E2LF-bench" video --width 40 --height 24 --frames 1 --json --quiet >bench.json
check "$(json bench.json "len(j['networks']) == 3 and all(n['peer'].get('largest_difference', 0) < 1e-4 and n['float32']['seconds']['median'] > 0 for n in j['networks'])")"
grep -q "firenet+" <<<"$("$E2LF-bench" video -m net.safetensors --width 40 --height 24 --frames 1 --quiet)" || fail "table"
