# Which patterns the camera showed is told by the recording, or said to be assumed; never taken for granted.
model=$SOURCES/models/e2lf-n4.safetensors
assumed=patterns-assumed
"$E2LF" demo -o demo --width 96 --height 64 --quiet

# Event images and recordings without patterns: the line, in the record too, and the check with the patterns of the model.
make events bare.npz height=64 width=96
"$E2LF" reconstruct bare.npz -m "$model" -o bare >out.txt 2>err.txt
grep -q "bare.npz: $assumed" err.txt || fail "$(cat err.txt)"
grep -q "differ from the given ones" out.txt || fail "no check: $(cat out.txt)"
[ "$(json bare/run.json "(j['notes']['patterns'], 'event_error' in j['notes']['cycles'][0])")" = "({'stated_by': 'nothing', 'are_the_models': False}, True)" ] || fail "the record"
"$E2LF" reconstruct bare.npz -m "$model" --method inversion -o bare_inverted >out.txt 2>err.txt
grep -q "$assumed" err.txt || fail "inversion: $(cat err.txt)"

# Simulated recordings tell, in every format: in their header, or in the record beside them.
other_codes other.npy
for format in raw hdf5 dat csv; do
  "$E2LF" simulate demo/scene -m "$model" --cycles 2 -o "own.$format" --quiet
  "$E2LF" reconstruct "own.$format" -m "$model" -o "own_$format" --format npy >out.txt 2>err.txt
  if grep -q "patterns" err.txt; then fail "$format: $(cat err.txt)"; fi
  grep -q "differ from the given ones" out.txt || fail "$format: $(cat out.txt)"
  "$E2LF" simulate demo/scene --codes other.npy --cycles 2 -o "other.$format" --quiet
  "$E2LF" reconstruct "other.$format" -m "$model" -o "other_$format" >out.txt 2>err.txt
  grep -q "patterns-foreign" err.txt || fail "$format: $(cat err.txt)"
done
head -c 2000 own.raw | grep -aq "^% e2lf_pattern_1 00000000/" || fail "the header of the RAW file"
# They go along: to another format with a header, through a pipe, into event images.
"$E2LF" convert other.raw converted.hdf5 --quiet
"$E2LF" accumulate converted.hdf5 -o images.npz --quiet
for input in converted.hdf5 replay:other.raw images.npz -; do
  "$E2LF" reconstruct "$input" -m "$model" -o along --overwrite <other.raw >out.txt 2>err.txt
  grep -q "patterns-foreign" err.txt || fail "$input: $(cat err.txt)"
done
# Formats that hold no text keep them in the record beside them, also where they were converted.
for format in npz; do
  for whose in own other; do
    file=from_$whose.$format
    "$E2LF" convert $whose.raw "$file" --format $format --quiet 2>err.txt
    "$E2LF" reconstruct "$file" -m "$model" --source bursts --sensor-width 96 --sensor-height 64 -o "$file.out" >out.txt 2>err.txt
    if [ $whose = own ]; then
      if grep -q "patterns" err.txt; then fail "$file: $(cat err.txt)"; fi
      grep -q "differ from the given ones" out.txt || fail "$file: $(cat out.txt)"
    else
      grep -q "patterns-foreign" err.txt || fail "$file: $(cat err.txt)"
    fi
  done
