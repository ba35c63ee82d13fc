#!/bin/sh
# fleet-keys.sh: keys, certificates and permissions of a fleet (DDS Security 1.1). See --help.
set -eu
umask 077

# Of the names of topics, see shared/transport/topics.hpp.
wire_version=2

usage() {
  cat <<'HELP'
fleet-keys.sh [OPTION]... COMMAND [ROLE NAME]

Makes what a fleet's programs need for DDS Security, with OpenSSL's command line:

  ca               the fleet's certificate authority (CA), its rules for the domain (governance), and
                   an empty revocation list; once for a fleet
  robot NAME       a folder with the key, certificate and signed permissions of a robot; NAME is its
                   --robot-id
  localizer NAME   of a localizer; NAME is its --name
  monitor NAME     of somebody who watches the fleet with fleetloc-monitor; may read only
  observer NAME    of somebody who looks at any topic with fleetloc-topic; may read only
  renew ROLE NAME  a new key, certificate and permissions under the same name
  renew            the same for all that end within --within days
  revoke ROLE NAME takes a member's certificates back: all of that name so far. Copy the new
                   revoked.pem, which is put into every folder, to all computers
  list             all members, with the days that are left
  check            verifies every file: signatures, names, modes, and says what ends within --within
                   days. Exit 1 if anything is wrong or ends

Folders are DIR/ROLEs/NAME, to be copied to that member's computer and nowhere else; DIR/ca stays
where it is, best on a computer that is not in the network. A program takes its folder with
--security FOLDER.

Options:
  -d, --dir DIR    the fleet's folder; ./fleet-keys if nothing is said
  --fleet NAME     with `ca`: the fleet's name, in all certificates; `fleet` if nothing is said
  --days N         how long a certificate is good for: 3650 for the CA and 397 for members
  --within N       days ahead that `check` and `renew` look; 30
  -h, --help

Exit 0: done. 1: it could not be done, or `check` found something. 2: wrong words.
HELP
}

fail() {
  echo "fleet-keys: $1" >&2
  exit "${2:-1}"
}

wrong_words() {
  fail "$1; see --help" 2
}

dir=./fleet-keys
fleet=fleet
days=""
within=30
command=""
role=""
name=""
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help)
      usage
      exit 0
      ;;
    -d | --dir | --fleet | --days | --within)
      [ $# -ge 2 ] || wrong_words "$1 needs a value"
      case $1 in
        -d | --dir) dir=$2 ;;
        --fleet) fleet=$2 ;;
        --days) days=$2 ;;
        --within) within=$2 ;;
      esac
      shift 2
      ;;
    -*) wrong_words "there is no option $1" ;;
    *)
      if [ -z "$command" ]; then
        command=$1
      elif [ -z "$role" ]; then
        role=$1
      elif [ -z "$name" ]; then
        name=$1
      else
        wrong_words "'$1' is too much"
      fi
      shift
      ;;
  esac
done

is_name() {
  case $1 in
    "" | *[!A-Za-z0-9_-]*) return 1 ;;
  esac
  [ ${#1} -le 32 ]
}

is_days() {
  case $1 in
    "" | 0* | *[!0-9]*) return 1 ;;
  esac
  [ ${#1} -le 5 ]
}

is_name "$fleet" || wrong_words "--fleet: '$fleet' is not 1 to 32 of A-Z a-z 0-9 _ -"
[ -z "$days" ] || is_days "$days" || wrong_words "--days: '$days' is not 1 to 99999"
is_days "$within" || wrong_words "--within: '$within' is not 1 to 99999"
command -v openssl >/dev/null || fail "there is no program 'openssl': apt-get install openssl"

ca=$dir/ca
roles="robot localizer monitor observer"

# OpenSSL's words only if it fails.
quietly() {
  said=$("$@" 2>&1) || fail "$1 $2 failed: $(printf '%s' "$said" | head -n 3 | tr '\n' ' ')"
}

needs_ca() {
  [ -f "$ca/key.pem" ] || fail "$ca/key.pem: no such file; make the CA with: fleet-keys.sh --dir $dir ca"
  write_ca_config  # with the paths of this call
}

# check_member ROLE NAME
check_member() {
  case " $roles " in
    *" $1 "*) ;;
    *) wrong_words "'$1' is none of: $roles" ;;
  esac
  [ -n "$2" ] || wrong_words "$1 needs a name"
  is_name "$2" || wrong_words "'$2' is not 1 to 32 of A-Z a-z 0-9 _ -"
}

