#!/bin/sh
# fleet-vpn.sh: a fleet's own network over any other, by WireGuard. See --help.
set -eu
umask 077

name=fleetvpn              # of the interface
network=10.86              # .0.x: localizers, .1.x and above: robots
port=51820
mtu=1380                   # with 60 bytes of the tunnel 1440: less than mobile networks have
message=1344               # of RTPS, with the headers of IP and UDP in one frame of the tunnel
keepalive=25               # [s]: routers forget a connection after 30 s of silence, the hastiest

usage() {
  cat <<'HELP'
fleet-vpn.sh [OPTION]... COMMAND [NAME [HOST[:PORT]]]

Makes the keys and files with which robots behind any router reach the fleet's localizers, and
nobody else does, by WireGuard:

  localizer NAME HOST[:PORT]   the computer of one or several localizers, and how robots reach it:
                               a public name or address, UDP port 51820 if nothing is said
  robot NAME                   a robot
  remove NAME                  takes a computer out; those that it talks to need their new files
  list                         all computers, with their addresses in the network

Each has a folder DIR/NAME, to be copied to that computer and nowhere else:
  fleetvpn.conf                for wg-quick: /etc/wireguard/fleetvpn.conf
  qos.xml                      for --qos: one of qos_profiles, bound to the fleet's network
Every command makes the files of all computers anew, with the keys that they have. Where files of
a running network have changed:  wg syncconf fleetvpn <(wg-quick strip fleetvpn)

Options:
  -d, --dir DIR      the network's folder; ./fleet-vpn if nothing is said
  --profile FILE     that the qos.xml are based on, one of *-peers, as those computers have it; where
                     the packages put lte-peers.xml if nothing is said
  -h, --help

Exit 0: done. 1: it could not be done. 2: wrong words.
HELP
}

fail() {
  echo "fleet-vpn: $1" >&2
  exit "${2:-1}"
}

wrong_words() {
  fail "$1; see --help" 2
}

dir=./fleet-vpn
profile=""
command=""
who=""
endpoint=""
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    -d | --dir) [ $# -ge 2 ] || wrong_words "$1 needs a folder"; dir=$2; shift ;;
    --profile) [ $# -ge 2 ] || wrong_words "$1 needs a file"; profile=$2; shift ;;
    -*) wrong_words "'$1' is not an option" ;;
    *)
      if [ -z "$command" ]; then command=$1
      elif [ -z "$who" ]; then who=$1
      elif [ -z "$endpoint" ]; then endpoint=$1
      else wrong_words "'$1' is one word too many"
      fi ;;
  esac
  shift
done

