# Help, mistakes and options.

part usage
# Help goes to stdout with exit code 0 and has an example; mistakes go to stderr with exit code 2.
grep -q reconstruct <<<"$("$E2LF" --help)"
grep -q '^e2lf [0-9]' <<<"$("$E2LF" version)"
fails 2 'reconstruct' "$E2LF" reconstuct
for verb in demo info convert accumulate simulate reconstruct eval view "codes show" "model info" "model import"; do
  # shellcheck disable=SC2086
  "$E2LF" $verb --help >help.txt
  grep -q '^Example:' help.txt || fail "no example in the help of $verb"
done
for verb in camera decode reconstruct rig simulate train video; do
  grep -q '^Example:' <<<"$("$E2LF-bench" $verb --help)" || fail "no example in the help of e2lf-bench $verb"
done
fails 2 'e2lf-bench: there is no verb "decod"; did you mean "decode"' "$E2LF-bench" decod
fails 2 "see e2lf eval --help" "$E2LF" eval
fails 2 'bundled models' "$E2LF" view
fails 2 "e2lf: reconstruct: --output is missing: folder to write; for example" "$E2LF" reconstruct events.npz
fails 2 "did you mean" "$E2LF" model imprt
fails 2 "--passes" "$E2LF" reconstruct events.npz -m e2lf-n4 -o out --pases 4
fails 2 "--seed" "$E2LF" train "$SOURCES/configs/first-run.json" -o run --seed 7
fails 1 "contains neither" "$E2LF" info "$TESTSUITE"
fails 2 "E2LF_MAX_ISA" env E2LF_MAX_ISA=avx9000 "$E2LF" codes show
fails 1 "nowhere" "$E2LF" info nowhere

part groups
# --help shows the usual options, --help=GROUP a group of the others, and --help-all everything.
for verb in depth live reconstruct; do
  "$E2LF" "$verb" --help >usual.txt
  "$E2LF" "$verb" --help-all >all.txt
  "$E2LF" "$verb" --help=cameras >cameras.txt
  check "$(grep -cE '^  (-.,)?--' usual.txt) <= 30"
  check "$(grep -cE '^  (-.,)?--' all.txt) >= 55"
  check "$(grep -cE '^  --' cameras.txt) == 6"
  for file in all.txt cameras.txt; do grep -q -- --biases "$file" || fail "$verb: no --biases in $file"; done
  grep -q -- --biases usual.txt && fail "$verb: --biases among the usual options"
  grep -q -- --help=cycles usual.txt || fail "$verb: the group of cycles is not named"
done
fails 2 'known are run, ' "$E2LF" depth --help=lenses

part options
# No option is taken for what it does not say, and a run can be made again from its record.
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" demo -o demo --width 48 --height 32 --quiet
simulate=("$E2LF" simulate demo/scene -m "$model" -o events.npz)
fails 2 "--cycles: 0 is out of range; give at least 1" "${simulate[@]}" --cycles 0
fails 2 "--seed: \"-1\" is not a whole number" "${simulate[@]}" --seed -1
fails 2 "--seed: \"99999999999999999999\" is not a whole number" "${simulate[@]}" --seed 99999999999999999999
fails 2 "--threads: 10000 is out of range; give 0 to 1024" "${simulate[@]}" --threads 10000
fails 2 "--tau: \"nan\" is not a number" "${simulate[@]}" --tau nan
fails 2 "--white: 0 is not above 0" "${simulate[@]}" --white 0
fails 2 "--step: 0 is out of range; give 1 to 65535" "${simulate[@]}" --step 0
fails 2 "--duration-us: 0 is out of range; give at least 1" "$E2LF" codes render -o frames --duration-us 0
absent events.npz frames
"${simulate[@]}" --seed 007 --quiet
"$E2LF" simulate demo/scene -m "$model" --seed 7 -o seven.npz --quiet
cmp events.npz seven.npz
"$E2LF" simulate demo/scene -m "$model" -o recording.raw --cycles 2 --quiet
accumulate=("$E2LF" accumulate recording.raw -o images.npz)
fails 2 "--max-cycles: \"-1\" is not a whole number" "${accumulate[@]}" --max-cycles -1
fails 2 "--origin-us: \"99999999999999999999\" is not a whole number" "${accumulate[@]}" --origin-us 99999999999999999999
fails 2 ".jpg" "${accumulate[@]}" --report cycles.jpg
fails 2 "none.json" "${accumulate[@]}" --schedule none.json
absent images.npz cycles.png
absent rate.png rate.svg
reconstruct=("$E2LF" reconstruct events.npz -m "$model" -o out)
fails 2 "none.json" "${reconstruct[@]}" --schedule none.json
fails 1 "--black" "${reconstruct[@]}" --black 1
echo '{"patterns": [{"duration_us": 500, "image": 0}]}' >schedule.json
# What does nothing for this kind of input is refused.
for option in "--schedule schedule.json" "--source bursts" "--to-us 5" "--channel 3" --filter-pixels "--sensor-width 5" "--transitions lit" "--transitions all"; do
  # shellcheck disable=SC2086 # the option and its value
  fails 1 "event images" "${reconstruct[@]}" $option