folder_of() {
  echo "$dir/${1}s/$2"
}

fleet_name() {
  openssl x509 -in "$ca/certificate.pem" -noout -subject -nameopt RFC2253 |
    sed -n 's/.*O=\([^,]*\).*/\1/p'
}

# In S/MIME, as DDS Security asks for. Without signed attributes, which nobody reads, it is 300 bytes
# shorter, and permissions are sent in each handshake.
sign() {
  quietly openssl smime -sign -text -noattr -in "$1" -out "$2.new" -signer "$ca/certificate.pem" \
    -inkey "$ca/key.pem"
  mv "$2.new" "$2"
}

write_ca_config() {
  cat >"$ca/openssl.cnf" <<CONFIG
[ca]
default_ca = fleet
[fleet]
database = $ca/issued.txt
serial = $ca/serial
crlnumber = $ca/crl_number
new_certs_dir = $ca/issued
certificate = $ca/certificate.pem
private_key = $ca/key.pem
default_md = sha256
unique_subject = no
policy = names
x509_extensions = member
[names]
organizationName = supplied
organizationalUnitName = supplied
commonName = supplied
[member]
basicConstraints = critical,CA:FALSE
CONFIG
}

write_governance() {
  cat >"$ca/governance.xml" <<'XML'
<?xml version="1.0" encoding="UTF-8"?>
<dds>
<domain_access_rules><domain_rule>
<domains><id_range><min>0</min><max>100</max></id_range></domains>
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>NONE</rtps_protection_kind>
<topic_access_rules><topic_rule>
<topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>ENCRYPT</metadata_protection_kind>
<data_protection_kind>ENCRYPT</data_protection_kind>
</topic_rule></topic_access_rules>
</domain_rule></domain_access_rules>
</dds>
XML
  sign "$ca/governance.xml" "$ca/governance.smime"
}

make_ca() {
  [ ! -e "$ca/key.pem" ] || fail "$ca/key.pem exists: a fleet has one CA; choose another --dir"
  mkdir -p "$ca/issued"
  : >"$ca/issued.txt"
  echo 01 >"$ca/crl_number"
  write_ca_config
  quietly openssl ecparam -name prime256v1 -genkey -noout -out "$ca/key.new"
  quietly openssl pkcs8 -topk8 -nocrypt -in "$ca/key.new" -out "$ca/key.pem"
  rm -f "$ca/key.new"
  quietly openssl req -x509 -new -key "$ca/key.pem" -sha256 -days "${days:-3650}" \
    -subj "/O=$fleet/CN=CA" -out "$ca/certificate.pem" -addext keyUsage=critical,keyCertSign,cRLSign,digitalSignature
  write_governance
  write_revoked
  echo "fleet-keys: made the CA of '$fleet' in $ca; keep that folder to yourself"
}

# A list that has ended would keep everybody out: it is good for as long as the CA.
write_revoked() {
  quietly openssl ca -config "$ca/openssl.cnf" -gencrl -crldays 3650 -out "$ca/revoked.pem"
  for member in "$dir"/*s/*/certificate.pem; do
    [ -f "$member" ] || continue
    cp "$ca/revoked.pem" "${member%/*}/revoked.pem"
  done
}

topics() {
  for topic in "$@"; do
    case $topic in
      fleetloc/*) echo "<topic>$topic</topic>" ;;
      *) echo "<topic>fleetloc/$wire_version/$topic</topic>" ;;
    esac
  done
}

# What each end writes and reads: shared/transport/topics.cpp, dds_connection.cpp. A topic's name
# has its receiver: a robot writes to any localizer, and reads what is for itself.
rules() {
  case $1 in
    robot)
      echo "<publish><topics>"
      topics "*/session" "*/submap" "*/full_submap" "*/robot_status"
      echo "</topics></publish>"
      echo "<subscribe><topics>"
      topics "$2/localization" localizers fleetloc/versions
      echo "</topics></subscribe>"
      ;;
    localizer)
      echo "<publish><topics>"
      topics "*/localization" localizers "monitor/robots" "monitor/localizers" fleetloc/versions
      echo "</topics></publish>"
      echo "<subscribe><topics>"
      topics "$2/session" "$2/submap" "$2/full_submap" "$2/robot_status"
      echo "</topics></subscribe>"
      ;;
    monitor)
      echo "<subscribe><topics>"
      topics "monitor/robots" "monitor/localizers"
      echo "</topics></subscribe>"
      ;;
    observer)
      echo "<subscribe><topics>"
      topics "fleetloc/*"
      echo "</topics></subscribe>"
      ;;
  esac
}

