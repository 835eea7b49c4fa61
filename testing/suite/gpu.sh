#!/usr/bin/env bash
# gpu.sh BUILD [PROCESSES]: tries on GPUs what the tests try on the CPU: the networks of --device, training, and training by one
# process for each of PROCESSES GPUs (NCCL). BUILD is a build folder with a torch that has CUDA. E2LF_DEVICE=torch-cpu tries the
# script itself.
set -euo pipefail
programs=$(realpath "$1")/bin processes=${2:-1}
export E2LF_DEVICE=${E2LF_DEVICE:-cuda} MASTER_ADDR=127.0.0.1 MASTER_PORT=29519
# What training calls the device of a process.
device_of() { if [ "$E2LF_DEVICE" = cuda ]; then echo "cuda:$1"; else echo cpu; fi; }
"$programs/e2lf_device_test"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >tiny.json <<'JSON'
{"name": "tiny", "data": {"synthetic_share": 1.0, "pool": 4, "synthesiser": {"size": 32}}, "patterns": {"begin_step": 2, "learn_steps": 8},
 "network": {"widths": [8, 8], "blocks": [1, 1], "head_width": 4},
 "train": {"patch": 16, "batch": 4, "steps": 20, "warmup_steps": 2, "log_steps": 5, "evaluate_steps": 20, "checkpoint_steps": 10}}
JSON
"$programs/e2lf-train" train tiny.json -o alone --set device="$(device_of 0)"
for ((rank = 1; rank < processes; ++rank)); do
  WORLD_SIZE=$processes RANK=$rank "$programs/e2lf-train" train tiny.json -o unused --set device="$(device_of $rank)" &
done
WORLD_SIZE=$processes RANK=0 "$programs/e2lf-train" train tiny.json -o together --set device="$(device_of 0)"
wait
"$programs/e2lf" demo -o demo --width 64 --height 48 --quiet
for run in alone together; do
  "$programs/e2lf" simulate demo/scene -m $run/tiny.safetensors -o $run.npz --quiet
  "$programs/e2lf" reconstruct $run.npz -m $run/tiny.safetensors -o $run/fields --device "$E2LF_DEVICE" --quiet
  [ -s $run/fields/run.json ]
done
echo "gpu: networks, training and $processes processes work on $E2LF_DEVICE"