expect_name() {
  case $who in
    "" | *[!A-Za-z0-9_-]*) wrong_words "'$who' is not a name of 1 to 32 of A-Z a-z 0-9 _ -" ;;
  esac
  [ ${#who} -le 32 ] || wrong_words "'$who' is not a name of 1 to 32 of A-Z a-z 0-9 _ -"
}

members() {  # ROLE; names in the order of their addresses
  [ -d "$dir" ] || return 0
  for file in "$dir"/*/address; do
    [ -f "$file" ] || continue
    member=$(dirname "$file")
    [ "$(cat "$member/role")" = "$1" ] || continue
    printf '%s %s\n' "$(cat "$file")" "$(basename "$member")"
  done | sort -t. -k3,3n -k4,4n | cut -d' ' -f2
}

is_taken() {  # ADDRESS
  for file in "$dir"/*/address; do
    if [ -f "$file" ] && [ "$(cat "$file")" = "$1" ]; then return 0; fi
  done
  return 1
}

free_address() {  # ROLE
  third=0
  [ "$1" = localizer ] || third=1
  last=$third
  [ "$1" = localizer ] || last=255
  while [ "$third" -le "$last" ]; do
    fourth=1
    while [ "$fourth" -le 254 ]; do
      address=$network.$third.$fourth
      is_taken "$address" || { echo "$address"; return; }
      fourth=$((fourth + 1))
    done
    third=$((third + 1))
  done
  fail "there is no address left"
}

add() {  # ROLE; who and endpoint are given
  member=$dir/$who
  if [ -e "$member/role" ] && [ "$(cat "$member/role")" != "$1" ]; then
    fail "$who is a $(cat "$member/role") already"
  fi
  mkdir -p "$member"
  [ -s "$member/private.key" ] || wg genkey >"$member/private.key"
  wg pubkey <"$member/private.key" >"$member/public.key"
  [ -s "$member/address" ] || free_address "$1" >"$member/address"
  echo "$1" >"$member/role"
  [ -z "$endpoint" ] || echo "$endpoint" >"$member/endpoint"
}

# A secret of each pair, so that who breaks the key exchange some day reads nothing.
shared_key() {  # LOCALIZER ROBOT
  file=$dir/$1/shared.$2
  [ -s "$file" ] || wg genpsk >"$file"
  cat "$file"
}

interface_section() {  # MEMBER; the prefix is that of one address: there are no others on the link
  printf '[Interface]\nPrivateKey = %s\nAddress = %s/32\nMTU = %s\n' \
    "$(cat "$dir/$1/private.key")" "$(cat "$dir/$1/address")" "$mtu"
}

peer_section() {  # PEER SHARED_KEY
  printf '\n# %s\n[Peer]\nPublicKey = %s\nPresharedKey = %s\nAllowedIPs = %s/32\n' \
    "$1" "$(cat "$dir/$1/public.key")" "$2" "$(cat "$dir/$1/address")"
}

write_configuration() {  # MEMBER
  file=$dir/$1/$name.conf
  interface_section "$1" >"$file.new"
  if [ "$(cat "$dir/$1/role")" = localizer ]; then
    echo "ListenPort = $(sed 's/.*://' "$dir/$1/endpoint")" >>"$file.new"
    for robot in $(members robot); do
      peer_section "$robot" "$(shared_key "$1" "$robot")" >>"$file.new"
    done
  else
    for localizer in $(members localizer); do
      { peer_section "$localizer" "$(shared_key "$localizer" "$1")"
        echo "Endpoint = $(cat "$dir/$localizer/endpoint")"
        echo "PersistentKeepalive = $keepalive"; } >>"$file.new"
    done
  fi
  mv "$file.new" "$file"
}

# Bound to the network of the fleet: what is not for it does not leave by another interface.
write_profiles() {  # MEMBER
  address=$(cat "$dir/$1/address")
  transport=udp
  base=${profile:-/usr/share/fleetloc/robot/qos_profiles/lte-peers.xml}
  if [ "$(cat "$dir/$1/role")" = localizer ]; then
    transport=udp_cloud
    base=${profile:-/usr/share/fleetloc/cloud/qos_profiles/lte-peers.xml}
  fi
  {
    cat <<XML
<?xml version="1.0" encoding="UTF-8"?>
<!-- Of $1 in the fleet's own network, made by fleet-vpn.sh. -->
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"
     xmlns:fleetloc="fleetloc" fleetloc:based_on="$base">
<profiles>
  <transport_descriptors>
    <transport_descriptor>
      <transport_id>$transport</transport_id>
      <maxMessageSize>$message</maxMessageSize>
      <interfaceWhiteList><address>$address</address></interfaceWhiteList>
    </transport_descriptor>
  </transport_descriptors>
XML
    if [ "$transport" = udp ]; then
      printf '  <participant profile_name="robot">\n    <rtps>\n      <builtin>\n'
      printf '        <initialPeersList>\n'
      for localizer in $(members localizer); do
        printf '          <locator><udpv4><address>%s</address></udpv4></locator>\n' \
          "$(cat "$dir/$localizer/address")"
      done
      printf '        </initialPeersList>\n      </builtin>\n    </rtps>\n  </participant>\n'
    fi
    printf '</profiles>\n</dds>\n'
  } >"$dir/$1/qos.xml"
}

write_all() {
  for member in $(members localizer) $(members robot); do
    write_configuration "$member"
    write_profiles "$member"
  done
}

command -v wg >/dev/null || fail "needs the program wg (Debian: wireguard-tools)"
case $command in
  localizer)
    expect_name
    [ -n "$endpoint" ] || wrong_words "a localizer needs HOST or HOST:PORT, by which robots reach it"
    case $endpoint in *:*) ;; *) endpoint=$endpoint:$port ;; esac
    ;;
  robot)
    expect_name
    [ -z "$endpoint" ] || wrong_words "a robot has no '$endpoint': it reaches the localizers"
    ;;
  remove)
    expect_name
    [ -e "$dir/$who/role" ] || fail "there is no $who in $dir"
    ;;
  list) [ -d "$dir" ] || fail "there is no $dir" ;;
  "") wrong_words "what is to be done?" ;;
  *) wrong_words "'$command' is not a command" ;;
esac
case $command in
  localizer | robot)
    add "$command"
    write_all
    echo "$dir/$who: $name.conf and qos.xml, $(cat "$dir/$who/address")"
    ;;
  remove)
    rm -rf "${dir:?}/$who" "$dir"/*/shared."$who"
    write_all
    ;;
  list)
    for member in $(members localizer) $(members robot); do
      printf '%-10s %-32s %-15s %s\n' "$(cat "$dir/$member/role")" "$member" \
        "$(cat "$dir/$member/address")" "$(cat "$dir/$member/endpoint" 2>/dev/null || true)"
    done
    ;;
esac
