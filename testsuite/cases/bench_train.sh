# Training and synthesis against plain libtorch: every row is there, on as many threads as asked for.
[ -x "$(dirname "$E2LF")/e2lf-train" ] || skip "e2lf was built without torch"
"$E2LF" bench train --batch 1 --steps 1 --threads 1 >table.txt
grep -q "; 1 threads" table.txt || fail "threads: $(head -1 table.txt)"
"$E2LF" bench train --batch 1 --steps 1 --json >rows.json
[ "$(json rows.json "[r['ratio'] for r in j if r['name'] == \"torch's sampling\"]")" = "[1.0]" ] || fail "synthesis by torch"
[ "$(json rows.json "sorted({r['job'] for r in j})")" = "['synthesis', 'training']" ] || fail "jobs"
[ "$(json rows.json "all(r['samples_per_s'] > 0 for r in j)")" = True ] || fail "speeds"
# The trainer keeps to the instruction sets that it may use, as e2lf does.
fails 1 "E2LF_MAX_ISA" env E2LF_MAX_ISA=avx9000 "$(dirname "$E2LF")/e2lf-train" bench --batch 1 --steps 1
env E2LF_MAX_ISA=scalar "$(dirname "$E2LF")/e2lf-train" bench --batch 1 --steps 1 --json >scalar.json
[ "$(json scalar.json "all(r['samples_per_s'] > 0 for r in j)")" = True ] || fail "with scalar kernels"
