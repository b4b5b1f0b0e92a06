// What the lanes of a kernel for `faithful` take: hits that `certified` proved, whose l is to be corrected.
#pragma once

#include <cstddef>
#include <cstdint>

#include <graze/surfaces/ray.hpp>

namespace graze {

/// Hits of one rank: first ones, second ones, ...
struct FaithfulBatch {
  const Ray* rays = nullptr;
  const std::uint32_t* which = nullptr;  ///< rays that have such a hit
  std::size_t count = 0;
  double* l = nullptr;  ///< of ray i l[i], in units of |d|: corrected in place
  /// open[i] becomes 1 where l[i] is not proved to be within one ulp of a hit.
  std::uint8_t* open = nullptr;
  /// The hit must also be the one that l stood for: its neighbours are not looked at.
  bool is_alone = false;
};

}  // namespace graze
