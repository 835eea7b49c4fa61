# Patterns on a display, in an X server without a screen: each frame is grabbed from it and compared pixel for pixel.
"$E2LF" --version | grep "^display: ON" >/dev/null || {
  fails 1 "libsdl2-dev" "$E2LF" codes play -o x
  skip "this build has no display"
}
command -v Xvfb >/dev/null && command -v import >/dev/null || skip "no Xvfb or ImageMagick"
fails 1 "display" env -u DISPLAY SDL_VIDEODRIVER=x11 "$E2LF" codes play -o x
absent x
Xvfb -displayfd 3 -screen 0 640x512x24 -screen 1 320x256x24 -nolisten tcp 3>number 2>xvfb.txt &
server=$!
trap 'kill "$server" 2>/dev/null || true; remove_folder' EXIT
wait_for number "$server"
DISPLAY=:$(cat number)
export DISPLAY SDL_VIDEODRIVER=x11 LIBGL_ALWAYS_SOFTWARE=1
fails 1 "there is no display 7" "$E2LF" codes play -o x --display 7
fails 1 "does not fit" "$E2LF" codes play -o x --cell 200

"$E2LF" codes render -o rendered --width 640 --height 512 --cell 40 --no-inverses --duration-us 1500000 --quiet
"$E2LF" codes play -o shown --cell 40 --no-inverses --duration-us 1500000 --blink 16 --cycles 2 --json >shown.json 2>log.txt &
player=$!
# Grabs until the player ends; each grab is one of the frames, or black before and after.
mkdir grabs
number=0
while kill -0 $player 2>/dev/null; do
  import -silent -window root -depth 8 "grabs/$(printf %03d $number).gray" 2>>import.txt || true
  number=$((number + 1))
  sleep 0.2
done
wait $player || fail "$(cat log.txt)"
for frame in rendered/frame_*.png; do convert "$frame" -depth 8 "gray:$frame.gray"; done
py - <<'PY'
import glob, json
import numpy as np
frames = [np.fromfile(f, np.uint8).reshape(512, 640) for f in sorted(glob.glob("rendered/frame_*.gray"))]
seen, corners = [], {}
for name in sorted(glob.glob("grabs/*.gray")):
    grab = np.fromfile(name, np.uint8)
    if grab.size != 640 * 512: continue
    grab = grab.reshape(512, 640).copy()
    corner = grab[-16:, -16:].copy()
    grab[-16:, -16:] = 0
    found = [i for i, frame in enumerate(frames) if (grab == frame).all()]
    assert found or not grab.any(), f"{name} is none of the frames"
    if not found or corner.min() != corner.max(): continue
    if not seen or seen[-1] != found[0]: seen.append(found[0])
    corners.setdefault(found[0], set()).add(int(corner[0, 0]))
order = "".join(map(str, seen))
assert "0123" in order or "1230" in order or "2301" in order, f"order {order}"
assert sorted(corners) == [0, 1, 2, 3] and any(c == {0, 255} for c in corners.values()), corners
told = json.load(open("shown.json"))
assert told["cycles"] == 2 and told["refreshes"] == [round(1.5e6 / told["refresh_us"])] * 4, told
import csv
flips = list(csv.DictReader(open("shown/flips.csv")))
assert [int(flip["index"]) for flip in flips] == [0, 1, 2, 3] * 2, flips
assert sum(int(flip["missed_refreshes"]) for flip in flips) == told["missed_refreshes"]
schedule = json.load(open("shown/schedule.json"))["patterns"]
for index, pattern in enumerate(schedule):
    right = [int(f["duration_us"]) for f in flips if int(f["index"]) == index and f["missed_refreshes"] == "0"]
    assert not right or abs(pattern["duration_us"] - sum(right) / len(right)) <= 1, (pattern, right)
    assert "overhead_us" not in pattern or pattern["overhead_us"] == 0
PY
# Waits until the player shows a pattern, which takes seconds on a busy machine.
wait_for_pattern() {
  until import -silent -window root -depth 8 now.gray && [ -n "$(tr -d '\0' <now.gray | head -c 1)" ]; do
    kill -0 $player 2>/dev/null || fail "the player ended: $(cat log.txt)"
    sleep 0.1
  done
}
# A display that stands still for a while: what was missed is counted.
"$E2LF" codes play -o late --cell 40 --no-inverses --period-us 200000 --cycles 10 --json >late.json 2>log.txt &
player=$!
wait_for_pattern
kill -STOP $player
sleep 1
kill -CONT $player
wait $player || fail "$(cat log.txt)"
grep -q "because the display refreshes" log.txt && fail "200000 us are a multiple: $(cat log.txt)"
check "$(json late.json 'j["missed_refreshes"]') > 20"
grep -q "refreshes were missed" log.txt || fail "not told: $(cat log.txt)"
# Ctrl-C ends after a whole cycle, and what was shown is kept.
"$E2LF" codes play -o ended --cell 40 --period-us 50000 --quiet 2>log.txt &
player=$!
wait_for_pattern
kill -INT $player
code=0
wait $player || code=$?
[ $code -eq 130 ] || fail "exit code $code: $(cat log.txt)"
exists ended/flips.csv ended/schedule.json
import -silent -window root -depth 8 after.gray
py -c 'assert not any(open("after.gray", "rb").read())' || fail "the screen is not restored"
# A period that is no multiple of the refresh is said. SDL cannot use the second of several screens of an X server.
"$E2LF" codes play -o second --cell 20 --no-inverses --period-us 10000 --cycles 2 --quiet 2>log.txt || fail "$(cat log.txt)"
grep -q "a pattern of 10000 us is shown for 16667 us, because the display refreshes every 16667 us" log.txt || fail "$(cat log.txt)"
check "$(json second/run.json 'j["notes"]["shown"]["refreshes"]') == [1, 1, 1, 1]"
fails 1 "window" "$E2LF" codes play -o third --display 1 --cell 20 --cycles 1
absent third
fails 1 "exist" "$E2LF" codes play -o second --cycles 1
touch mine
fails 1 "mine" "$E2LF" codes play -o mine --cycles 1 --overwrite
[ -z "$(find . -name '*.part')" ] || fail "left behind: $(find . -name '*.part')"
