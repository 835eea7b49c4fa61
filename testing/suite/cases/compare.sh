# A comparison keeps each result: a second run computes nothing, a killed one goes on, shards make the tables of one run.
cat >c.json <<'JSON'
// two small scenes, the closed form with two patterns
{
  "name": "a <comparison> & more",
  "methods": [
    {"name": "inversion", "algorithm": "inversion"},
    {"name": "50%_of_it {x}", "algorithm": "inversion", "gain": 0.5}
  ],
  "scenes": [
    {"name": "A & B", "scenes": ["demo:1", "demo:2"], "width": 48, "height": 32},
    {"name": "wide", "scenes": ["demo:1"], "width": 64, "height": 32}
  ],
  "sensors": [{"name": "paper"}, {"name": "dim", "gain": 0.25, "tau": 0.25, "cycles": 2}],
  "seeds": [1, 2]
}
JSON
new() { json "$1/run.json" "j['notes']['new_results']"; }
"$E2LF" compare c.json -o one >text.txt
exists one/index.html one/table.csv one/table.json one/table.tex one/run.json
[ "$(new one)" -eq 24 ] || fail "not 24 results"
[ "$(find one/results -name '*.json' | wc -l)" -eq 24 ] || fail "not a file for each result"
grep -q "^inversion  *4  *[0-9.]*/[0-9.]*" text.txt || fail "no table: $(cat text.txt)"
[ "$(wc -l <one/table.csv)" -eq 25 ] || fail "table.csv"
"$E2LF" compare c.json -o one --json >one.json
[ "$(new one)" -eq 0 ] || fail "a second run computed"
check "$(json one.json "j['missing_results'] == 0 and j['new_results'] == 0 and len(j['results']) == 24")"

# Half the brightness is worse, and costs the same.
py - one/table.csv <<'PY'
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert len(rows) == 24 and rows[0]["sensor"] == "paper" and rows[0]["N"] == "4", rows[0]
whole = {(r["sensor"], r["group"], r["scene"], r["seed"]): r for r in rows if r["method"] == "inversion"}
for row in rows:
    if row["method"] != "inversion":
        other = whole[row["sensor"], row["group"], row["scene"], row["seed"]]
        assert row["events_per_pixel"] == other["events_per_pixel"] and float(row["psnr_db"]) < float(other["psnr_db"]), row
PY

# The figures are those of the verbs that it stands for.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
other_codes other.npy
echo '{"methods": [{"name": "r", "algorithm": "inversion", "codes": "other.npy"}], "scenes": [{"name": "g", "scenes": ["demo/scene"]}], "seeds": [5]}' >r.json
"$E2LF" compare r.json -o r --json --quiet >r.out
"$E2LF" simulate demo/scene --codes other.npy --camera paper --seed 5 -o events.npz --quiet
"$E2LF" reconstruct events.npz --method inversion --gain 1 --format npy -o recon --quiet
"$E2LF" eval demo/scene recon --events events.npz --json >eval.json
py - <<'PY'
import json
row, other = json.load(open("r.out"))["results"][0], json.load(open("eval.json"))
# float32 constants in the file of the events
assert abs(row["psnr_db"] - other["psnr_db"]) < 1e-4 and abs(row["ssim"] - other["ssim_uniform7"]) < 1e-5, (row, other)
assert row["events_per_pixel"] == other["events"]["total_events_per_pixel"]
PY
fails 1 "method" "$E2LF" reconstruct events.npz --method inversion --passes 2 -o no
# A network for other patterns is named once.
echo '{"methods": [{"name": "n", "model": "e2lf-n4", "codes": "other.npy"}], "scenes": [{"name": "g", "scenes": ["demo/scene"]}], "seeds": [5, 6]}' >n.json
"$E2LF" compare n.json -o n --quiet 2>err.txt
[ "$(grep -c patterns-foreign err.txt)" -eq 1 ] || fail "$(cat err.txt)"

