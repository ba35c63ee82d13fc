# awk -v mode=PRESET -f summary.awk GROUPS RESULTS
# What ran and what did not, and why, of CTest's results in JUnit's form. GROUPS has a line "group
# test" for each test. Fails if a group was skipped as a whole, unless there is no Docker daemon, a
# privilege is missing, or sanitizers are too slow for it.

function plain(text) {
  gsub(/&lt;/, "<", text)
  gsub(/&gt;/, ">", text)
  gsub(/&quot;/, "\"", text)
  gsub(/&apos;/, "'", text)
  gsub(/&amp;/, "\\&", text)
  return text
}

function is_excused(reason) {
  return reason ~ /Docker daemon/ || reason ~ /[Nn]ot permitted|[Pp]ermission denied/ ||
    (mode != "release" && reason ~ /sanitizers/)
}

FNR == NR {
  group = $1
  sub(/^[^ ]+ /, "")
  group_of[$0] = group
  next
}

/^[ \t]*<testcase / {
  name = $0
  sub(/^[ \t]*<testcase name="/, "", name)
  sub(/".*/, "", name)
  group = plain(name) in group_of ? group_of[plain(name)] : "other"
  if (!(group in seen)) {
    seen[group] = 1
    order[++groups] = group
  }
  status = $0
  sub(/.* status="/, "", status)
  sub(/".*/, "", status)
  is_skipped = 0
  reason = ""
  takes_reason = 0
}

/<skipped message="SKIP_/ { is_skipped = 1 }
/<skipped message="Disabled"/ { reason = "disabled" }

# GoogleTest: FILE:LINE: Skipped, and in the next lines why.
/^[^ ]+:[0-9]+: Skipped$/ {
  takes_reason = 1
  next
}
# Others: NAME: skipped: why.
/^([ \t]*<system-out>)?[^ ]+: skipped: / {
  reason = plain($0)
  sub(/^.*: skipped: /, "", reason)
  sub(/<\/system-out>$/, "", reason)
}
takes_reason && (/^$/ || /^\[/ || /</) { takes_reason = 0 }
takes_reason { reason = reason (reason == "" ? "" : " ") plain($0) }

/<\/testcase>/ {
  if (is_skipped || reason == "disabled") {
    if (reason == "") reason = "no reason given"
    ++skipped[group]
    ++all_skipped
    if (!((group, reason) in times)) why[++whys] = group SUBSEP reason
    ++times[group, reason]
  } else {
    ++ran[group]
    ++all_ran
    if (status == "run") ++passed[group]
  }
}

END {
  printf "%-10s %6s %7s %8s\n", "group", "ran", "passed", "skipped"
  for (i = 1; i <= groups; ++i) {
    group = order[i]
    printf "%-10s %6d %7d %8d\n", group, ran[group], passed[group], skipped[group]
  }
  for (i = 1; i <= whys; ++i) {
    split(why[i], part, SUBSEP)
    printf "skipped    %d of %s: %s\n", times[part[1], part[2]], part[1], part[2]
    if (!is_excused(part[2])) unexcused[part[1]] = 1
    reasons[part[1]] = reasons[part[1]] (reasons[part[1]] == "" ? "" : "; ") part[2]
  }
  status = all_ran + all_skipped > 0 ? 0 : 1
  for (i = 1; i <= groups; ++i) {
    group = order[i]
    if (ran[group] > 0) continue
    if (group in unexcused) {
      printf "test/run.sh: FAILED: every test of the group %s was skipped\n", group
      status = 1
    } else {
      printf "test/run.sh: the group %s cannot run here: %s\n", group, reasons[group]
    }
  }
  printf "test/run.sh: %d ran, %d skipped\n", all_ran, all_skipped
  exit status
}
