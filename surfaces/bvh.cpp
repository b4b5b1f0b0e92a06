#include <graze/surfaces/bvh.hpp>

#include <algorithm>
#include <array>
#include <numeric>

namespace graze {
namespace {

constexpr std::size_t kBins = 16;  // Wald 2007: more gain little

/// Twice a box's centre along an axis, halved first so that it does not overflow.
double centre(const Bounds& box, std::size_t axis) {
  return 0.5 * component(box.lo, axis) + 0.5 * component(box.hi, axis);
}

/// Half the surface area: what the chance of a ray's visit grows with.
double half_area(const Bounds& box) {
  const Vec3 e = box.hi - box.lo;
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Bounds kNothing{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

struct Bin {
  Bounds box = kNothing;
  std::size_t count = 0;
};

/// Where to cut the bins: before bin `cut` of `axis`, at the least expected cost.
struct Cut {
  double cost = kInfinity;
  std::size_t axis = 0;
  std::size_t cut = 0;
};

void consider(const std::array<Bin, kBins>& bins, std::size_t axis, Cut& best) {
  std::array<double, kBins> right_cost{};
  Bin right;
  for (std::size_t i = kBins; i-- > 1;) {
    right.box = hull(right.box, bins[i].box);
    right.count += bins[i].count;
    right_cost[i] = right.count == 0 ? 0 : half_area(right.box) * static_cast<double>(right.count);
  }
  Bin left;
  for (std::size_t i = 1; i < kBins; ++i) {
    left.box = hull(left.box, bins[i - 1].box);
    left.count += bins[i - 1].count;
    if (left.count == 0) continue;
    const double cost = half_area(left.box) * static_cast<double>(left.count) + right_cost[i];
    if (cost < best.cost) best = {cost, axis, i};
  }
}

/// The bin of a centre in [lo, hi].
std::size_t bin_of(double c, double lo, double hi) {
  const double share = (c - lo) / (hi - lo);
  return std::min(kBins - 1, static_cast<std::size_t>(share * static_cast<double>(kBins)));
}

}  // namespace

Bvh::Bvh(std::span<const Bounds> boxes) : order_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(2 * boxes.size());
  build(boxes, 0, boxes.size());
  for (const std::uint32_t i : order_) boxes_.push_back(boxes[i]);
}

void Bvh::build(std::span<const Bounds> boxes, std::size_t first, std::size_t count) {
  const std::size_t here = nodes_.size();
  nodes_.push_back({kNothing, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
  for (std::size_t i = first; i < first + count; ++i)
    nodes_[here].box = hull(nodes_[here].box, boxes[order_[i]]);
  if (count <= kLeaf) return;
  const std::size_t left = split(boxes, first, count);
  nodes_[here].count = 0;
  build(boxes, first, left);
  nodes_[here].first = static_cast<std::uint32_t>(nodes_.size());
  build(boxes, first + left, count - left);
}

/// Parts order_[first, first + count) in two and returns the size of the first part: by the cheapest cut of
/// the bins, or in the middle where the centres coincide.
std::size_t Bvh::split(std::span<const Bounds> boxes, std::size_t first, std::size_t count) {
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = begin + static_cast<std::ptrdiff_t>(count);
  Cut best;
  std::array<std::pair<double, double>, 3> range;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto& [lo, hi] = range[axis];
    lo = kInfinity;
    hi = -kInfinity;
    for (auto i = begin; i != end; ++i) {
      lo = std::min(lo, centre(boxes[*i], axis));
      hi = std::max(hi, centre(boxes[*i], axis));
    }
    if (!(hi - lo > 0) || !std::isfinite(hi - lo)) continue;
    std::array<Bin, kBins> bins;
    for (auto i = begin; i != end; ++i) {
      Bin& bin = bins[bin_of(centre(boxes[*i], axis), lo, hi)];
      bin.box = hull(bin.box, boxes[*i]);
      ++bin.count;
    }
    consider(bins, axis, best);
  }
  auto middle = begin;
  if (best.cost < kInfinity) {
    const auto [lo, hi] = range[best.axis];
    middle = std::partition(begin, end, [&, lo = lo, hi = hi](std::uint32_t i) {
      return bin_of(centre(boxes[i], best.axis), lo, hi) < best.cut;
    });
  }
  if (middle == begin || middle == end) middle = begin + static_cast<std::ptrdiff_t>(count / 2);
  return static_cast<std::size_t>(middle - begin);
}

void Bvh::Walk::start(const Bvh& tree, const Ray& ray) {
  ray_ = SlabRay(ray);
  stack_.clear();
  double near = 0;
  if (!tree.empty() && ray_.meets(tree.nodes_[0].box, kInfinity, near)) stack_.push_back({near, 0});
}

bool Bvh::Walk::next(const Bvh& tree, double far, std::vector<std::uint32_t>& leaf) {
  leaf.clear();
  while (!stack_.empty()) {
    const Pending top = stack_.back();
    stack_.pop_back();
    if (top.near > far) continue;
    const Node& node = tree.nodes_[top.node];
    if (node.count > 0) {
      double near = 0;
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        if (ray_.meets(tree.boxes_[i], far, near)) leaf.push_back(tree.order_[i]);
      }
      if (!leaf.empty()) return true;
      continue;
    }
    std::array<Pending, 2> children{Pending{0, top.node + 1}, Pending{0, node.first}};
    const auto reached = [&](Pending& child) {
      return ray_.meets(tree.nodes_[child.node].box, far, child.near);
    };
    const bool left = reached(children[0]);
    const bool right = reached(children[1]);
    if (left && right && children[0].near < children[1].near) std::swap(children[0], children[1]);
    if (left && right) {
      stack_.push_back(children[0]);
      stack_.push_back(children[1]);
    } else if (left || right) {
      stack_.push_back(children[left ? 0 : 1]);
    }
  }
  return false;
}

}  // namespace graze
