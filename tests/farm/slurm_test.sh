#!/usr/bin/env bash
# examples/farm/slurm.sh on a cluster of one node, whose daemons are started here and end with the test. As root, with Debian's slurm-wlm
# and munge.   tests/farm/slurm_test.sh GLINT SOURCE
set -euo pipefail
glint=$(realpath "$1") source=$(realpath "$2")
folder=$(mktemp -d)
daemons=""
finish() {
    result=$?
    for process in $daemons; do kill "$process" 2>/dev/null || true; done
    wait 2>/dev/null || true
    [ $result -eq 0 ] || tail -n 20 "$folder"/*.log >&2
    rm -rf "$folder"
    exit $result
}
trap finish EXIT
chmod 755 "$folder"
mkdir "$folder"/{state,spool,bin,munge}
ln -s "$glint" "$folder/bin/glint"
export PATH="$folder/bin:$PATH" SLURM_CONF=$folder/slurm.conf

# A key of its own, and a socket that no other munge has.
(umask 077; head -c 1024 /dev/urandom > "$folder/munge/key")
chmod 700 "$folder/munge"
/usr/sbin/munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
    --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" > "$folder/munged.log" 2>&1 &
daemons="$daemons $!"
host=$(hostname -s)
cat > "$SLURM_CONF" <<EOF
ClusterName=glint
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ReturnToService=2
SchedulerParameters=sched_interval=1,bf_interval=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
EOF
for _ in $(seq 100); do [ -S "$folder/munge/socket" ] && break; sleep 0.1; done
/usr/sbin/slurmctld -D -i -f "$SLURM_CONF" > "$folder/ctld.log" 2>&1 &
daemons="$daemons $!"
/usr/sbin/slurmd -D -N "$host" -f "$SLURM_CONF" > "$folder/d.log" 2>&1 &
daemons="$daemons $!"
for _ in $(seq 300); do sinfo -h -o %T 2>/dev/null | grep -q idle && break; sleep 0.2; done
sinfo -h -o %T | grep -q idle || { echo "the node does not come up" >&2; exit 1; }

cd "$folder"
"$source/examples/farm/slurm.sh" "$source/scenes/spheres.json" slurm.png 4
for _ in $(seq 1200); do [ -z "$(squeue -h)" ] && break; sleep 0.2; done
[ -f slurm.png ] || { echo "no picture" >&2; cat slurm.png.parts/*.log >&2; exit 1; }
glint render "$source/scenes/spheres.json" -q -o alone.png
cmp slurm.png alone.png
echo "slurm: four parts by an array of jobs are the picture of one"
