# Memory does not grow with the length of a recording or the number of cycles.
skip_sanitizers "sanitizers keep freed memory"
peak_mib() { # <command...>: of the process, as the system counts it
  py -c 'import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss >> 10)' "$@"
}
"$E2LF" demo -o demo --width 256 --height 192 --quiet
# The hash of a recording of 1 GiB, most of it a hole.
"$E2LF" simulate demo/scene -o rec.raw --cycles 2 --quiet
small=$(peak_mib "$E2LF" accumulate rec.raw -o small.npz --max-cycles 1 --quiet)
truncate -s 1G rec.raw
large=$(peak_mib "$E2LF" accumulate rec.raw -o large.npz --max-cycles 1 --quiet)
cmp small.npz large.npz
check "$(json large.npz.run.json "j['inputs'][0]['sha256']  == '$(sha256sum <rec.raw | cut -d' ' -f1)'")"
check "$large < $small + 300"
# 400 cycles of 0.28 MiB each.
few=$(peak_mib "$E2LF" simulate demo/scene -o few.npz --cycles 2 --quiet)
many=$(peak_mib "$E2LF" simulate demo/scene -o many.npz --cycles 400 --quiet)
check "$(py -c 'import numpy as np; print(len(np.load("many.npz")["events"]))') == 400"
check "$many < $few + 80"
# An .npz of events is read and written whole: where it has no room, that is said, and what to do.
py - <<'EOF'
import numpy as np
n = 20_000_000
np.savez("many_events.npz", x=np.zeros(n, np.uint16), y=np.zeros(n, np.uint16), p=np.ones(n, np.uint8), t=np.arange(n))
np.savez("few_events.npz", x=np.zeros(9, np.uint16), y=np.zeros(9, np.uint16), p=np.ones(9, np.uint8), t=np.arange(9))
EOF
little() { (ulimit -v 350000; "$@"); }
little "$E2LF" convert few_events.npz few.raw --sensor-width 64 --sensor-height 48 --quiet --threads 1
fails 1 "many_events.npz" little "$E2LF" convert many_events.npz many.raw --sensor-width 64 --sensor-height 48 --quiet --threads 1
"$E2LF" convert many_events.npz many.raw --sensor-width 64 --sensor-height 48 --quiet
fails 1 "back.npz" little "$E2LF" convert many.raw back.npz --quiet --threads 1
absent back.npz