done
for option in "--device cuda" "--fuse 4" "--cycles-per-map 3" "--source bursts" "--max-cycles 2" --filter-pixels; do
  # shellcheck disable=SC2086 # the option and its value
  fails 1 "light fields" "$E2LF" depth demo/scene -o no $option
done
fails 1 "--white" "$E2LF" info recording.raw --white 5
fails 1 "--colour" "$E2LF" convert recording.raw rec.csv --colour
fails 1 "light field" "$E2LF" info demo/scene --from-us 5
fails 1 "light field" "$E2LF" convert demo/scene deep --format png16 --shift-time
fails 1 "--no-triggers" "$E2LF" simulate demo/scene -m "$model" -o no.npz --no-triggers
fails 1 "--v2e-preset" "$E2LF" simulate demo/scene -m "$model" -o no.npz --v2e-preset noisy
fails 1 "--width" "$E2LF" simulate demo/scene -m "$model" -o no.raw --stream --width 50
absent rec.csv hci no.npz no.raw
fails 1 "method inversion" "${reconstruct[@]}" --method inversion --passes 2
fails 2 "--passes: 65 is out of range; give 1 to 64" "${reconstruct[@]}" --passes 65
absent out
make release weights
"$E2LF" model import --release weights -o paper.safetensors --quiet
"$E2LF" reconstruct events.npz -m paper.safetensors -o one_pass --passes 2 >out.txt 2>err.txt
grep -q "distinguishes 1 position" err.txt || fail "passes without effect: $(cat err.txt)"
fails 2 'reconstruct' "$E2LF" recon

# The record holds what the model and "auto" stood for, and makes the run again, on other outputs too.
[ "$(json events.npz.run.json "tuple(j['options'][k] for k in ('event-model', 'eps', 'tau', 'sigma-w', 'sigma-z'))")" = \
  "('reference-aware', 0.01, 0.3, 0.175, 0.04)" ] || fail "constants in the record"
"$E2LF" simulate --config events.npz.run.json -o again.npz --quiet
cmp events.npz again.npz
fails 1 "(--overwrite)" "$E2LF" simulate --config events.npz.run.json
"${reconstruct[@]}" --format npy --quiet
"$E2LF" reconstruct --config out/run.json -o repeated --quiet
cmp out/lightfield.npy repeated/lightfield.npy
check "$(json out/run.json "j['options']['gain']") == $(json out/run.json "j['notes']['cycles'][0]['gain']")"
[ "$(json out/run.json "j['options']['precision'] in ('float32', 'bfloat16')")" = True ] || fail "precision in the record"
[ "$(json out/run.json "j['notes']['constants']['tau']")" = 0.3 ] || fail "constants of the reconstruction"
"${accumulate[@]}" --quiet
[ "$(json images.npz.run.json "j['options']['source']")" = triggers ] || fail "source in the record"
"$E2LF" accumulate --config images.npz.run.json -o repeated.npz --quiet
cmp images.npz repeated.npz
"$E2LF" demo --config demo/run.json -o repeated_demo --quiet
cmp demo/events.npz repeated_demo/events.npz
# What is typed replaces what was typed then, and what the earlier run determined by itself.
"$E2LF" simulate demo/scene -m "$model" --camera ideal -o ideal.npz --quiet
"$E2LF" simulate demo/scene -m "$model" -o determined.npz --quiet
"$E2LF" simulate --config determined.npz --camera ideal -o typed.npz --quiet
cmp ideal.npz typed.npz || fail "constants of another camera"
"$E2LF" demo -o other --width 64 --height 48 --quiet
"$E2LF" simulate --config determined.npz other/scene -o typed.npz --overwrite --quiet
"$E2LF" simulate other/scene -m "$model" -o other.npz --quiet
cmp other.npz typed.npz || fail "a positional input"
# A record of another verb is refused; an input that has changed is said.
fails 2 "record" "$E2LF" reconstruct --config events.npz.run.json
"$E2LF" simulate demo/scene -m "$model" --seed 8 -o events.npz --overwrite --quiet
"$E2LF" reconstruct --config out/run.json -o changed >out.txt 2>err.txt
grep -q "events.npz has changed since the earlier run" err.txt || fail "$(cat err.txt)"
absent port

part settings
# Messages of the library name settings, which the command line and Python translate; only the programs name options.
grep -rnE '"([^"]*[ (])?--[a-z]' "$SOURCES/src/e2lf" --include='*.cpp' --include='*.h' --exclude='*_test.cpp' --exclude='*_main.cpp' \
  --exclude-dir={cli,program,info} | grep -vE '`[^`]*--[a-z]|page\.cpp:' >options.txt || true
[ ! -s options.txt ] || fail "the library names options of the command line: $(cat options.txt)"
