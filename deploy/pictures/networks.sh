#!/bin/sh
# networks.sh LOSS LATENCY BANDWIDTH
# Draws networks.png of this folder: how well robots are localized on poor networks, from the
# results.csv of the plans loss, latency and bandwidth (deploy/experiments). Medians over the seeds
# of the configuration `default`; the error relative to that over the ideal link of the same plan.
# Needs the packages gnuplot-nox, librsvg2-bin and pngquant.
set -eu

fail() {
  echo "networks.sh: $1" >&2
  exit 2
}
[ $# -eq 3 ] || fail "usage: networks.sh LOSS/results.csv LATENCY/results.csv BANDWIDTH/results.csv"
here=$(cd "$(dirname "$0")" && pwd)
for file in "$@"; do [ -f "$file" ] || fail "$file: no such file"; done
for tool in gnuplot rsvg-convert pngquant; do
  command -v "$tool" >/dev/null || fail "there is no $tool"
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# DATASET AXIS(column) PATTERN(of links): value, share covered, relative error, bytes up, bytes down
table() {  # CSV DATASET AXIS PATTERN
  awk -F, -v dataset="$2" -v axis="$3" -v pattern="$4" '
    function median(list, n, i, j, t) {
      for (i = 2; i <= n; ++i)
        for (j = i; j > 1 && list[j - 1] > list[j]; --j) { t = list[j]; list[j] = list[j - 1]; list[j - 1] = t }
      return n % 2 ? list[(n + 1) / 2] : (list[n / 2] + list[n / 2 + 1]) / 2
    }
    function of(name, link, i, list) {
      for (i = 1; i <= count[link]; ++i) list[i] = value[link, i, name]
      return median(list, count[link])
    }
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    $column["dataset"] != dataset || $column["configuration"] != "default" { next }
    $column["exit_status"] != 0 { next }
    {
      link = $column["link"]
      if (!(link in count)) links[++n] = link
      k = ++count[link]
      at[link] = $column[axis]
      value[link, k, "covered"] = $column["covered"]
      value[link, k, "error"] = $column["ate_median_m"]
      value[link, k, "up"] = $column["uplink_wire_bytes"] / $column["duration_s"]
      value[link, k, "down"] = $column["downlink_wire_bytes"] / $column["duration_s"]
    }
    END {
      for (i = 1; i <= n; ++i)
        if (links[i] ~ pattern)
          print at[links[i]], of("covered", links[i]), of("error", links[i]) / of("error", "ideal"),
            of("up", links[i]), of("down", links[i])
    }' "$1" | sort -g
}
for season in autumn winter; do
  table "$1" $season loss_up '^(ideal|loss)' >"$scratch/loss.$season"
  table "$2" $season latency_up_s '^(ideal|s_[0-9_]+)$' >"$scratch/latency.$season"
  table "$3" $season bandwidth_up_bytes_per_s '^kB' >"$scratch/bandwidth.$season"
done
cd "$scratch"
gnuplot <<'PLOT'
set terminal svg size 1100,620 font "sans,13"
set output "networks.svg"
set multiplot layout 2,3 margins 0.08,0.985,0.1,0.96 spacing 0.06,0.12
set style line 1 lc rgb "#b5651d" lw 2 pt 7 ps 0.6
set style line 2 lc rgb "#2b6ca3" lw 2 pt 5 ps 0.6
set grid
set key bottom left
set yrange [0:1.05]
set ylabel "share covered"
plot "loss.autumn" using 1:2 with linespoints ls 1 title "autumn", \
     "loss.winter" using 1:2 with linespoints ls 2 title "winter"
unset ylabel
set nokey
plot "latency.autumn" using 1:2 with linespoints ls 1, "latency.winter" using 1:2 with linespoints ls 2
set logscale x
set xtics (1, 2, 4, 8, 250)
plot "bandwidth.autumn" using ($1/1000):2 with linespoints ls 1, \
     "bandwidth.winter" using ($1/1000):2 with linespoints ls 2
unset logscale x
set xtics auto
set yrange [0.5:8]
set logscale y
set ytics (0.5, 1, 2, 4, 8)
set ylabel "median error / that over the ideal link"
set xlabel "loss of datagrams, each way"
plot "loss.autumn" using 1:3 with linespoints ls 1, "loss.winter" using 1:3 with linespoints ls 2
unset ylabel
set xlabel "latency, each way [s]"
plot "latency.autumn" using 1:3 with linespoints ls 1, "latency.winter" using 1:3 with linespoints ls 2
set xlabel "rate, each way [KB/s]"
set logscale x
set xtics (1, 2, 4, 8, 250)
plot "bandwidth.autumn" using ($1/1000):3 with linespoints ls 1, \
     "bandwidth.winter" using ($1/1000):3 with linespoints ls 2
PLOT
rsvg-convert --background-color white --width 1100 --keep-aspect-ratio --output big.png networks.svg
pngquant --force --strip --output "$here/networks.png" 32 big.png
echo "$here/networks.png"
