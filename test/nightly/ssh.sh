#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# ssh.sh STUDY SOURCE FOLDER: a study over two "hosts" by real ssh to this machine, whose sshd this script starts on a port and
# with keys of its own, with workers killed on the way. Its table must be that of a serial run.
# sshd comes from the machine, or is unpacked from Debian's package into FOLDER/packages; nothing is installed.
set -euo pipefail
. "$(dirname "$0")/study_of_200.sh"

sshd=$(command -v sshd || echo /usr/sbin/sshd)
if [[ ! -x $sshd ]]; then
  sshd=$packages/usr/sbin/sshd
  if [[ ! -x $sshd ]]; then
    unpack openssh-server libwrap0
  fi
  LD_LIBRARY_PATH=$packages/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH):${LD_LIBRARY_PATH-}
  export LD_LIBRARY_PATH
fi
port=$("$source/launch/free_port.py")
ssh-keygen -q -t ed25519 -N '' -f "$run/host_key"
ssh-keygen -q -t ed25519 -N '' -f "$run/user_key"
cp "$run/user_key.pub" "$run/authorized_keys"
cat >"$run/sshd_config" <<CONF
Port $port
ListenAddress 127.0.0.1
HostKey $run/host_key
AuthorizedKeysFile $run/authorized_keys
PidFile $run/sshd.pid
StrictModes no
UsePAM no
PasswordAuthentication no
PermitRootLogin prohibit-password
AcceptEnv OPENBLAS_NUM_THREADS XDG_CACHE_HOME
MaxStartups 100
CONF
# As root it gives up its rights to a user that only its package makes: here in a view of /etc of its own.
start=(env)
if [[ $(id -u) == 0 ]]; then
  mkdir -p /run/sshd
  if ! getent passwd sshd >/dev/null; then
    { cat /etc/passwd; echo 'sshd:x:65534:65534::/run/sshd:/usr/sbin/nologin'; } >"$run/passwd"
    start=(unshare -m bash -c 'mount --bind "$0" /etc/passwd && exec "$@"' "$run/passwd")
  fi
fi
"${start[@]}" "$sshd" -D -f "$run/sshd_config" -E "$run/sshd.log" &
daemon=$!
trap 'kill "$daemon" 2>/dev/null || true; wait || true' EXIT

ssh="ssh -o BatchMode=yes -o StrictHostKeyChecking=no -o UserKnownHostsFile=$run/known_hosts -o SendEnv=OPENBLAS_NUM_THREADS"
ssh="$ssh -o SendEnv=XDG_CACHE_HOME -i $run/user_key -p $port"
for _ in $(seq 50); do
  $ssh 127.0.0.1 true 2>/dev/null && break
  sleep 0.2
done
$ssh 127.0.0.1 true

printf '127.0.0.1 1\nlocalhost 1\n' >"$run/hosts"
"$study" "$run/study.yaml" --output "$run/by_ssh" --hosts "$run/hosts" --ssh "$ssh" >"$run/by_ssh.log" 2>&1 &
master=$!
killed=0
while ((killed < 3)) && kill -0 "$master" 2>/dev/null; do
  sleep 0.3
  # A worker on the far side: a child of this sshd.
  victim=$(pgrep -f "study --worker simulate" | while read -r pid; do
    parent=$pid
    while [[ ${parent:-0} -gt 1 ]]; do
      [[ $parent == "$daemon" ]] && echo "$pid" && break
      parent=$(ps -o ppid= -p "$parent" 2>/dev/null | tr -d ' ')
    done
  done | head -1) || true
  [[ -z $victim ]] || { kill -9 "$victim" && killed=$((killed + 1)); }
done
wait "$master" || { cat "$run/by_ssh.log" "$run/sshd.log"; exit 1; }
require_serial_table "$run/by_ssh"
echo "by ssh as serially: $(($(wc -l <"$run/serial/results.csv") - 1)) tasks; killed $killed workers"
((killed > 0))
