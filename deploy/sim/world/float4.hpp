#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include <Eigen/Core>

namespace fleetloc {

/// Four numbers in a vector register (SIMD) of the baseline instruction set. Comparisons give lanes
/// of all bits or none, for `mask ? a : b`.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Uint4 = std::uint32_t __attribute__((vector_size(16)));

inline Float4 load4(const float* from) {
  Float4 value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

inline void store4(const Float4& value, float* to) {
  std::memcpy(to, &value, sizeof(value));
}

inline Uint4 load4(const std::uint32_t* from) {
  Uint4 value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

inline void store4(const Uint4& value, std::uint32_t* to) {
  std::memcpy(to, &value, sizeof(value));
}

inline Float4 all4(float value) {
  return Float4{value, value, value, value};
}

inline bool any(const Int4& mask) {
  std::array<std::uint64_t, 2> halves{};
  std::memcpy(halves.data(), &mask, sizeof(mask));
  return (halves[0] | halves[1]) != 0;
}

inline Float4 min4(const Float4& a, const Float4& b) {
  return a < b ? a : b;
}

inline Float4 max4(const Float4& a, const Float4& b) {
  return a > b ? a : b;
}

inline Float4 clamped(const Float4& value, float min, float max) {
  return min4(max4(value, all4(min)), all4(max));
}

inline Float4 magnitude(const Float4& value) {
  return max4(value, -value);
}

inline Float4 square_root(const Float4& value) {
  Eigen::Array4f root;
  store4(value, root.data());
  root = root.sqrt().eval();
  return load4(root.data());
}

inline Float4 exponential(const Float4& value) {
  Eigen::Array4f power;
  store4(value, power.data());
  power = power.exp().eval();
  return load4(power.data());
}

inline Int4 to_signed(const Uint4& value) {
  return __builtin_convertvector(value, Int4);
}

inline Uint4 to_unsigned(const Int4& value) {
  return __builtin_convertvector(value, Uint4);
}

inline Float4 to_float(const Int4& value) {
  return __builtin_convertvector(value, Float4);
}

/// Towards zero, within the range of an integer.
inline Int4 to_integer(const Float4& value) {
  return __builtin_convertvector(value, Int4);
}

/// Largest integers that are not above, within the range of an integer.
inline Int4 floored(const Float4& value) {
  const Int4 truncated = to_integer(value);
  return truncated + (value < to_float(truncated));  // true is -1
}

}  // namespace fleetloc
