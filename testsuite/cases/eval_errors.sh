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
