# awk -v east=N -v west=N -f robots.awk compose.yml
# The compose file with a service for each robot and its drivers: those of the first robot of each
# site, and copies of them in which its number, behind the name of the site, is another.
function repeat(   number, copy) {
  for (number = 2; number <= count; ++number) {
    copy = service
    gsub(site "_1", site "_" number, copy)
    printf "%s", copy
  }
  count = 0
  service = ""
}
/^( ? ?[^ ]|$)/ { repeat() }
/^  (robot|drivers)_east_1:/ { site = "east"; count = east }
/^  (robot|drivers)_west_1:/ { site = "west"; count = west }
count { service = service $0 "\n" }
{ print }
END { repeat() }
