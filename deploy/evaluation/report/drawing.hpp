#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fleetloc {

// Colours for people with any kind of colour vision (Okabe and Ito 2008).
namespace colour {
inline constexpr const char* kBlue = "#0072B2";
inline constexpr const char* kVermillion = "#D55E00";
inline constexpr const char* kGreen = "#009E73";
inline constexpr const char* kOrange = "#E69F00";
inline constexpr const char* kPurple = "#CC79A7";
inline constexpr const char* kSky = "#56B4E9";
inline constexpr const char* kBlack = "#000000";
inline constexpr const char* kGrey = "#999999";
}  // namespace colour

inline constexpr int kWidth_px = 480;  ///< of every drawing; a browser scales it

/// A drawing by gnuplot: data blocks and commands.
class Drawing {
 public:
  /// @param id     starts with a letter; unique in a page
  /// @param title  for screen readers
  Drawing(std::string id, std::string title, int height_px);

  /// Makes `$name` of columns of numbers; an empty row interrupts a line. At least one row.
  void data(const std::string& name, const std::vector<std::vector<double>>& rows);
  void command(const std::string& text) { script_ += text + "\n"; }

  /// An <svg> element for a page. Throws std::runtime_error, see gnuplot_output().
  [[nodiscard]] std::string svg() const;

 private:
  std::string id_;
  std::string title_;
  std::string script_;
};

/// Seconds and a value.
using Series = std::vector<std::pair<double, double>>;

/// At most `max` points: of each of so many equal intervals of time, that of the largest |value|,
/// so that peaks stay.
Series thinned(const Series& series, std::size_t max);

/// Text in quotes, and a number of six digits, as gnuplot reads them.
std::string plot_string(std::string_view text);
std::string plot_number(double value);

/// What gnuplot's `set xtics`, `set ytics` take: few steps of 1, 2 or 5.
double tic_step(double range, int max);

/// The next of ..., 0.1, 0.2, 0.5, 1, 2, 5, ... that is not above the value, which is positive.
double rounded_down(double value);
/// The same, not below the value.
double rounded_up(double value);

/// Tics of a logarithmic axis: `"0.01" 0.01, "0.02" 0.02, ...`, all of 1, 2, 5 in the range.
std::string log_tics(double min, double max);

}  // namespace fleetloc
