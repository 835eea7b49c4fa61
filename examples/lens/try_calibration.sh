#!/bin/bash
# Calibrates a simulated lens: board, events, light fields, lens.json, depth in metres.   try_calibration.sh FOLDER
set -eu
examples=$(dirname "$0") folder=$1
python3 "$examples/simulated_board.py" "$folder"
for pose in "$folder"/pose_*; do
  e2lf simulate "$pose" -m e2lf-n4-camera --camera evk4-lcos -o "$folder/events.npz" --overwrite --quiet
  e2lf reconstruct "$folder/events.npz" -m e2lf-n4-camera -o "$folder/recon/${pose##*/}" --quiet
done
python3 "$examples/calibrate_lens.py" "$folder/lens.json" "$folder"/recon/*
e2lf depth "$folder/recon/pose_00" -o "$folder/depth" --lens "$folder/lens.json"
