# Small streams through the decoding benchmark: the shapes are there, counts are exact, rates are numbers. Speed itself is never tested.
"$E2LF-bench" decode --events 20000 --seconds 0 --json --quiet >synthesised.json
[ "$(json synthesised.json "[s['shape'] for s in j['streams']]")" = "['evt3 dense', 'evt3 sparse', 'evt3 vector', 'evt2', 'evt2.1']" ] || fail "shapes"
json synthesised.json "all(20000 <= s['events'] < 20032 for s in j['streams'])" | grep -q True || fail "events"
json synthesised.json "[round(s['bytes_per_event'], 1) for s in j['streams']]" >bytes.txt
grep -q '^\[2\.[5-9], [7-9]\.[0-9], 0\.9, 4\.[0-4], 0\.[5-7]\]$' bytes.txt || fail "bytes per event: $(cat bytes.txt)"
for part in one_thread all_threads reference; do
  json synthesised.json "all(s['$part'][k] > 0 for s in j['streams'] for k in ('columns',))" | grep -q True || fail "no rates of $part"
done
check "$(json synthesised.json "j['streams'][0]['skipping']['ratio_to_one_thread'] > 0 and 'skipping' not in j['streams'][3]")"
json synthesised.json "len(j['published_on_another_machine'])" | grep -q '^6$' || fail "published figures"

# A recording is repeated to the wanted length, with its clock going on.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
"$E2LF" simulate demo/scene -o recording.raw --quiet
"$E2LF" info recording.raw --json >info.json
events=$(json info.json "j['events']")
"$E2LF-bench" decode recording.raw --events $((3 * events)) --seconds 0 --no-reference --json --quiet >repeated.json
[ "$(json repeated.json "(len(j['streams']), j['streams'][0]['events'], 'reference' in j['streams'][0])")" = "(1, $((3 * events)), False)" ] || fail "repeated"
grep -q 'recording.raw, 1 times' <<<"$("$E2LF-bench" decode recording.raw --events 1000 --seconds 0 --quiet)" || fail "the table"
mkdir converted
"$E2LF-bench" decode recording.raw --events 1000 --seconds 0 --no-reference --convert converted --json --quiet >converted.json
[ "$(json converted.json "sorted(k for k, v in j['convert'].items() if v > 0)")" = "['csv', 'hdf5']" ] || fail "convert"
[ -z "$(ls -A converted)" ] || fail "something was left behind"
"$E2LF" convert recording.raw recording.npz --quiet
fails 1 "RAW recording" "$E2LF-bench" decode recording.npz
mkdir empty
fails 1 "RAW recording" "$E2LF-bench" decode empty
fails 1 "path" "$E2LF-bench" decode nowhere
