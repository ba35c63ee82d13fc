#!/bin/sh
# service_start.sh: what deploy/packages/start.sh starts, with keys, without them, and where they are
# not wanted; the programs are stand-ins that print their words. Each expectation names itself when it
# fails.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

mkdir "$scratch/bin" "$scratch/empty" "$scratch/keys" "$scratch/run"
for part in robot cloud; do
  printf '#!/bin/sh\necho "%s runs: $*"\n' "$part" >"$scratch/bin/fleetloc-$part"
  chmod +x "$scratch/bin/fleetloc-$part"
done
PATH=$scratch/bin:$PATH
for file in key.pem certificate.pem; do echo "$file" >"$scratch/keys/$file"; done

failures=0
# says WHAT CODE LINE [NAME=VALUE]... PART FOLDER WORD...: it ends so, and that is all that it says.
says() {
  what=$1 code=$2 line=$3
  shift 3
  set +e
  said=$(env -u FLEETLOC_QOS -u FLEETLOC_SECURITY "$@" 2>&1)
  ended=$?
  set -e
  [ "$ended" = "$code" ] && [ "$said" = "$line" ] && return 0
  printf 'FAILED: %s\nit ended with %s and said: %s\nexpected: %s\n' "$what" "$ended" "$said" "$line" >&2
  failures=$((failures + 1))
}
start=$root/deploy/packages/start.sh
profiles=/usr/share/fleetloc

says "a robot without keys is refused in one line, which names the command and the folder" 2 \
  "fleetloc-robot: no keys in $scratch/empty: make them with 'fleet-keys.sh robot robot_7' and copy the files there, or set FLEETLOC_SECURITY=off" \
  FLEETLOC_ROBOT_ID=robot_7 "$start" robot "$scratch/empty" --robot-id robot_7
says "so is a localizer" 2 \
  "fleetloc-cloud: no keys in $scratch/none: make them with 'fleet-keys.sh localizer localizer_1' and copy the files there, or set FLEETLOC_SECURITY=off" \
  FLEETLOC_NAME=localizer_1 "$start" cloud "$scratch/none" --name localizer_1
says "also where it is said that security is on" 2 \
  "fleetloc-cloud: no keys in $scratch/none: make them with 'fleet-keys.sh localizer NAME' and copy the files there, or set FLEETLOC_SECURITY=off" \
  FLEETLOC_SECURITY=on "$start" cloud "$scratch/none"
says "with keys a robot has a secure profile" 0 \
  "robot runs: --qos $profiles/robot/qos_profiles/wifi-secure.xml --security $scratch/keys --out a b" \
  "$start" robot "$scratch/keys" --out "a b"
says "so has a localizer" 0 \
  "cloud runs: --qos $profiles/cloud/qos_profiles/wifi-secure.xml --security $scratch/keys --map m" \
  "$start" cloud "$scratch/keys" --map m
says "another profile is taken" 0 "robot runs: --qos lte-secure.xml --security $scratch/keys" \
  FLEETLOC_QOS=lte-secure.xml "$start" robot "$scratch/keys"
says "a profile without security does not turn it off" 0 \
  "robot runs: --qos wifi.xml --security $scratch/keys" FLEETLOC_QOS=wifi.xml "$start" robot "$scratch/keys"
says "it is turned off by its setting only, with keys as without, and that is said" 0 \
  "fleetloc-robot: FLEETLOC_SECURITY=off: nothing is encrypted, and whoever reaches this network is believed
robot runs: --qos $profiles/robot/qos_profiles/wifi.xml --robot-id robot_7" \
  FLEETLOC_SECURITY=off "$start" robot "$scratch/keys" --robot-id robot_7
says "a setting that is neither is refused" 2 "fleetloc-robot: FLEETLOC_SECURITY: 'no' is neither on nor off" \
  FLEETLOC_SECURITY=no "$start" robot "$scratch/keys"

# A service, which has copies for its user, who owns RUNTIME_DIRECTORY.
chmod 700 "$scratch/run"
says "of a folder that is not there nothing is copied" 0 "" \
  RUNTIME_DIRECTORY="$scratch/run" "$start" copy-keys "$scratch/none"
says "a service without keys is told of the folder, not of the copies" 2 \
  "fleetloc-robot: no keys in $scratch/empty: make them with 'fleet-keys.sh robot NAME' and copy the files there, or set FLEETLOC_SECURITY=off" \
  RUNTIME_DIRECTORY="$scratch/run" "$start" robot "$scratch/empty"
chmod 644 "$scratch/keys/certificate.pem"
mkdir "$scratch/keys/folder"
[ "$(id -u)" != 0 ] || chown 10001:10002 "$scratch/run"
for time in first second; do
  says "a service copies its keys, the $time time" 0 "" \
    RUNTIME_DIRECTORY="$scratch/run" "$start" copy-keys "$scratch/keys"
  says "and takes the copies" 0 \
    "robot runs: --qos $profiles/robot/qos_profiles/wifi-secure.xml --security $scratch/run/keys" \
    RUNTIME_DIRECTORY="$scratch/run" "$start" robot "$scratch/keys"
done
same() { # WHAT IS EXPECTED
  [ "$2" = "$3" ] && return 0
  printf 'FAILED: %s\nit is: %s\nexpected: %s\n' "$1" "$2" "$3" >&2
  failures=$((failures + 1))
}
owner=$(stat -c %u:%g "$scratch/run")
same "the copies are the keys, for the owner of the folder alone" \
  "$(cd "$scratch/run" && stat -c '%n %u:%g %a' keys keys/*)" \
  "keys $owner 700
keys/certificate.pem $owner 600
keys/key.pem $owner 600"
same "they say the same" "$(cat "$scratch/run/keys/key.pem")" key.pem
rm "$scratch/keys/key.pem"
says "keys that are taken away" 0 "" RUNTIME_DIRECTORY="$scratch/run" "$start" copy-keys "$scratch/keys"
same "are gone with the next start" "$(ls "$scratch/run/keys")" certificate.pem

[ "$failures" = 0 ] || exit 1
echo "service_start: all as expected"
