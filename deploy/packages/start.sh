#!/bin/sh
# start robot|cloud FOLDER [OPTION...]   what the services and the images start
# Runs fleetloc-robot or fleetloc-cloud with the keys in FOLDER, of which a service has copies
# (LoadCredential=keys:FOLDER), and without them only where it is told so. The environment says:
#   FLEETLOC_SECURITY   on (default), or off: without keys, nothing is encrypted
#   FLEETLOC_QOS        a file of QoS profiles; wifi-secure.xml, or wifi.xml where security is off
#   FLEETLOC_ROBOT_ID, FLEETLOC_NAME   whose keys are asked for
set -eu

part=$1 folder=$2
shift 2
case $part in
  robot) member="robot ${FLEETLOC_ROBOT_ID:-NAME}" ;;
  cloud) member="localizer ${FLEETLOC_NAME:-NAME}" ;;
esac

refuse() {
  echo "fleetloc-$part: $1" >&2
  exit 2
}

# The copies are named keys_FILE: links give them their names back.
take_credentials() {
  rm -rf "$RUNTIME_DIRECTORY/keys"
  mkdir -m 700 "$RUNTIME_DIRECTORY/keys"
  for file in "$CREDENTIALS_DIRECTORY"/keys_*; do
    [ ! -f "$file" ] || ln -s "$file" "$RUNTIME_DIRECTORY/keys/${file##*/keys_}"
  done
  taken=$RUNTIME_DIRECTORY/keys
}

profile=wifi
case ${FLEETLOC_SECURITY:-on} in
  on)
    profile=wifi-secure
    taken=$folder
    [ -z "${CREDENTIALS_DIRECTORY:-}" ] || take_credentials
    made="make them with 'fleet-keys.sh $member' and copy the files there"
    [ -f "$taken/key.pem" ] || refuse "no keys in $folder: $made, or set FLEETLOC_SECURITY=off"
    set -- --security "$taken" "$@"
    ;;
  off)
    echo "fleetloc-$part: FLEETLOC_SECURITY=off: nothing is encrypted, and whoever reaches this network is believed" >&2
    ;;
  *) refuse "FLEETLOC_SECURITY: '$FLEETLOC_SECURITY' is neither on nor off" ;;
esac
exec "fleetloc-$part" --qos "${FLEETLOC_QOS:-/usr/share/fleetloc/$part/qos_profiles/$profile.xml}" "$@"
