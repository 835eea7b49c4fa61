# The Slurm job of examples/cluster, run as tasks of an array without a queue: recordings of one name each have their folder.
export PATH=$(dirname "$E2LF"):$PATH
job=$(realpath "$SOURCES/examples/cluster/reconstruct.sbatch")
"$E2LF" demo -o demo --width 64 --height 48 --quiet
mkdir a b.c elsewhere work
for path in a/recording.raw a/recording.dat b.c/recording.raw elsewhere/recording.raw; do
  "$E2LF" simulate demo/scene -m e2lf-n4 -o "$path" --quiet
done
mv a b.c work
cd work
printf '%s\n' a/recording.raw a/recording.dat ./b.c/recording.raw "$PWD/../elsewhere/recording.raw" >list.txt
for task in 1 2 3 4; do SLURM_ARRAY_TASK_ID=$task SLURM_CPUS_PER_TASK=1 bash "$job" list.txt e2lf-n4 fields; done
outside=$(realpath -s ../elsewhere/recording.raw)
for path in a/recording.raw a/recording.dat b.c/recording.raw "$outside"; do exists "fields/$path-lightfield/run.json"; done
[ "$(find fields -name "*-lightfield" | wc -l)" -eq 4 ] || fail "four recordings, and $(find fields -name "*-lightfield")"
