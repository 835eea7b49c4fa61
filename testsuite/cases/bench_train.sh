# Training and synthesis against plain libtorch: every row is there, on as many threads as asked for.
[ -x "$E2LF-bench-train" ] || skip "e2lf was built without torch"
"$E2LF-bench" train --batch 1 --steps 1 --threads 1 >table.txt
grep -q "; 1 threads" table.txt || fail "threads: $(head -1 table.txt)"
"$E2LF-bench" train --batch 1 --steps 1 --json >rows.json
[ "$(json rows.json "[r['ratio'] for r in j['rows'] if r['name'] == \"torch's sampling\"]")" = "[1.0]" ] || fail "synthesis by torch"
[ "$(json rows.json "sorted({r['job'] for r in j['rows']})")" = "['synthesis', 'training']" ] || fail "jobs"
[ "$(json rows.json "all(r['samples_per_s'] > 0 for r in j['rows'])")" = True ] || fail "speeds"
# The trainer keeps to the instruction sets that it may use, as e2lf does.
fails 1 "E2LF_MAX_ISA" env E2LF_MAX_ISA=avx9000 "$E2LF-bench-train" 1 1
env E2LF_MAX_ISA=scalar "$E2LF-bench-train" 1 1 >scalar.json
[ "$(json scalar.json "all(r['samples_per_s'] > 0 for r in j['rows'])")" = True ] || fail "with scalar kernels"