done
# The record of another recording tells nothing.
cp own.csv.run.json edited.csv.run.json
head -n -5 own.csv >edited.csv
"$E2LF" reconstruct edited.csv -m "$model" -o edited >out.txt 2>err.txt
grep -q "$assumed" err.txt || fail "a record of another file: $(cat err.txt)"
# --codes is believed, and a contradiction said.
"$E2LF" codes show -m "$model" -o own.json --quiet
"$E2LF" reconstruct bare.npz -m "$model" --codes own.json -o told >out.txt 2>err.txt
# These events are noise, which is said; that the patterns are assumed is not.
if grep -q "$assumed" err.txt; then fail "$(cat err.txt)"; fi
grep -q "events-unexplained\|better" err.txt || fail "$(cat err.txt)"
"$E2LF" reconstruct other.raw -m "$model" --codes own.json -o contradicted >out.txt 2>err.txt
grep -q "patterns-contradicted" err.txt || fail "$(cat err.txt)"
"$E2LF" accumulate other.raw --codes own.json -o contradicted.npz --quiet 2>/dev/null
"$E2LF" reconstruct contradicted.npz -m "$model" -o repeated >out.txt 2>err.txt
grep -q "patterns-contradicted" err.txt || fail "event images forget it: $(cat err.txt)"
# Event images of another schedule do not get patterns that are not theirs.
cat >two.json <<'JSON'
{"patterns": [{"name": "rest", "duration_us": 74144}, {"name": "a3", "duration_us": 10592, "image": 0}, {"name": "a4", "duration_us": 10000, "image": 1}]}
JSON
"$E2LF" accumulate own.raw -o two.npz --source schedule --origin-us 100000 --schedule two.json >out.txt 2>err.txt
grep -q "they are left out" err.txt || fail "$(cat err.txt)"
py -c 'import numpy as np; assert "codes" not in np.load("two.npz")'

# Without a model, patterns that no bundled network was trained for get the one for any patterns, which is nearer to the truth
# than the inversion, for the sensor of the paper and for physical pixels.
"$E2LF" demo -o larger --width 384 --height 320 --quiet
psnr_db() { "$E2LF" eval larger/scene "$1" --fit-gain --json >eval.json && json eval.json "j['psnr_db']"; }
# By so many dB at least:
for least in "0 --seed 1" "0.5 --seed 1 --camera evk4-lcos"; do
  "$E2LF" simulate larger/scene --codes other.npy ${least#* } -o any.npz --overwrite --quiet
  "$E2LF" reconstruct any.npz -o any --format npy --overwrite >out.txt 2>err.txt
  grep -q "patterns-adapted" err.txt || fail "$(cat err.txt)"
  "$E2LF" reconstruct any.npz --method inversion --codes other.npy -o inverted --format npy --overwrite --quiet 2>err.txt
  adapted=$(psnr_db any/lightfield.npy) inverted=$(psnr_db inverted/lightfield.npy)
  py -c "assert $adapted > $inverted + ${least%% *}, ($adapted, $inverted)"
done
# What it loses in faster arithmetic is measured with the default patterns, and is stated for all.
"$E2LF" model store e2lf-any --check demo/scene -o checked.safetensors --quiet
"$E2LF" model store checked.safetensors --codes other.npy -o adapted.safetensors --quiet
for file in checked adapted; do "$E2LF" model info $file.safetensors --json >$file.json; done
loss=$(json checked.json "j['precision_loss']")
[ "$loss" = "$(json adapted.json "j['precision_loss']")" ] || fail "the loss of the adapted network"
py -c "assert abs($loss['int16_db']) < 0.1"
# Patterns of fewer cells take the central views.
py -c 'import numpy as n; c = n.zeros((4, 5, 5)); c[1, :2, :2] = c[2, 3:, 1:3] = c[3, 1:3, 3:] = 1; n.save("five.npy", c.astype("f4"))'
"$E2LF" model store e2lf-any --codes five.npy --check demo/scene -o five.safetensors --quiet
# It becomes a model of these patterns alone with `model store`, and is refused without patterns.
"$E2LF" model store e2lf-any --codes other.npy -o mine.safetensors --quiet
"$E2LF" reconstruct any.npz -m mine.safetensors -o mine --format npy --quiet
"$E2LF" reconstruct bare.npz -m e2lf-any -o unknown >out.txt 2>err.txt && fail "unknown patterns were accepted"
grep -q -- "--codes" err.txt || fail "$(cat err.txt)"
