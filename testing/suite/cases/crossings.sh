# Every verb that reads events, with each option that touches the same thing: exit codes, files and the codes of findings.
skip_sanitizers "it runs many programs"
models=$SOURCES/models
"$E2LF" demo -o demo --width 64 --height 64 --quiet
# A rig with physical pixels; the same recording inverted (by the option), damaged, too short, and in the dark.
rig=(-m "$models/e2lf-n4.safetensors" --camera evk4-lcos --quiet)
"$E2LF" simulate demo/scene "${rig[@]}" --cycles 5 -o right.raw
"$E2LF" simulate demo/scene "${rig[@]}" --cycles 5 --scene-gain 0.001 -o dark.raw
"$E2LF" codes show -m "$models/e2lf-n4.safetensors" -o codes.json --quiet >codes.txt
cp "$SOURCES/cameras/evk4-lcos.json" camera.json
cp "$models/e2lf-n4-camera.safetensors" "$models/e2lf-n4-depth.safetensors" .
"$E2LF" accumulate right.raw -o right.npz --quiet
py - "$E2LF" <<'PY'
import hashlib, itertools, json, pathlib, shutil, subprocess, sys

def damage(data):  # three bytes are missing in the last cycle but one
    at = len(data) * 5 // 8
    return data[:at] + data[at + 3 :]