# A date of a certificate, as DDS Security writes it (UTC).
validity() {
  date -u -d "$(openssl x509 -in "$1" -noout "-$2" | cut -d= -f2)" +%Y-%m-%dT%H:%M:%S
}

write_permissions() {
  member=$(folder_of "$1" "$2")
  cat >"$member/permissions.xml" <<XML
<?xml version="1.0" encoding="UTF-8"?>
<dds>
<permissions><grant name="$1">
<subject_name>CN=$2,OU=$1,O=$(fleet_name)</subject_name>
<validity><not_before>$(validity "$member/certificate.pem" startdate)</not_before><not_after>$(validity "$member/certificate.pem" enddate)</not_after></validity>
<allow_rule>
<domains><id_range><min>0</min><max>100</max></id_range></domains>
$(rules "$1" "$2")
</allow_rule>
<default>DENY</default>
</grant></permissions>
</dds>
XML
  sign "$member/permissions.xml" "$member/permissions.smime"
  rm -f "$member/permissions.xml"
}

# issue ROLE NAME: into its folder, at last the key and certificate together.
issue() {
  member=$(folder_of "$1" "$2")
  mkdir -p "$member"
  quietly openssl ecparam -name prime256v1 -genkey -noout -out "$member/key.raw"
  quietly openssl pkcs8 -topk8 -nocrypt -in "$member/key.raw" -out "$member/key.new"
  rm -f "$member/key.raw"
  quietly openssl req -new -key "$member/key.new" -sha256 -subj "/O=$(fleet_name)/OU=$1/CN=$2" \
    -out "$member/request.pem"
  # Random serial numbers need no file that two runs would share.
  quietly openssl ca -config "$ca/openssl.cnf" -batch -notext -rand_serial -days "${days:-397}" \
    -in "$member/request.pem" -out "$member/certificate.new"
  rm -f "$member/request.pem"
  mv "$member/key.new" "$member/key.pem"
  mv "$member/certificate.new" "$member/certificate.pem"
  cp "$ca/certificate.pem" "$member/ca.pem"
  cp "$ca/governance.smime" "$ca/revoked.pem" "$member/"
  write_permissions "$1" "$2"
}

make_member() {
  check_member "$1" "$2"
  needs_ca
  member=$(folder_of "$1" "$2")
  [ ! -e "$member/key.pem" ] || fail "$member exists; a new key for it: fleet-keys.sh --dir $dir renew $1 $2"
  issue "$1" "$2"
  echo "fleet-keys: made $member"
}

# for_each_member FUNCTION: calls it with role and name.
for_each_member() {
  for one_role in $roles; do
    members=$dir/${one_role}s
    [ ! -d "$members" ] || { [ -r "$members" ] && [ -x "$members" ]; } ||
      fail "$members: not readable by $(id -un); whose is it?"
    for one in "$members"/*; do
      [ -d "$one" ] || continue
      "$1" "$one_role" "${one##*/}"
    done
  done
}

seconds_left() {
  echo $(($(date -u -d "$(openssl x509 -in "$1" -noout -enddate | cut -d= -f2)" +%s) - $(date +%s)))
}

serial_of() {
  openssl x509 -in "$1" -noout -serial | cut -d= -f2
}

is_revoked() {
  openssl crl -in "$ca/revoked.pem" -noout -text | grep -qi "Serial Number: *$(serial_of "$1")"
}

renew_if_needed() {
  certificate=$(folder_of "$1" "$2")/certificate.pem
  [ "$(seconds_left "$certificate")" -lt $((within * 86400)) ] || return 0
  is_revoked "$certificate" && return 0
  issue "$1" "$2"
  echo "fleet-keys: renewed $(folder_of "$1" "$2")"
}

