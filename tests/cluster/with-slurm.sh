#!/usr/bin/env bash
# Run a command on a Slurm of this one machine that is there for the command alone.
#
#   tests/cluster/with-slurm.sh COMMAND...
#
# Where Slurm runs already, the command uses that. Else this installs Debian's packages, starts
# Slurm with two pretended nodes of four CPUs, and afterwards ends and removes what it has started,
# written and installed. Where that is impossible it says why and runs the command without Slurm.
set -euo pipefail

export PATH="$PATH:/usr/sbin:/sbin" # where the daemons stand
packages=(slurmctld slurmd slurm-client munge)
configuration=/etc/slurm/slurm.conf
folder='' before='' shared='' daemons=()

installed() {
  dpkg-query --show --showformat '${db:Status-Abbrev} ${Package}\n' | awk '/^ii/ { print $2 }' | sort
}

shared_memory() {
  find /dev/shm -maxdepth 1 -name 'mpich_shm_*' 2>/dev/null | sort
}

clean_up() {
  set +e
  [ "${#daemons[@]}" -gt 0 ] && scancel --user="$(id -un)" 2>/dev/null && sleep 1
  for process in "${daemons[@]}"; do kill "$process"; done 2>/dev/null
  wait
  if [ -n "$folder" ]; then
    [ -f "$folder/slurm.conf" ] && rm -f "$configuration"
    rm -rf "$folder"
  fi
  for memory in $(comm -13 <(echo "$shared") <(shared_memory)); do # of ranks that were killed
    grep --quiet --no-messages "$memory" /proc/[0-9]*/maps || rm -f "$memory"
  done
  if [ -n "$before" ]; then
    added=$(comm -13 <(echo "$before") <(installed))
    [ -n "$added" ] && apt-get purge --yes $added >/dev/null 2>&1
  fi
}

if timeout 10 sinfo --noheader >/dev/null 2>&1; then exec "$@"; fi
if [ "$(id -u)" != 0 ]; then echo "no Slurm answers, and only root can install one"; exec "$@"; fi
if ! command -v apt-get >/dev/null; then echo "no Slurm answers, and there is no apt-get"; exec "$@"; fi
if [ -e "$configuration" ]; then echo "$configuration is somebody else's; it stays"; exec "$@"; fi

trap clean_up EXIT
trap 'exit 130' INT TERM
folder=$(mktemp --directory)
shared=$(shared_memory)
if ! type slurmctld slurmd munged srun >/dev/null 2>&1; then
  before=$(installed)
  export DEBIAN_FRONTEND=noninteractive
  if ! { timeout 300 apt-get update && timeout 600 apt-get install --yes --no-install-recommends "${packages[@]}"; } \
    >"$folder/apt.log" 2>&1; then
    echo "Slurm cannot be installed here: $(tail -1 "$folder/apt.log")"
    "$@"
    exit
  fi
fi

mkdir "$folder"/{state,spool-n1,spool-n2}
dd if=/dev/urandom of="$folder/munge.key" bs=1 count=1024 status=none
chmod 755 "$folder"
chmod 400 "$folder/munge.key"
munged --foreground --force --socket="$folder/munge.socket" --key-file="$folder/munge.key" \
  --pid-file="$folder/munged.pid" --seed-file="$folder/munged.seed" --log-file="$folder/munged.log" \
  --num-threads=2 >/dev/null 2>&1 &
daemons+=($!)

# MPICH names its shared memory after the job, and what a killed job has left makes the next one of
# that number wait for ever: the first number is a random one.
cat >"$folder/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=16817
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool-%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd-%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=pmi2
ReturnToService=2
MinJobAge=300
FirstJobId=$((RANDOM * 1000 + RANDOM))
KillWait=5
SchedulerParameters=sched_interval=1,bf_interval=1,sched_min_interval=0,batch_sched_delay=0
SlurmdParameters=config_overrides
NodeName=n[1-2] NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=[16818-16819] CPUs=4 RealMemory=4000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
mkdir -p "$(dirname "$configuration")"
cp "$folder/slurm.conf" "$configuration"
slurmctld -D >/dev/null 2>&1 &
daemons+=($!)
for node in n1 n2; do
  slurmd -D -N "$node" >/dev/null 2>&1 &
  daemons+=($!)
done
idle() { [ "$(timeout 5 sinfo --noheader --Node --states=idle 2>/dev/null | wc -l)" = 2 ]; }
late=$((SECONDS + 30))
until idle || [ "$SECONDS" -gt "$late" ]; do sleep 0.5; done
idle || tail -n 5 "$folder"/*.log
"$@"
