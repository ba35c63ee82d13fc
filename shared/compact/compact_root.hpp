#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// A positive semi-definite matrix in small integers, as R^T R with R upper triangular. What is
/// decoded is positive semi-definite, too, and the same bits on every machine. Entries of R are
/// truncated towards zero, by up to 1/127 of their scale: directions without information stay
/// nearly so.
template <int N>
struct CompactRoot {
  static constexpr std::size_t kScales = N / 3;
  static constexpr std::size_t kEntries = N * (N + 1) / 2;
  static constexpr int kMaxScale = 240;  // 1e9: 1 nrad, 1 nm
  static constexpr int kZero = 128;      // of an entry

  std::array<std::uint8_t, kScales> scales{};
  std::array<std::uint8_t, kEntries> entries{};

  /// Throws NotEncodable unless the matrix is finite, symmetric and positive semi-definite.
  static CompactRoot of(const Eigen::Matrix<double, N, N>& matrix);

  [[nodiscard]] Eigen::Matrix<double, N, N> squared() const;
  [[nodiscard]] Validity check() const;

 private:
  using Matrix = Eigen::Matrix<double, N, N>;
  static constexpr double kUnits = 127.0;
  static constexpr double kTolerance = 1e-9;

  // 2^(scale / 8), the same bits everywhere.
  [[nodiscard]] double scale(int column) const {
    constexpr std::array kEighths{1.0,
                                  1.0905077326652577,
                                  1.1892071150027210,
                                  1.2968395546510096,
                                  1.4142135623730951,
                                  1.5422108254079407,
                                  1.6817928305074290,
                                  1.8340080864093424};
    const int code = scales[static_cast<std::size_t>(column / 3)];
    return std::ldexp(kEighths[static_cast<std::size_t>(code % 8)], code / 8);
  }
  [[nodiscard]] Matrix unscaled() const;
};

template <int N>
CompactRoot<N> CompactRoot<N>::of(const Matrix& matrix) {
  if (!matrix.allFinite()) throw NotEncodable("an information that is not finite");
  if ((matrix.diagonal().array() < 0.0).any()) throw NotEncodable("a negative information");
  // Rotations and translations differ by orders of magnitude: the root is that of correlations.
  const Eigen::Matrix<double, N, 1> sizes =
      matrix.diagonal().cwiseSqrt().unaryExpr([](double s) { return s > 0.0 ? s : 1.0; });
  const Matrix correlation =
      sizes.cwiseInverse().asDiagonal() * matrix * sizes.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(0.5 * (correlation + correlation.transpose()));
  if ((correlation - correlation.transpose()).cwiseAbs().maxCoeff() > 1e-6 ||
      eigen.eigenvalues().minCoeff() < -1e-6) {
    throw NotEncodable("an information that is not positive semi-definite");
  }
  const Matrix root =
      eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
  const Matrix qr = root.householderQr().matrixQR();
  Matrix R = Matrix(qr.template triangularView<Eigen::Upper>()) * sizes.asDiagonal();
  // The sign of a row means nothing: with this one all samples are alike, and coded in less.
  for (int row = 0; row < N; ++row) {
    if (R(row, row) < 0.0) R.row(row) = -R.row(row);
  }

  CompactRoot out;
  for (int group = 0; group < N / 3; ++group) {
    const double longest = R.template middleCols<3>(3 * group).colwise().norm().maxCoeff();
    const double exponent = std::ceil(8.0 * std::log2(std::max(longest, 1.0)) - kTolerance);
    if (exponent > kMaxScale) throw NotEncodable("an information that is out of range");
    out.scales[static_cast<std::size_t>(group)] = static_cast<std::uint8_t>(exponent);
  }
  auto next = out.entries.begin();
  for (int row = 0; row < N; ++row) {
    for (int column = row; column < N; ++column) {
      const double units = std::trunc(kUnits * R(row, column) / out.scale(column));
      *next++ = static_cast<std::uint8_t>(kZero + static_cast<int>(units));
    }
  }
  return out;
}

template <int N>
typename CompactRoot<N>::Matrix CompactRoot<N>::unscaled() const {
  Matrix R = Matrix::Zero();
  auto next = entries.begin();
  for (int row = 0; row < N; ++row) {
    for (int column = row; column < N; ++column) R(row, column) = (*next++ - kZero) / kUnits;
  }
  return R;
}

template <int N>
typename CompactRoot<N>::Matrix CompactRoot<N>::squared() const {
  Matrix R = unscaled();
  for (int column = 0; column < N; ++column) {
    for (int row = 0; row <= column; ++row) R(row, column) = R(row, column) * scale(column);
  }
  Matrix product = Matrix::Zero();
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      for (int row = 0; row <= std::min(i, j); ++row) {
        product(i, j) = product(i, j) + R(row, i) * R(row, j);
      }
    }
  }
  return product;
}

template <int N>
Validity CompactRoot<N>::check() const {
  if (std::ranges::any_of(scales, [](int scale) { return scale > kMaxScale; }) ||
      std::ranges::count(entries, std::uint8_t{0}) > 0 ||
      unscaled().colwise().norm().maxCoeff() > 1.0 + kTolerance) {
    return unexpected(Malformed::kOutOfRange);
  }
  return {};
}

}  // namespace fleetloc