right = pathlib.Path("right.raw").read_bytes()
pathlib.Path("damaged.raw").write_bytes(damage(right))
pathlib.Path("short.raw").write_bytes(right[: len(right) // 12])
inputs = [p for p in pathlib.Path(".").iterdir() if p.is_file() and p.suffix in (".raw", ".npz", ".json", ".safetensors")]
before = {p: hashlib.sha256(p.read_bytes()).digest() for p in inputs}
failures, runs = [], 0

# A verb: its arguments, where its result lies, its record, and the modes that it has beside the plain one.
NETWORK, DEPTH = "e2lf-n4-camera.safetensors", "e2lf-n4-depth.safetensors"
AVERAGED, FUSED, TURNED = "averaged", "fused", "turned"
VERBS = {
    "reconstruct": (["-m", NETWORK, "--format", "npy"], "out", {AVERAGED: ["--cycles-per-field", "2"], FUSED: ["--fuse", "4"], TURNED: ["--turn-views"]}),
    "depth": (["-m", DEPTH], "out", {AVERAGED: ["--cycles-per-map", "2"], FUSED: ["--fuse", "4"], TURNED: ["--turn-views"]}),
    "accumulate": (["--codes", "codes.json"], "out.npz", {TURNED: ["--turn-views"]}),
    "calibrate": (["-m", NETWORK, "--even"], "out.json", {}),
    "live": (["-m", NETWORK, "--no-page", "--json", "--size", "full"], "out", {AVERAGED: ["--average", "4"], "unfused": ["--fuse", "1"], TURNED: ["--turn-views"]}),
}
# An input and the options that make it what it is: the exit code, findings of which one must be told, whether data are left out.
POLARITY = {"polarity-inverted", "half-cycle-off"}
DARK = {"events-absent", "events-few", "event-image-empty", "cycles-unconfirmed", "light-low", "contrast-absent", "events-unexplained"}
INPUTS = {
    "right": ("right.raw", [], 0, set(), False),
    "inverted": ("right.raw", ["--invert-polarity"], 0, POLARITY, False),
    "damaged": ("damaged.raw", [], 0, set(), True),
    "strict": ("damaged.raw", ["--strict"], 1, set(), False),
    "no cycle": ("short.raw", [], 1, set(), False),
    "dark": ("dark.raw", [], 0, DARK, False),
}

def run(arguments):
    global runs
    runs += 1
    return subprocess.run([sys.argv[1], *map(str, arguments)], capture_output=True, text=True, timeout=600)

def expect(is_so, what, done):
    if not is_so: failures.append(f"{what}: exit code {done.returncode}: {done.stderr[-600:]}")

def codes_in(value):  # of all findings anywhere in a record
    if isinstance(value, list): return set().union(*map(codes_in, value))
    if not isinstance(value, dict): return set()
    own = {value["code"]} if "code" in value and "remedy" in value else set()
    return own.union(*map(codes_in, value.values()))

def remove(place):
    for path in (pathlib.Path(place), pathlib.Path(place + ".run.json")):
        if path.is_dir(): shutil.rmtree(path)
        elif path.exists(): path.unlink()

for (verb, (given, place, modes)), (name, (input, options, code, told, loses)) in itertools.product(VERBS.items(), INPUTS.items()):
    for mode, more in {"plain": [], **modes}.items():
        what = f"{verb} {name} {mode}"
        if verb == "live" and "--strict" in options: continue  # it keeps what it shows
        if verb == "calibrate" and name in ("inverted", "dark"): continue
        done = run([verb, ("replay:" if verb == "live" else "") + input, *given, *options, *more, "-o", place])
        expect(done.returncode == code, f"{what}: not {code}", done)
        is_there = pathlib.Path(place).exists()
        expect(is_there == (done.returncode == 0), f"{what}: {'written' if is_there else 'not written'}", done)
        record = pathlib.Path(place) / "run.json" if "." not in place else pathlib.Path(place + ".run.json")
        notes = json.loads(record.read_text())["notes"] if record.exists() else {}
        if is_there and verb != "calibrate":
            found = codes_in(notes)
            expect(not told or found & told, f"{what}: found {sorted(found)}", done)
            if name == "right":
                expect(not found & (POLARITY | DARK), f"{what}: found {sorted(found)}", done)
            if verb != "live":
                if mode != AVERAGED or name == "right": expect(bool(notes["left_out"]) == (loses or (mode == AVERAGED and name == "right")), f"{what}: left out {notes['left_out']}", done)
        # The sums of two of five cycles; the views of a rig whose display is turned.
        if is_there and verb in ("reconstruct", "depth") and name == "right":
            results = notes["cycles" if verb == "reconstruct" else "maps"]
            expect(len(results) == (2 if mode == AVERAGED else 5), f"{what}: {len(results)} results", done)
            if verb == "depth":
                expect(results[0]["view"] == ([3, 3] if mode == TURNED else [4, 4]), f"{what}: view {results[0]['view']}", done)
            if mode == FUSED: expect(results[4]["fused_cycles"] > 2, f"{what}: {results[4]}", done)
        remove(place)

# No output replaces an input, whichever option names it.
REPLACED = [
    ("reconstruct", ["right.npz", "-m", NETWORK, "--codes", "codes.json", "--camera", "camera.json"], ["right.npz", NETWORK, "codes.json", "camera.json"]),
    ("depth", ["right.npz", "-m", DEPTH, "--codes", "codes.json", "--camera", "camera.json"], ["right.npz", DEPTH, "codes.json", "camera.json"]),
    ("depth", ["right.raw", "-m", DEPTH], ["right.raw"]),
    ("accumulate", ["right.raw", "--codes", "codes.json"], ["right.raw", "codes.json"]),
    ("calibrate", ["right.raw", "-m", NETWORK, "--codes", "codes.json"], ["right.raw", NETWORK, "codes.json"]),
    ("live", ["replay:right.raw", "-m", NETWORK, "--no-page", "--last"], [NETWORK, "right.raw"]),
    ("convert", ["right.raw"], ["right.raw"]),
]
for verb, given, named in REPLACED:
    for output in named:
        done = run([verb, *given, *([] if "--last" in given else ["-o"]), output, "--overwrite"])
        expect(done.returncode in (1, 2), f"{verb} replaces {output}", done)
after = {p: hashlib.sha256(p.read_bytes()).digest() for p in inputs}
changed = [str(p) for p in inputs if before[p] != after[p]]
if changed: failures.append(f"changed inputs: {changed}")
print(f"{runs} runs")
sys.exit("\n".join(failures) or None)
PY
[ -z "$(find . -name '*.part')" ] || fail "left behind: $(find . -name '*.part')"
