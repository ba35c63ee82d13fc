#!/bin/sh
# What summary.awk, and with it test/run.sh, makes of groups that were skipped.
set -eu

summary=$(dirname "$0")/summary.awk
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
printf 'unit Unit.One\nunit Unit.Two\nfleet Fleet.One\n' >"$scratch/groups"

# expect STATUS TEXT MODE REASON: of Fleet.One, skipped for that reason, and Unit.Two for another
expect() {
  cat >"$scratch/results.xml" <<EOF
<testsuite name="all">
	<testcase name="Unit.One" classname="Unit.One" time="1" status="run">
		<system-out>1 test</system-out>
	</testcase>
	<testcase name="Unit.Two" classname="Unit.Two" time="0" status="notrun">
		<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
		<system-out>two: skipped: there is no recording
</system-out>
	</testcase>
	<testcase name="Fleet.One" classname="Fleet.One" time="0" status="notrun">
		<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
		<system-out>fleet.cpp:7: Skipped
$4

</system-out>
	</testcase>
</testsuite>
EOF
  status=0
  awk -v mode="$3" -f "$summary" "$scratch/groups" "$scratch/results.xml" >"$scratch/said" ||
    status=$?
  if [ "$status" -ne "$1" ] || ! grep -qF "$2" "$scratch/said"; then
    echo "with '$4' in $3: status $status" >&2
    cat "$scratch/said" >&2
    exit 1
  fi
}

expect 1 "FAILED: every test of the group fleet was skipped" release "there is no recording"
expect 0 "the group fleet cannot run here: there is no Docker daemon" release \
  "there is no Docker daemon"
expect 0 "the group fleet cannot run here" release "unshare: Operation not permitted"
expect 0 "the group fleet cannot run here" asan "too slow with sanitizers"
expect 1 "FAILED: every test of the group fleet was skipped" release "too slow with sanitizers"
expect 0 "1 ran, 2 skipped" release "there is no Docker daemon"
