#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# slurm.sh STUDY SOURCE FOLDER: a study of 200 tasks as array jobs of Debian's Slurm, on one node that this script starts in
# FOLDER, with a job and the study itself killed on the way. Its table must be that of a serial run.
# Slurm comes from the machine, or is unpacked from Debian's packages into FOLDER/packages; nothing is installed.
set -euo pipefail
. "$(dirname "$0")/study_of_200.sh"

if ! { command -v slurmctld && command -v slurmd && command -v munged; } >/dev/null; then
  if [[ ! -e $packages/usr/sbin/slurmctld ]]; then
    unpack munge slurm-client slurm-wlm-basic-plugins slurmctld slurmd libmunge2 libhwloc15
    for daemon in slurmd slurmstepd slurmctld; do ln -s "$daemon-wlm" "$packages/usr/sbin/$daemon"; done
  fi
  library=$packages/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
  plugins=PluginDir=$library/slurm-wlm
  stepd=(-d "$packages/usr/sbin/slurmstepd")
  export PATH=$packages/usr/sbin:$packages/usr/bin:$PATH LD_LIBRARY_PATH=$library:$library/slurm-wlm:${LD_LIBRARY_PATH-}
fi

daemons=()
cleanup() {
  for daemon in "${daemons[@]}"; do kill "$daemon" 2>/dev/null || true; done
  wait || true
}
trap cleanup EXIT

read -r port node_port < <("$source/launch/free_port.py" 2)
node=$(hostname -s)
export SLURM_CONF=$run/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=nightly
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$node_port
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$run/munge.socket
StateSaveLocation=$run/state
SlurmdSpoolDir=$run/spool
SlurmctldPidFile=$run/slurmctld.pid
SlurmdPidFile=$run/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
MinJobAge=10
SchedulerParameters=batch_sched_delay=0,sched_interval=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
${plugins-}
CONF
mkdir "$run/state" "$run/spool"
head -c 1024 /dev/urandom >"$run/munge.key"
chmod 400 "$run/munge.key"
munged --foreground --force --key-file="$run/munge.key" --socket="$run/munge.socket" --pid-file="$run/munge.pid" \
  --seed-file="$run/munge.seed" --log-file="$run/munged.log" 2>"$run/munged.log" &
daemons+=($!)
slurmctld -D -i >"$run/slurmctld.log" 2>&1 &
daemons+=($!)
slurmd -D "${stepd[@]}" -N "$node" >"$run/slurmd.log" 2>&1 &
daemons+=($!)
for ((i = 0; i < 300; ++i)); do
  [[ $(sinfo --noheader --format %t 2>/dev/null) != idle ]] || break
  kill -0 "${daemons[@]}" || { cat "$run"/*.log; exit 1; }
  sleep 0.2
done
sinfo

outcomes() {
  python3 -c 'import sqlite3, sys; print(*sqlite3.connect(sys.argv[1]).execute("SELECT count(*) FROM outcomes").fetchone())' \
    "$run/array/journal.sqlite" 2>/dev/null || echo 0
}
"$study" "$run/study.yaml" --output "$run/array" --slurm 4 >"$run/first.log" 2>&1 &
master=$!
while (($(outcomes) < 20)); do
  kill -0 "$master" 2>/dev/null || { cat "$run/first.log" "$run"/slurm*.log; exit 1; }
  sleep 0.1
done
job=$(pgrep -f -- "--array-job $run/array/slurm" | head -1) || true
[[ -z $job ]] || kill -9 "$job"
kill -9 "$master"
squeue
"$study" "$run/study.yaml" --output "$run/array" --slurm 4 2>&1 | tee "$run/second.log" | grep -v '%:'
require_serial_table "$run/array"
(($(outcomes) == 200))
echo "200 tasks by arrays of Slurm $(sinfo --version): the table of a serial run; killed a job (${job:-none}) and the study"
