// A bounding volume hierarchy over boxes, for scenes of many surfaces.
//
// solves    which boxes may a ray meet, near ones first
// needs     finite boxes that hold their surfaces (surfaces/bounds.hpp)
// returns   every box whose conservative slab test passes: never loses one that the ray meets
// cost      build O(n log^2 n); a ray visits O(log n) nodes where boxes overlap little; no allocation but the
//           caller's stack
// source    binned surface area heuristic: Wald, "On fast construction of SAH-based bounding volume
//           hierarchies", IEEE Symposium on Interactive Ray Tracing 2007; our own code
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <graze/surfaces/bounds.hpp>

namespace graze {

class Bvh {
 public:
  Bvh() = default;
  explicit Bvh(std::span<const Bounds> boxes);
  [[nodiscard]] bool empty() const { return nodes_.empty(); }

  /// A ray on its way through the tree: resumed where it stopped, so that many rays go in step and their
  /// surfaces are asked in batches. The nearest pending node is on top.
  class Walk {
   public:
    /// Starts at the root.
    void start(const Bvh& tree, const Ray& ray);
    /// Appends the boxes of the next leaf that the ray may meet at l <= far to `leaf` (emptied first); false
    /// when there is none left.
    bool next(const Bvh& tree, double far, std::vector<std::uint32_t>& leaf);

   private:
    struct Pending {
      double near;
      std::uint32_t node;
    };
    SlabRay ray_{Ray{{}, {1, 1, 1}}};
    std::vector<Pending> stack_;
  };

 private:
  static constexpr std::size_t kLeaf = 2;  ///< boxes a leaf: a surface costs more than a slab test

  struct Node {
    Bounds box;
    std::uint32_t first = 0;  ///< leaf: first entry of order_; else: right child (the left one follows)
    std::uint32_t count = 0;  ///< boxes of a leaf; 0 = inner node
  };
  void build(std::span<const Bounds> boxes, std::size_t first, std::size_t count);
  std::size_t split(std::span<const Bounds> boxes, std::size_t first, std::size_t count);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<Bounds> boxes_;  ///< in the order of order_
};

}  // namespace graze
