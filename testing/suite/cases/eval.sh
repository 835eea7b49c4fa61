# e2lf eval.

part eval_errors
# Light fields that cannot be compared are refused with the view or size at fault.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
cp -r demo/scene missing && rm missing/03_05.png
fails 1 "03_05" "$E2LF" eval demo/scene missing
cp -r demo/scene unreadable && head -c 60 demo/scene/02_02.png >unreadable/02_02.png
fails 1 "02_02.png" "$E2LF" eval demo/scene unreadable
cp -r demo/scene garbage && echo "no picture" >garbage/00_07.png
fails 1 "00_07.png" "$E2LF" eval demo/scene garbage
"$E2LF" demo -o larger --width 64 --height 32 --quiet
fails 1 "48" "$E2LF" eval demo/scene larger/scene
"$E2LF" eval demo/scene demo/scene --json >same.json
[ "$(json same.json "(j['psnr_db'], j['ssim_uniform7'])")" = "(None, 1.0)" ] || fail "equal pictures"

part eval_names
# Several reconstructions are compared by name, with the gain that was applied to them and the one that fits.
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" demo -m "$model" -o demo --width 64 --height 48 --quiet
"$E2LF" reconstruct demo/events.npz -m "$model" --gain 2 --format npy -o bright --quiet
"$E2LF" reconstruct demo/events.npz -m "$model" --gain 1 --format npy -o plain --quiet
"$E2LF" eval demo/scene bright >eval.txt
grep -q "toned when it was reconstructed: a gain of 2 and" eval.txt || fail "$(cat eval.txt)"
"$E2LF" eval demo/scene --name twice=bright --name once=plain --fit-gain --json --report eval.html >eval.json
check "$(json eval.json "[m['method'] for m in j['methods']]") == ['twice', 'once']"
check "$(json eval.json "abs(j['methods'][1]['fitted_gain'] / j['methods'][0]['fitted_gain'] - 2)") < 0.001"
check "$(json eval.json "abs(j['methods'][1]['psnr_db'] - j['methods'][0]['psnr_db'])") < 0.01"
grep -q "twice" eval.html || fail "no caption"
# The black level is fitted, too: a toned result is as good as the plain one.
"$E2LF" reconstruct demo/events.npz -m "$model" --gain 2 --black 0.1 --format npy -o toned --quiet
"$E2LF" eval demo/scene --name toned=toned --name plain=plain --fit-gain --json >eval.json
check "abs($(json eval.json "j['methods'][0]['psnr_db'] - j['methods'][1]['psnr_db']")) < 0.01"
check "$(json eval.json "all(m['disparity']['truth'].endswith('gt_disparity.npy') for m in j['methods'])")"
"$E2LF" depth demo/scene -o disparity.pfm --quiet
"$E2LF" eval demo/scene demo/scene --true-disparity disparity.pfm --json >same.json
check "$(json same.json "j['disparity']['bad_07_percent']") == 0 and abs($(json same.json "j['disparity']['slope']") - 1) < 1e-6"
# Disparities of the opposite sign are refused, and distances are told.
py -c "
import numpy as np
truth = np.load('demo/scene/gt_disparity.npy')
np.save('negated.npy', -truth)
np.save('metres.npy', 4 / (1 + 0.3 * (truth - truth.min())))"
fails 1 "negate them" "$E2LF" eval demo/scene plain --true-disparity negated.npy
"$E2LF" eval demo/scene plain --true-disparity metres.npy >eval.txt 2>told.txt
grep -q "may be distances" told.txt || fail "$(cat told.txt)"
"$E2LF" eval demo/scene plain --true-disparity demo/scene/gt_disparity.npy >eval.txt 2>told.txt
[ ! -s told.txt ] || fail "$(cat told.txt)"
fails 1 "disparity map" "$E2LF" eval demo/scene plain --true-disparity demo/events.npz
fails 1 "NAME=PATH" "$E2LF" eval demo/scene --name bright
fails 1 "--name once=plain" "$E2LF" eval demo/scene --name once=bright --name once=plain
# What a verb does not take is sent to the verb that does.
fails 1 "\`e2lf reconstruct\` computes a light field from them" "$E2LF" accumulate demo/events.npz -o x.npz
fails 1 "\`e2lf simulate\` generates events from it" "$E2LF" accumulate demo/scene -o x.npz