renew() {
  needs_ca
  if [ -z "$role" ]; then
    for_each_member renew_if_needed
    return
  fi
  check_member "$role" "$name"
  member=$(folder_of "$role" "$name")
  [ -e "$member/certificate.pem" ] || fail "$member/certificate.pem: no such file; nothing to renew"
  issue "$role" "$name"
  echo "fleet-keys: renewed $member"
}

# Also those that were renewed: their keys are out there.
revoke() {
  check_member "$role" "$name"
  needs_ca
  subject="/O=$(fleet_name)/OU=$role/CN=$name"
  serials=$(awk -F '\t' -v subject="$subject" '$1 == "V" && $6 == subject { print $4 }' "$ca/issued.txt")
  [ -n "$serials" ] || fail "no certificate of $role $name is good: nothing to revoke"
  for serial in $serials; do
    quietly openssl ca -config "$ca/openssl.cnf" -revoke "$ca/issued/$serial.pem"
  done
  write_revoked
  echo "fleet-keys: revoked $role $name; copy revoked.pem to every computer and restart its program"
}

list_member() {
  certificate=$(folder_of "$1" "$2")/certificate.pem
  [ -f "$certificate" ] || return 0
  state=$(($(seconds_left "$certificate") / 86400))" days"
  is_revoked "$certificate" && state=revoked
  printf '%-10s %-32s %s\n' "$1" "$2" "$state"
}

problem() {
  echo "fleet-keys: $1"
  problems=$((problems + 1))
}

# OpenSSL's reasons in one line.
verifies() {
  what=$1
  shift
  said=$("$@" 2>&1) || problem "$what: $(printf '%s' "$said" | grep -i error | head -n 1)"
}

check_end() {
  left=$(seconds_left "$1")
  if [ "$left" -lt 0 ]; then
    problem "$1: has ended"
  elif [ "$left" -lt $((within * 86400)) ]; then
    problem "$1: ends in $((left / 86400)) days"
  fi
}

check_modes() {
  open=$(find "$1" -type f -perm /077 | head -n 1)
  [ -z "$open" ] || problem "$open: others can read it; chmod 600 $open"
}

check_files() {
  member=$(folder_of "$1" "$2")
  for file in key.pem certificate.pem ca.pem permissions.smime governance.smime revoked.pem; do
    [ -f "$member/$file" ] || {
      problem "$member/$file: no such file"
      return 0
    }
  done
  check_modes "$member"
  if is_revoked "$member/certificate.pem"; then
    echo "fleet-keys: $member: is revoked"
    return 0
  fi
  verifies "$member/certificate.pem" openssl verify -crl_check -CAfile "$ca/certificate.pem" \
    -CRLfile "$member/revoked.pem" "$member/certificate.pem"
  check_end "$member/certificate.pem"
  [ "$(openssl x509 -in "$member/certificate.pem" -noout -pubkey)" = \
    "$(openssl pkey -in "$member/key.pem" -pubout)" ] ||
    problem "$member/key.pem: is not the key of certificate.pem"
  cmp -s "$ca/revoked.pem" "$member/revoked.pem" || problem "$member/revoked.pem: is not the CA's newest"
  for file in permissions.smime governance.smime; do
    verifies "$member/$file" openssl smime -verify -text -CAfile "$ca/certificate.pem" \
      -in "$member/$file" -out /dev/null
  done
  subject=$(openssl x509 -in "$member/certificate.pem" -noout -subject -nameopt RFC2253)
  grep -q "<subject_name>${subject#subject=}</subject_name>" "$member/permissions.smime" ||
    problem "$member/permissions.smime: is not for ${subject#subject=}"
}

check() {
  needs_ca
  problems=0
  check_modes "$ca"
  check_end "$ca/certificate.pem"
  for_each_member check_files
  [ "$problems" = 0 ] || exit 1
  echo "fleet-keys: all is well, and nothing ends within $within days"
}

case $command in
  "") wrong_words "a command is needed" ;;
  ca)
    [ -z "$role" ] || wrong_words "'$role' is too much"
    make_ca
    ;;
  robot | localizer | monitor | observer)
    [ -z "$name" ] || wrong_words "'$name' is too much"
    make_member "$command" "$role"
    ;;
  renew) renew ;;
  revoke) revoke ;;
  list)
    needs_ca
    for_each_member list_member
    ;;
  check) check ;;
  *) wrong_words "there is no command '$command'" ;;
esac
