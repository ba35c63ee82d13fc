#!/bin/sh
# start robot|cloud FOLDER [OPTION...]   what the services and the images start
# Runs fleetloc-robot or fleetloc-cloud with the keys in FOLDER, and without them only where it is told
# so. The environment says:
#   FLEETLOC_SECURITY   on (default), or off: without keys, nothing is encrypted
#   FLEETLOC_QOS        a file of QoS profiles; wifi-secure.xml, or wifi.xml where security is off
#   FLEETLOC_ROBOT_ID, FLEETLOC_NAME   whose keys are asked for
#   FLEETLOC_BIN        where the programs are (/usr/bin)
#
# start copy-keys FOLDER   what a service does first, as root
# Copies the keys in FOLDER, which is root's, to RUNTIME_DIRECTORY, for its owner: the service's user,
# who exists only while it runs. There they are taken from. (LoadCredential would do that, but leaves
# its folder empty in containers, where systemd 252 has no shared mounts.)
set -eu

copies=${RUNTIME_DIRECTORY:+$RUNTIME_DIRECTORY/keys}

copy_keys() {  # FOLDER
  umask 077
  rm -rf "$copies"
  mkdir "$copies"
  [ ! -d "$1" ] || find -L "$1" -maxdepth 1 -type f -exec cp -t "$copies" {} +
  chown -R --reference="$RUNTIME_DIRECTORY" "$copies"
}

part=$1 folder=$2
shift 2
case $part in
  robot) member="robot ${FLEETLOC_ROBOT_ID:-NAME}" ;;
  cloud) member="localizer ${FLEETLOC_NAME:-NAME}" ;;
  copy-keys)
    copy_keys "$folder"
    exit
    ;;
  *)
    echo "usage: start robot|cloud|copy-keys FOLDER [OPTION...]" >&2
    exit 2
    ;;
esac

refuse() {
  echo "fleetloc-$part: $1" >&2
  exit 2
}

profile=wifi
case ${FLEETLOC_SECURITY:-on} in
  on)
    profile=wifi-secure
    keys=${copies:-$folder}
    [ ! -d "$keys" ] || [ -x "$keys" ] || refuse "$folder: $(id -un) (user $(id -u)) may not read it"
    made="make them with 'fleet-keys.sh $member' and copy the files there"
    [ -f "$keys/key.pem" ] || refuse "no keys in $folder: $made, or set FLEETLOC_SECURITY=off"
    set -- --security "$keys" "$@"
    ;;
  off)
    echo "fleetloc-$part: FLEETLOC_SECURITY=off: nothing is encrypted, and whoever reaches this network is believed" >&2
    ;;
  *) refuse "FLEETLOC_SECURITY: '$FLEETLOC_SECURITY' is neither on nor off" ;;
esac
exec "${FLEETLOC_BIN:-/usr/bin}/fleetloc-$part" --qos "${FLEETLOC_QOS:-/usr/share/fleetloc/$part/qos_profiles/$profile.xml}" "$@"
