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
fails 2 "--seed" "$E2LF" train "$TESTSUITE/../configs/first-run.json" -o run --seed 7
fails 1 "contains neither" "$E2LF" info "$TESTSUITE"
fails 2 "E2LF_MAX_ISA" env E2LF_MAX_ISA=avx9000 "$E2LF" codes show
fails 1 "path" "$E2LF" info nowhere
