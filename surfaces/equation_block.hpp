// The equations that a batch of rays poses to a solver, and the memory they live in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/roots.hpp>

namespace graze {

/// Memory for the coefficients and contexts of one block: handed out in order, taken back all at once.
/// Addresses stay valid until `clear`. After warm-up it does not allocate.
class Arena {
 public:
  template <class T>
  std::span<T> array(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= alignof(std::max_align_t));
    auto* const memory = static_cast<T*>(take(count * sizeof(T)));
    std::uninitialized_value_construct_n(memory, count);
    return {memory, count};
  }
  template <class T>
  T* make(const T& value) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= alignof(std::max_align_t));
    return new (take(sizeof(T))) T(value);
  }
  void clear() {
    chunk_ = 0;
    used_ = 0;
  }

 private:
  static constexpr std::size_t kChunk = std::size_t{1} << 16;

  void* take(std::size_t bytes) {
    constexpr std::size_t kAlign = alignof(std::max_align_t);
    bytes = (bytes + kAlign - 1) / kAlign * kAlign;
    while (chunk_ < chunks_.size() && used_ + bytes > chunks_[chunk_].size) {
      ++chunk_;
      used_ = 0;
    }
    if (chunk_ == chunks_.size()) {
      const std::size_t size = bytes > kChunk ? bytes : kChunk;
      chunks_.push_back({std::make_unique<std::byte[]>(size), size});
    }
    std::byte* const memory = chunks_[chunk_].memory.get() + used_;
    used_ += bytes;
    return memory;
  }

  struct Chunk {
    std::unique_ptr<std::byte[]> memory;
    std::size_t size;
  };
  std::vector<Chunk> chunks_;
  std::size_t chunk_ = 0;
  std::size_t used_ = 0;
};

/// Which ray an equation belongs to, and which of the formulation's equations it is (its own numbering).
struct Posed {
  std::uint32_t ray = 0;
  std::uint32_t kind = 0;
};

/// All equations of a block of rays in one form and arithmetic. A ray may pose none (culled), one, or
/// several.
class EquationBlock {
 public:
  /// Empties the block for equations of `form`. With `coefficient_errors` formulations also bound the
  /// rounding errors of polynomial coefficients, which a certified solver needs and others do not pay for,
  /// and what `digits` says.
  void reset(Form form, Precision precision, bool coefficient_errors, Digits digits = Digits::rounded) {
    form_ = form;
    precision_ = precision;
    coefficient_errors_ = coefficient_errors;
    digits_ = digits;
    arena_.clear();
    std::apply([](auto&... list) { (list.clear(), ...); }, equations_);
    posed_.clear();
    settled_.clear();
    tests_.clear();
  }
  [[nodiscard]] Form form() const { return form_; }
  [[nodiscard]] Precision precision() const { return precision_; }
  [[nodiscard]] bool wants_coefficient_errors() const { return coefficient_errors_; }
  [[nodiscard]] Digits digits() const { return digits_; }
  [[nodiscard]] Arena& arena() { return arena_; }

  /// The ray whose equations come next.
  void begin_ray(std::uint32_t ray) { ray_ = ray; }
  /// Adds an equation of the current ray, of the block's form and arithmetic.
  template <class Equation>
  void pose(const Equation& equation, std::uint32_t kind = 0) {
    std::get<std::vector<Equation>>(equations_).push_back(equation);
    posed_.push_back({ray_, kind});
  }
  /// Answers the current ray without a solver, with a status other than ok.
  void settle(Status status) { settled_.emplace_back(ray_, status); }
  /// Counts tests of the surface's parts that the current ray cost (Counters::tests).
  void spend(std::uint32_t tests) { tests_.emplace_back(ray_, tests); }

  template <class Equation>
  [[nodiscard]] std::span<const Equation> of() const {
    return std::get<std::vector<Equation>>(equations_);
  }
  [[nodiscard]] std::span<const Posed> posed() const { return posed_; }
  [[nodiscard]] std::span<const std::pair<std::uint32_t, Status>> settled() const { return settled_; }
  [[nodiscard]] std::span<const std::pair<std::uint32_t, std::uint32_t>> tests() const { return tests_; }

 private:
  Form form_ = Form::polynomial;
  Precision precision_ = Precision::binary64;
  bool coefficient_errors_ = false;
  Digits digits_ = Digits::rounded;
  std::uint32_t ray_ = 0;
  Arena arena_;
  std::tuple<std::vector<PolynomialEquation>, std::vector<ScalarEquation>, std::vector<IntervalEquation>,
             std::vector<SystemEquation>, std::vector<BasicPolynomialEquation<float>>,
             std::vector<BasicScalarEquation<float>>, std::vector<BasicSystemEquation<float>>>
      equations_;
  std::vector<Posed> posed_;
  std::vector<std::pair<std::uint32_t, Status>> settled_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> tests_;
};

}  // namespace graze
