#include "deploy/evaluation/report/drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "deploy/evaluation/report/gnuplot.hpp"
#include "deploy/evaluation/report/html.hpp"

namespace fleetloc {
namespace {

void replace_all(std::string& text, std::string_view from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

void erase_all(std::string& text, std::string_view begin, std::string_view end) {
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    text.erase(at, text.find(end, at) + end.size() - at);
  }
}

/// A document of gnuplot as an element of a page: without prologue, tooltips and the namespace of
/// links, which a browser does not need, and with ids of its own.
std::string inlined(std::string svg, const std::string& id, const std::string& title) {
  const std::size_t end = svg.find("</svg>");
  svg = svg.substr(svg.find("<svg"), end + 6 - svg.find("<svg")) + "\n";
  erase_all(svg, "<title>", "</title>");
  erase_all(svg, "<desc>", "</desc>");
  erase_all(svg, "<filter id='textbox'", "</filter>");
  erase_all(svg, "<filter id='greybox'", "</filter>");
  erase_all(svg, " xmlns:xlink=", "\n");
  replace_all(svg, "xlink:href='#", "href='#" + id + "-");
  replace_all(svg, " id='", " id='" + id + "-");
  replace_all(svg, R"( id=")", R"( id=")" + id + "-");
  replace_all(svg, "\n\n", "\n");
  svg.insert(4, R"( role="img" aria-label=")" + escaped(title) + '"');
  return svg;
}

std::string prelude(int height_px) {
  return "set terminal svg size " + std::to_string(kWidth_px) + "," + std::to_string(height_px) +
         " dynamic noenhanced font 'sans-serif,14' linewidth 1\n"
         "set encoding utf8\n"
         "set border linewidth 0.8 linecolor rgb '#666666'\n"
         "set tics scale 0.5 textcolor rgb '#222222'\n"
         "set grid linecolor rgb '#dddddd' linewidth 0.7 dashtype solid\n"
         "set key above left horizontal reverse Left samplen 1.8 width -1 maxrows 1\n"
         // Cividis (Nunez, Anderton and Renslow 2018)
         "set palette maxcolors 40 defined (0 '#00224e', 0.125 '#123570', 0.25 '#3b496c', "
         "0.375 '#575d6d', 0.5 '#707173', 0.625 '#8a8678', 0.75 '#a59c74', 0.875 '#c3b369', "
         "1 '#e1cc55')\n";
}

}  // namespace

Drawing::Drawing(std::string id, std::string title, int height_px)
    : id_(std::move(id)), title_(std::move(title)), script_(prelude(height_px)) {}

void Drawing::data(const std::string& name, const std::vector<std::vector<double>>& rows) {
  script_ += "$" + name + " << END\n";
  for (const auto& row : rows) {
    for (const double value : row) script_ += plot_number(value) + " ";
    script_ += "\n";
  }
  script_ += "END\n";
}

std::string Drawing::svg() const {
  return inlined(gnuplot_output(script_), id_, title_);
}

Series thinned(const Series& series, std::size_t max) {
  if (series.size() <= max) return series;
  const double begin = series.front().first;
  const double length = series.back().first - begin;
  Series kept;
  std::size_t interval = 0;
  for (const auto& point : series) {
    const double share = (point.first - begin) / length;
    const auto its = std::min(max - 1, static_cast<std::size_t>(share * static_cast<double>(max)));
    if (kept.empty() || its != interval) {
      kept.push_back(point);
    } else if (std::abs(point.second) > std::abs(kept.back().second)) {
      kept.back() = point;
    }
    interval = its;
  }
  return kept;
}

std::string plot_string(std::string_view text) {
  std::string words = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') words += '\\';
    words += c;
  }
  return words + "\"";
}

std::string plot_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

double tic_step(double range, int max) {
  const double min = range / max;
  const double decade = std::pow(10.0, std::floor(std::log10(min)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= min * (1.0 - 1e-9)) return factor * decade;
  }
  return 10.0 * decade;
}

double rounded_down(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {5.0, 2.0}) {
    if (value >= factor * decade) return factor * decade;
  }
  return decade;
}

double rounded_up(double value) {
  const double down = rounded_down(value);
  return down >= value ? down : rounded_down(2.51 * down);  // 2.51: from 2 to 5
}

std::string log_tics(double min, double max) {
  std::string tics;
  double value = rounded_up(0.99 * min);
  while (value <= 1.01 * max) {
    tics += (tics.empty() ? "" : ", ") + plot_string(plot_number(value)) + " " + plot_number(value);
    value = rounded_up(1.01 * value);
  }
  return tics;
}

}  // namespace fleetloc
