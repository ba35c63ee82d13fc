#pragma once

#include <span>
#include <string>

#include "cloud/laser_map/laser_map.hpp"

namespace fleetloc {

/// Names the content of a map: FNV-1a with 128 bits (Fowler, Noll, Vo), most significant byte
/// first, over the seven floats of each point in turn (position, normal, planarity; IEEE 754 single
/// precision, little endian). It finds damage and mix-ups; it is no defence against forgery.
MapHash map_hash(std::span<const MapPoint> points);

/// 32 lower-case hexadecimal digits.
std::string to_string(const MapHash& hash);

}  // namespace fleetloc
