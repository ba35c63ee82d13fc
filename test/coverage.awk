# awk -F, -f coverage.awk COVERAGE.csv
# Of gcovr's table: the share of the lines that ran, and the ten files with the smallest.
FNR == 1 {
  for (i = 1; i <= NF; ++i) column[$i] = i
  next
}

$column["line_total"] > 0 {
  file[++files] = $column["filename"]
  total[files] = $column["line_total"]
  covered[files] = $column["line_covered"]
  all_total += total[files]
  all_covered += covered[files]
}

END {
  if (files == 0) {
    print "test/run.sh: FAILED: no line was counted"
    exit 1
  }
  printf "coverage: %.1f %% of %d lines in %d files; the least:\n",
    100 * all_covered / all_total, all_total, files
  for (n = 1; n <= 10 && n <= files; ++n) {
    least = 0
    for (i = 1; i <= files; ++i) {
      if (i in told) continue
      if (!least || covered[i] / total[i] < covered[least] / total[least]) least = i
    }
    told[least] = 1
    printf "%6.1f %%  %4d of %4d  %s\n", 100 * covered[least] / total[least], covered[least],
      total[least], file[least]
  }
}
