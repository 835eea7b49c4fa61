#!/usr/bin/env bash
# slurm.sh E2LF: runs the jobs of examples/cluster with a Slurm of its own on this machine, and requeues one while it works.
set -euo pipefail
e2lf=$(realpath "$1")
jobs=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../../../examples/cluster")
export PATH=$(dirname "$e2lf"):$PATH
folder=$(mktemp -d)
chmod 755 "$folder"
cd "$folder"
daemons=(slurmd slurmctld munged)
stop() {
  [ $? -eq 0 ] || tail -n 20 ./*.log ./*.out >&2 || true
  for daemon in "${daemons[@]}"; do
    [ -s "$daemon.pid" ] || continue
    local id
    id=$(cat "$daemon.pid")
    kill "$id" && tail --pid="$id" -f /dev/null || true
  done
  cd / && rm -rf "$folder"
}
trap stop EXIT

# await <what> <command...>: returns when the command succeeds, within a minute.
await() {
  for _ in $(seq 600); do
    if "${@:2}" >await.txt 2>&1; then return; fi
    sleep 0.1
  done
  echo "slurm: $1 did not happen within a minute" >&2
  exit 1
}

start_slurm() {
  local host
  host=$(hostname -s)
  mkdir state spool
  (umask 077 && head -c 1024 /dev/urandom >munge.key)
  cat >slurm.conf <<CONF
ClusterName=check
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
MpiDefault=none
KillWait=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$folder/slurm.conf
  munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munged.log" --seed-file="$folder/munge.seed"
  slurmctld
  slurmd
  await "an idle node" bash -c 'sinfo -h -o %t | grep -q idle'
}

check_compare() {
  cat >compare.json <<'JSON'
{"name": "cluster", "methods": [{"name": "inversion", "algorithm": "inversion", "codes": "e2lf-n4"}],
 "scenes": [{"name": "demo", "scenes": ["demo:1", "demo:2"], "width": 64, "height": 48}], "seeds": [1, 2], "pictures": false}
JSON
  local job
  job=$(sbatch --parsable --array=1-3 --output=compare_%a.out "$jobs/compare.sbatch" compare.json compared)
  sbatch --wait --dependency="afterok:$job" --output=merge.out "$jobs/merge.sbatch" compare.json compared >submitted.txt
  e2lf compare compare.json -o alone --quiet
  cmp compared/all/table.csv alone/table.csv
  echo "slurm: three tasks and a merge gave the table of one process"
}

check_reconstruct() {
  local names=(a/recording b/recording c) name
  mkdir a b
  e2lf demo -o demo --width 64 --height 48 --quiet >demo.txt
  for name in "${names[@]}"; do
    e2lf simulate demo/scene -m e2lf-n4 -o "$name.raw" --quiet
    echo "$folder/$name.raw"
  done >list.txt
  sbatch --wait --array="1-$(wc -l <list.txt)" --output=reconstruct_%a.out "$jobs/reconstruct.sbatch" list.txt e2lf-n4 \
    fields >submitted.txt
  for name in "${names[@]}"; do test -s "fields/$name.raw-lightfield/run.json"; done
  echo "slurm: three tasks reconstructed three recordings"
}

check_train() {
  cat >train.json <<'JSON'
{"name": "tiny", "data": {"synthetic_share": 1.0, "pool": 4, "synthesiser": {"size": 32}}, "patterns": {"begin_step": 2, "learn_steps": 8},
 "network": {"widths": [8, 8], "blocks": [1, 1], "head_width": 4},
 "train": {"patch": 16, "batch": 4, "steps": 600, "warmup_steps": 2, "log_steps": 50, "evaluate_steps": 600, "checkpoint_steps": 50}}
JSON
  local job
  job=$(sbatch --parsable --output=train.out --open-mode=append "$jobs/train.sbatch" train.json run)
  await "the first checkpoint" test -e run/checkpoint.safetensors
  scontrol requeue "$job"
  await "the end of the killed tasks" bash -c "squeue -h -j $job -o %T | grep -q PENDING"
  # Slurm starts requeued jobs two minutes later.
  scontrol update "JobId=$job" StartTime=now
  await "the end of the training" bash -c "scontrol show job $job | grep -q JobState=COMPLETED"
  scontrol show job "$job" | grep -q Restarts=1
  e2lf model info run/tiny.safetensors >model.txt
  echo "slurm: a training of two tasks was requeued, continued from its checkpoint and finished"
}

start_slurm
check_compare
check_reconstruct
check_train