# LaTeX: what is opened is closed, every row has as many cells, names are escaped.
py - <<'PY'
import re
text = open("one/table.tex").read()
assert text.count("\\begin{table}") == text.count("\\end{table}") == text.count("\\end{tabular}") == 2
bare = re.sub(r"\\[{}]", "", text)
depth = 0
for c in bare:
    depth += (c == "{") - (c == "}")
    assert depth >= 0
assert depth == 0
for body in re.findall(r"\\toprule\n(.*?)\\bottomrule", text, re.S):
    counts = {len(re.findall(r"(?<!\\)&", line)) for line in body.splitlines() if line.endswith("\\\\")}
    assert counts == {4}, counts
assert "50\\%\\_of\\_it \\{x\\}" in text and "A \\& B" in text
assert not re.search(r"(?<!\\)[%_#]", text.replace("% needs", "")), "a special character is bare"
PY
# The page: nothing outside of it, and names that are no markup.
grep -qF 'a &lt;comparison&gt; &amp; more' one/index.html || fail "the title"
! grep -qE '(href|src)="?(https?:)?//|<link|<script|@import|url\(' one/index.html || fail "the page has a link"
[ "$(grep -o 'src="data:image/png;base64,' one/index.html | wc -l)" -eq 18 ] || fail "pictures"

# Shards share the work; merged, they make the same table.
"$E2LF" compare c.json -o first --shard 1/2 --quiet
"$E2LF" compare c.json -o second --shard 2/2 --quiet
[ "$(new first)" -eq 12 ] && [ "$(new second)" -eq 12 ] || fail "shards"
"$E2LF" compare c.json -o merged --merge first --merge second --quiet
[ "$(new merged)" -eq 0 ] || fail "merging computed"
cmp one/table.csv merged/table.csv
cmp one/table.tex merged/table.tex

# A killed run goes on where it was, and one that is interrupted says how.
sed -i 's/"seeds": \[1, 2\]/"seeds": [1, 2, 3, 4]/' c.json
"$E2LF" compare c.json -o killed --quiet &
process=$!
has_results() { [ "$(find killed/results -name '*.json' 2>/dev/null | wc -l)" -ge "$1" ]; }
wait_for_results() {
  until has_results "$1"; do
    kill -0 "$process" || fail "it ended before $1 results"
    sleep 0.02
  done
}
wait_for_results 2
kill -KILL "$process"
wait "$process" 2>/dev/null || true
found=$(find killed/results -name '*.json' | wc -l)
[ "$found" -lt 48 ] || fail "all was done before the kill"
"$E2LF" compare c.json -o killed >stdout.txt 2>stderr.txt &
process=$!
wait_for_results $((found + 2))
kill -INT "$process"
code=0
wait "$process" || code=$?
[ "$code" -eq 130 ] || fail "exit code $code instead of 130"
grep -q "are missing; repeat the command to continue" stderr.txt || fail "nothing said how to go on: $(cat stderr.txt)"
before=$(find killed/results -name '*.json' | wc -l)
"$E2LF" compare c.json -o killed --quiet
[ "$(new killed)" -eq "$((48 - before))" ] || fail "it did not go on"
"$E2LF" compare c.json -o whole --quiet
cmp killed/table.csv whole/table.csv

# A method more is computed alone; seeds by --set; another configuration may use the folder.
sed 's/"methods": \[/"methods": [{"name": "fitted", "algorithm": "inversion", "fit_gain": true},/' c.json >more.json
"$E2LF" compare more.json -o one --set seeds=[1,2] --quiet
[ "$(new one)" -eq 12 ] || fail "not the new method alone"
"$E2LF" compare more.json -o one --set seeds=[1,2] --again --set pictures=false --quiet
[ "$(new one)" -eq 36 ] || fail "--again"

# A program of the user receives all cycles with their patterns, and is measured like other methods. This one subtracts 0.03.
cat >mine.py <<'PY'
import sys
import numpy as np
truth, events, output = sys.argv[1:]
given = np.load(events)
assert given["events"].shape == (2, 3, 32, 48) and given["events"].any() and given["codes"].shape == (4, 8, 8), given["events"].shape
print("this is no JSON")
np.save(output, np.load(truth) - np.float32(0.03))
PY
"$E2LF" convert demo/scene truth.npy --quiet
external() {
  cat >external.json <<JSON
{"methods": [{"name": "mine", "algorithm": "external", "command": $1}],
 "scenes": [{"name": "g", "scenes": ["demo/scene"]}], "sensors": [{"name": "two", "cycles": 2}], "metrics": ["psnr_db"]}
JSON
}
external '["/usr/bin/python3", "mine.py", "truth.npy"]'
"$E2LF" compare external.json -o external --json --quiet >external.out
check "$(json external.out "abs(j['results'][0]['psnr_db'] - 30.4576) < 1e-3")"
"$E2LF" compare external.json -o external --quiet
[ "$(new external)" -eq 0 ] || fail "nothing had changed"
echo "# another program" >>mine.py
"$E2LF" compare external.json -o external --quiet
[ "$(new external)" -eq 1 ] || fail "the program had changed"
external_fails() {
  external "$2"
  fails 1 "$1" "$E2LF" compare external.json -o wrong
}
external_fails "no-such-program: the program cannot be started" '["no-such-program"]'
external_fails "mine on scene, sensor two: false: the program ended with exit code 1" '["false"]'
external_fails "wrote no light field" '["true"]'
external_fails "signal 9" '["sh", "-c", "kill -9 $$"]'
external '["sh", "-c", "exec sleep 100d"]'
"$E2LF" compare external.json -o wrong --quiet 2>stderr.txt &
process=$!
until pgrep -P "$process" sleep >/dev/null; do
  kill -0 "$process" || fail "it ended: $(cat stderr.txt)"
  sleep 0.02
done
kill -INT "$process"
code=0
wait "$process" || code=$?
[ "$code" -eq 130 ] || fail "exit code $code instead of 130"

# Mistakes.
bad() { fails 1 "$1" "$E2LF" compare bad.json -o out; absent out; }
sed 's/"algorithm"/"algoritm"/' c.json >bad.json
bad 'did you mean "algorithm"?'
echo '{"methods": []}' >bad.json
bad 'the list is empty'
echo '{"methods": [{"name": "a", "algorithm": "inversion"}], "scenes": [{"name": "g", "scenes": ["no/such/scene"]}]}' >bad.json
bad 'no/such/scene: there is no such file or folder beside the configuration'
echo '{"methods": [{"name": "a", "model": "none.safetensors", "optional": true}], "scenes": [{"name": "g", "scenes": ["demo"]}]}' >bad.json
bad 'nothing is left to compare'
grep -q "the method a is left out" stderr.txt || fail "the method left out was not named"
echo '{"methods": [' >bad.json
bad 'not valid JSON'
fails 1 "give e.g. 1/4" "$E2LF" compare c.json -o out --shard 3/2

# What e2lf compare did not write stays.
mkdir foreign && echo mine >foreign/table.csv
fails 1 "this folder was not written by e2lf compare" "$E2LF" compare c.json -o foreign
fails 1 "this folder was not written by e2lf compare" "$E2LF" compare c.json -o demo
fails 1 "no results" "$E2LF" compare c.json -o out2 --merge foreign
fails 1 "no results" "$E2LF" compare c.json -o out2 --merge demo
[ "$(cat foreign/table.csv)" = mine ] || fail "a file of someone else was replaced"
echo mine >one/notes.txt
"$E2LF" compare more.json -o one --set seeds=[1,2] --quiet
[ "$(cat one/notes.txt)" = mine ] || fail "a file of someone else is gone"
fails 1 "lost" "$E2LF" compare c.json -o .
# Nor is a configuration replaced that has the name of a table.
cp c.json one/table.json
fails 1 "lost" "$E2LF" compare one/table.json -o one
cmp c.json one/table.json
