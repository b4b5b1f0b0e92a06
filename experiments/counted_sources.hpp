// Read before a source of the solvers that is to count as it is: `double` is a number that counts there, and
// its namespace another one.
//
// needs     nothing before it but what it includes itself. The language lets no program that includes
//           headers of the standard define a keyword; compilers take it once those have been read, so all
//           that such a source includes of them comes first. For the counting component alone
//           (experiments/CMakeLists.txt)
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <compare>
#include <complex>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <graze/experiments/counted_ladder.hpp>
#include <graze/solvers/math/counting_double.hpp>

namespace counted_numbers {
using Double = graze::CountingDouble;
}

#if defined(__clang__)
#pragma clang diagnostic ignored "-Wkeyword-macro"
#endif
#define double counted_numbers::Double
#define graze counted_graze
