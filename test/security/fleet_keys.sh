#!/bin/sh
# fleet_keys.sh: what deploy/security/fleet-keys.sh makes is what OpenSSL and DDS Security take, is
# for one member only, and is readable by nobody else. Each expectation names itself when it fails.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fleet=$scratch/fleet
umask 022  # the tool itself has to see to it that nothing is readable

# shellcheck source=test/expect.sh
. "$root/test/expect.sh"
keys() { "$root/deploy/security/fleet-keys.sh" --dir "$fleet" "$@"; }
# says CODE TEXT WORDS...: the tool ends with that code and says that.
says() {
  code=$1
  text=$2
  shift 2
  set +e
  said=$(keys "$@" 2>&1)
  ended=$?
  set -e
  [ "$ended" = "$code" ] && printf '%s\n' "$said" | grep -q -- "$text" && return 0
  printf 'it ended with %s and said: %s\n' "$ended" "$said" >&2
  return 1
}
topics_of() { # of a kind of permission: publish or subscribe
  sed -n "/<$2>/,/<\/$2>/s/.*<topic>\(.*\)<\/topic>.*/\1/p" "$1/permissions.smime"
}

expect "members need a CA" says 1 "make the CA" robot robot_7
keys ca --fleet campus >"$scratch/said" 2>&1
keys robot robot_7 >>"$scratch/said" 2>&1
expect "no key is printed" not grep -q -e PRIVATE -e "$(sed -n 2p "$fleet/ca/key.pem")" "$scratch/said"
keys localizer localizer_1 >/dev/null
keys monitor screen >/dev/null
keys observer laptop >/dev/null
robot=$fleet/robots/robot_7
localizer=$fleet/localizers/localizer_1

for member in "$robot" "$localizer" "$fleet/monitors/screen" "$fleet/observers/laptop"; do
  expect "certificate of $member" openssl verify -crl_check -CAfile "$member/ca.pem" \
    -CRLfile "$member/revoked.pem" "$member/certificate.pem" >/dev/null
  for signed in permissions governance; do
    expect "$signed of $member are signed" openssl smime -verify -text -CAfile "$member/ca.pem" \
      -in "$member/$signed.smime" -out /dev/null 2>/dev/null
  done
done
sed 's/robot_7/robot_8/' "$robot/permissions.smime" >"$scratch/forged"
expect "changed permissions are refused" not openssl smime -verify -text -CAfile "$robot/ca.pem" \
  -in "$scratch/forged" -out /dev/null 2>/dev/null
expect "the subject is in RFC 2253 order" grep -q \
  "<subject_name>CN=robot_7,OU=robot,O=campus</subject_name>" "$robot/permissions.smime"

for kind in discovery liveliness metadata data; do
  expect "$kind is protected" grep -q "<${kind}_protection_kind>\(SIGN\|ENCRYPT\)" "$robot/governance.smime"
done
expect "strangers are kept out" grep -q \
  "<allow_unauthenticated_participants>false" "$robot/governance.smime"

version=$(sed -n 's/.*kWireVersion = \([0-9]*\);/\1/p' "$root/shared/transport/topics.hpp")
t=fleetloc/$version
expect "a robot reads its own answers and what is for all" test "$(topics_of "$robot" subscribe | xargs)" = \
  "$t/robot_7/localization $t/localizers fleetloc/versions"
expect "a robot writes to localizers" test "$(topics_of "$robot" publish | xargs)" = \
  "$t/*/session $t/*/submap $t/*/full_submap $t/*/robot_status"
expect "a localizer reads what is sent to itself" test "$(topics_of "$localizer" subscribe | xargs)" = \
  "$t/localizer_1/session $t/localizer_1/submap $t/localizer_1/full_submap $t/localizer_1/robot_status"
expect "a localizer writes answers and its status" test "$(topics_of "$localizer" publish | xargs)" = \
  "$t/*/localization $t/localizers $t/monitor/robots $t/monitor/localizers fleetloc/versions"
for reader in monitors/screen observers/laptop; do
  expect "$reader writes nothing" test -z "$(topics_of "$fleet/$reader" publish)"
done
expect "all else is denied" grep -q "<default>DENY</default>" "$robot/permissions.smime"

expect "files are their owner's only" test -z "$(find "$fleet" -type f -not -perm 600)"
expect "folders are their owner's only" test -z "$(find "$fleet" -type d -not -perm 700)"
expect "a member has nothing of the CA's key" not grep -rqF \
  "$(sed -n 2p "$fleet/ca/key.pem")" "$fleet/robots" "$fleet/localizers"
expect "check is content" says 0 "all is well" check
chmod 640 "$robot/key.pem"
expect "check sees a key that others can read" says 1 "others can read it" check
chmod 600 "$robot/key.pem"
mv "$robot/key.pem" "$scratch/key"
cp "$localizer/key.pem" "$robot/key.pem"
chmod 600 "$robot/key.pem"
expect "check sees a key of another certificate" says 1 "is not the key" check
mv "$scratch/key" "$robot/key.pem"

keys robot robot_9 --days 20 >/dev/null
expect "the end is said 30 days ahead" says 1 "robot_9/certificate.pem: ends in \(19\|20\) days" check
expect "not earlier than asked for" says 0 "all is well" check --within 10
before=$(cat "$fleet/robots/robot_9/certificate.pem")
kept=$(cat "$robot/certificate.pem")
keys renew >/dev/null
expect "what ends is renewed" test "$before" != "$(cat "$fleet/robots/robot_9/certificate.pem")"
expect "what does not end is left" test "$kept" = "$(cat "$robot/certificate.pem")"
expect "nothing ends any more" says 0 "all is well" check

printf '%s\n' "$before" >"$scratch/before.pem"
keys revoke robot robot_9 >/dev/null
for certificate in "$scratch/before.pem" "$fleet/robots/robot_9/certificate.pem"; do
  expect "revoked, also from before the renewal" not openssl verify -crl_check \
    -CAfile "$localizer/ca.pem" -CRLfile "$localizer/revoked.pem" "$certificate" >/dev/null 2>&1
done
expect "others are not" openssl verify -crl_check -CAfile "$localizer/ca.pem" \
  -CRLfile "$localizer/revoked.pem" "$robot/certificate.pem" >/dev/null
expect "list shows it" says 0 "robot_9  *revoked" list
cp "$localizer/revoked.pem" "$scratch/newest"
sed -i 2d "$localizer/revoked.pem"
expect "check sees an old list" says 1 "localizer_1/revoked.pem: is not the CA's newest" check
cp "$scratch/newest" "$localizer/revoked.pem"
expect "there is nothing to revoke twice" says 1 "nothing to revoke" revoke robot robot_9
keys renew robot robot_9 >/dev/null
expect "a new certificate brings it back" says 0 "robot_9  *39[67] days" list

expect "a member is not overwritten" says 1 "exists" robot robot_7
expect "nor the CA" says 1 "exists" ca
expect "a name is checked" says 2 "is not 1 to 32" robot "../robot"
expect "a role is checked" says 2 "is none of" revoke drone robot_7
expect "a command is checked" says 2 "no command" make
expect "days are checked" says 2 "is not 1 to 99999" robot robot_10 --days 0
expect "help is there" says 0 "observer NAME" --help

[ "$failures" = 0 ] || exit 1
echo "fleet_keys: all as expected"
