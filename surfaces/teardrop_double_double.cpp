// Compiled once for each instruction set. A line's lane does not see its neighbours: it stops to move when
// its own criterion is met.
#include <graze/surfaces/teardrop_double_double.hpp>

#include <graze/solvers/math/lanes_double_double.hpp>

namespace graze::GRAZE_LANES {
namespace {

constexpr double kU = 0x1p-53;
constexpr double kU2 = kU * kU;
constexpr double kTiny = 0x1p-800;  // above what underflow can add to a bound, far below what matters
constexpr double kInfinity = __builtin_inf();

bool any(Mask mask) { return to_bits(mask) != 0; }
Lanes norm(Lanes x, Lanes z) { return sqrt(fma(x, x, z * z)); }
Mask is_finite(Lanes x) { return abs(x) < kInfinity; }

/// F = R^2 - |x_xz|^2 at points of the lines, with a bound on its error.
struct Value {
  Wide f;
  Lanes error;
  Mask is_beside;  ///< certainly below the bottom or above the apex

  [[nodiscard]] Mask is_inside() const { return ~is_beside & (f.hi > error); }
  [[nodiscard]] Mask is_outside() const { return is_beside | (f.hi < -error); }
};

class Lines {
 public:
  Lines(const double* rays, double m) : m_(m) {
    Lanes x[6];
    load_records(rays, x);
    for (int i = 0; i < 3; ++i) {
      o_[i] = x[i];
      d_[i] = x[i + 3];
    }
    six_m_ = two_prod(all(6.0), all(m));
    nine_m2_ = two_prod(all(m), all(m)) * all(9.0);
    // Any double near the closest approach to the widest circle's centre will do.
    const Lanes dd = fma(d_[0], d_[0], fma(d_[1], d_[1], d_[2] * d_[2]));
    centre_ = -fma(d_[0], o_[0], fma(d_[1], o_[1] - 2.52 * m, d_[2] * o_[2])) / dd;
    usable_ = abs(centre_) < 0x1p400;
    for (int i = 0; i < 3; ++i) {
      p_[i] = two_prod(centre_, d_[i]) + o_[i];
      usable_ &= abs(o_[i]) < 0x1p400;
    }
  }

  [[nodiscard]] Mask is_usable() const { return usable_; }
  [[nodiscard]] Lanes centre() const { return centre_; }
  [[nodiscard]] double m() const { return m_; }
  /// centre + delta, rounded once.
  [[nodiscard]] Lanes l(const Wide& delta) const { return (delta + centre_).hi; }

  /// Error terms: p within 2 u^2 of each coordinate, delta d within 2, their sum within 3.
  [[nodiscard]] Value value(const Wide& delta) const {
    Wide x[3];
    Lanes e[3];
    for (int i = 0; i < 3; ++i) {
      x[i] = p_[i] + delta * d_[i];
      e[i] = kU2 * (3 * abs(p_[i].hi) + 3 * abs(delta.hi * d_[i]) + 4 * abs(x[i].hi));
    }
    return value_at(x, e);
  }
  /// At l = 0: no error of the points themselves.
  [[nodiscard]] Value value_at_origin() const {
    const Wide x[3] = {wide(o_[0]), wide(o_[1]), wide(o_[2])};
    const Lanes none[3] = {Lanes{}, Lanes{}, Lanes{}};
    return value_at(x, none);
  }

  /// `e`: of x, y, z. v, 1 - v, sqrt and the quotient are within 16, 19, 4 and 15 u^2, so that rho = 9 m^2 v
  /// g^2 is within 160 of itself plus |d rho / dy| times the error of y.
  [[nodiscard]] Value value_at(const Wide (&point)[3], const Lanes (&e)[3]) const {
    const auto& [x, y, z] = point;
    const Wide below = six_m_ - y;
    Value result;
    result.is_beside = (y.hi < -e[1]) | (below.hi < -2 * e[1] - 4 * kU2 * six_m_.hi);
    const Wide v = select(y.hi > 0, y, wide(0.0)) / six_m_;
    const Wide t = sqrt(v);
    const Wide g = below / six_m_ * (t + all(2.0)) / (t + all(1.0));
    const Wide rho = nine_m2_ * v * sqr(g);
    const Wide square = sqr(x) + sqr(z);
    result.f = rho - square;
    const Lanes e_height = e[1] + 4 * kU2 * six_m_.hi;
    // |d rho / dy| = 3/2 m g |2 - 3v - 2t| here, at most 6 m anywhere; it turns by less than 32 an unit of y
    // where v > 2^-10.
    const Lanes turn = abs(2 - 3 * v.hi - 2 * t.hi);
    const Lanes local = 1.5 * m_ * abs(g.hi) * turn + 32 * e_height, most = all(6 * m_);
    const Lanes slope = select((v.hi > 0x1p-10) & (local < most), local, most);
    result.error = 1.01 * (160 * kU2 * rho.hi + slope * e_height + 2 * (abs(x.hi) * e[0] + abs(z.hi) * e[2]) +
                           e[0] * e[0] + e[2] * e[2] + 16 * kU2 * square.hi) +
                   kTiny;
    return result;
  }

  /// How far the point is inside the body's circle at its height: G = R - |x_xz|, concave along the line,
  /// with its first two derivatives; not a number outside of the slab 0 <= y <= 6m.
  struct Depth {
    Lanes g, dg, ddg;
  };
  [[nodiscard]] Depth depth(Lanes delta) const {
    const Lanes x = at(0, delta), y = at(1, delta), z = at(2, delta);
    const Lanes t = sqrt(y / six_m_.hi), rho = norm(x, z);
    const Mask off_axis = rho > 0;
    const Lanes rise = (2 - t * (2 + 3 * t)) / (4 * t) * d_[1];
    const Lanes spread = select(off_axis, (x * d_[0] + z * d_[2]) / rho, Lanes{});
    const Lanes flat = d_[0] * d_[0] + d_[2] * d_[2];
    const Lanes bend = select(off_axis, max(flat - spread * spread, Lanes{}) / rho, Lanes{});
    return {3 * m_ * t * (1 - t) * (2 + t) - rho, rise - spread,
            -(2 + 3 * t * t) / (48 * m_ * t * t * t) * d_[1] * d_[1] - bend};
  }

  /// What falls through zero at a crossing, with its slope: G, or F in the lower half of the body.
  struct Descent {
    Lanes value, slope;
    Mask on_depth;
  };
  [[nodiscard]] Descent descent(Lanes delta) const {
    const Lanes x = at(0, delta), y = at(1, delta), z = at(2, delta);
    const Depth here = depth(delta);
    const Lanes v = max(y / six_m_.hi, all(0x1p-80)), t = sqrt(v), k = d_[1] / six_m_.hi;
    const Lanes g = 2 - v - t, turn = 2 - 3 * v - 2 * t;
    const Lanes f = nine_m2_.hi * v * g * g - x * x - z * z;
    const Lanes df = nine_m2_.hi * g * turn * k - 2 * (x * d_[0] + z * d_[2]);
    const Mask upper = y > 0.5 * six_m_.hi;
    return {select(upper, here.g, f), select(upper, here.dg, df), upper};
  }

  /// G' to twice the digits where 0 < y < 6m and the point is off the axis, and a bound on its error: fewer
  /// than 32 operations within 16 u^2 on terms of the sizes given, and y's and rho's errors over t^3 and rho.
  struct Slope {
    Wide value;
    Lanes error;
  };
  [[nodiscard]] Slope depth_slope(const Wide& delta) const {
    const Wide x = p_[0] + delta * d_[0], y = p_[1] + delta * d_[1], z = p_[2] + delta * d_[2];
    const Wide t = sqrt(y / six_m_), rho = sqrt(sqr(x) + sqr(z));
    const Wide rise = (wide(2.0) - t * (t * all(3.0) + all(2.0))) / (t * all(4.0)) * d_[1];
    const Wide spread = (x * d_[0] + z * d_[2]) / rho;
    const Lanes size = 2 * abs(d_[1]) / t.hi + 4;
    const Lanes bend = d_[1] * d_[1] / (t.hi * t.hi * t.hi) + 8 / rho.hi;
    return {rise - spread, 1024 * kU2 * size + coordinate_error(delta) * bend};
  }

  /// The part of the line between the planes of the poles, as rounded.
  struct Slab {
    Lanes lo, hi;
  };
  [[nodiscard]] Slab slab() const {
    const Lanes far = all(0x1p20);  // a line that flat leaves every body's reach before
    const Lanes a = -p_[1].hi / d_[1], b = (six_m_.hi - p_[1].hi) / d_[1];
    const Mask steep = (d_[1] != 0) & (abs(a) < far) & (abs(b) < far);
    return {select(steep, min(a, b), -far), select(steep, max(a, b), far)};
  }

  /// Where lines that are not level pass the apex's plane, and how |x_xz|^2 - (9/16) d_y^2 e^2 =
  /// w + 2 b e + a e^2 goes on into the slab. `error`: of x and z there.
  struct Top {
    Wide delta;
    Lanes size, error;
    Wide w, b, a;
  };
  [[nodiscard]] Top at_top() const {
    const Wide delta = (six_m_ - p_[1]) / d_[1];
    const Wide x = p_[0] + delta * d_[0], z = p_[2] + delta * d_[2];
    const Wide flat = two_prod(d_[0], d_[0]) + two_prod(d_[2], d_[2]);
    const Wide outward = x * d_[0] + z * d_[2];
    return {delta,
            norm(x.hi, z.hi),
            coordinate_error(delta),
            sqr(x) + sqr(z),
            select(runs_up(), -outward, outward),
            flat - two_prod(d_[1], d_[1]) * all(0.5625)};
  }
  [[nodiscard]] Mask runs_up() const { return d_[1] > 0; }
  [[nodiscard]] Mask is_level() const { return d_[1] == 0; }
  [[nodiscard]] Lanes steepness() const { return abs(d_[1]); }

  [[nodiscard]] Lanes distance_from_axis(const Wide& delta) const {
    return norm(at(0, delta.hi), at(2, delta.hi));
  }
  [[nodiscard]] Lanes distance_from_origin(const Wide& delta) const {
    return norm(distance_from_axis(delta), at(1, delta.hi));
  }

 private:
  [[nodiscard]] Lanes at(int i, Lanes delta) const { return p_[i].hi + delta * d_[i]; }
  /// Of a coordinate at delta, with room for an error of 16 u^2 |delta| of delta itself.
  [[nodiscard]] Lanes coordinate_error(const Wide& delta) const {
    const Lanes reach = max(abs(p_[0].hi), max(abs(p_[1].hi), abs(p_[2].hi)));
    return 64 * kU2 * (abs(delta.hi) * 2 + reach + 16);
  }

  Lanes o_[3], d_[3];
  double m_;
  Wide six_m_, nine_m2_;
  Lanes centre_;
  Wide p_[3];
  Mask usable_;
};

/// Near the point of each line where it is deepest in the body, or least far from it: G' falls along the
/// line, so its zero is bracketed by signs; Newton's steps where they stay inside the bracket, else halving.
Wide deepest(const Lines& lines) {
  constexpr int kSteps = 60, kSharp = 2;
  auto [lo, hi] = lines.slab();
  Lanes delta = select((lo <= 0) & (hi >= 0), Lanes{}, 0.5 * (lo + hi));
  Mask moves = lines.is_usable();
  for (int i = 0; i < kSteps && any(moves); ++i) {
    const Lines::Depth here = lines.depth(delta);
    moves &= ~(here.dg == 0);
    const Mask rises = here.dg > 0;
    lo = select(moves & rises, delta, lo);
    hi = select(moves & ~rises, delta, hi);
    const Lanes newton = delta - here.dg / here.ddg;
    const Lanes next = select((newton > lo) & (newton < hi), newton, 0.5 * (lo + hi));
    const Lanes step = abs(next - delta);
    delta = select(moves, next, delta);
    moves &= ~(step <= 0x1p-50 * (abs(delta) + 1));
  }
  Wide sharp = wide(delta);
  moves = lines.is_usable();
  for (int i = 0; i < kSharp; ++i) {
    const Wide next = sharp - lines.depth_slope(sharp).value / lines.depth(sharp.hi).ddg;
    // On the axis or at a pole's plane there is no such step.
    moves &= abs(next.hi - sharp.hi) <= 0x1p-30 * (abs(sharp.hi) + 1);
    sharp = select(moves, next, sharp);
  }
  return sharp;
}

/// G is concave: it lies below its tangent. So a line misses where G at one point is further below zero than
/// the tangent's slope can make up for on the way to the body: no point of that is further from the origin of
/// the frame than 8 m, and |d| >= 1.
Mask misses(const Lines& lines, const Wide& at, const Value& value) {
  const Lines::Slope slope = lines.depth_slope(at);
  // F = G (R + rho), and R + rho = 2 rho + G <= 2 rho.
  const Lanes below = (-value.f.hi - value.error) / (2.01 * lines.distance_from_axis(at));
  const Lanes way = lines.distance_from_origin(at) + 8 * lines.m();
  return value.is_outside() & ~value.is_beside & (below > 1.01 * (abs(slope.value.hi) + slope.error) * way);
}

/// Lines beside the apex, in the distance e from the apex's plane into the slab: with h = |d_y| e the body's
/// R^2 is between (9/16) h^2 (1 - h/4m) and (9/16) h^2 for h < m, so where
/// q(e) = |x_xz|^2 - (9/16) d_y^2 e^2 = w + 2 b e + a e^2 is positive the line is outside, and where it is
/// below -(9/64) |d_y e|^3 / m inside. For lines that are flatter than the cone, a > 0.
class Tip {
 public:
  explicit Tip(const Lines& lines) : top_(lines.at_top()), runs_up_(lines.runs_up()), m_(lines.m()) {
    const Lanes rise = lines.steepness();
    cubic_ = 0.15 * rise * rise * rise / m_;
    // Products of numbers within top_.error, and at most 16 roundings in double-double.
    const Lanes size = top_.size + top_.error;
    e_w_ = 4 * size * top_.error + 16 * kU2 * size * size;
    e_b_ = 8 * top_.error + 64 * kU2 * size;
    is_flatter_ = ~lines.is_level() & (top_.a.hi > 0x1p-60) & (top_.w.hi > 4 * e_w_);
    discriminant_ = (sqr(top_.b) - top_.a * top_.w).hi;
    // a is within 16 u^2 of a sum of sizes below 8.
    discriminant_error_ =
        2 * e_b_ * (abs(top_.b.hi) + e_b_) + 8 * e_w_ + 256 * kU2 * (top_.w.hi + top_.b.hi * top_.b.hi);
  }

  /// No e > 0 with q(e) <= 0.
  [[nodiscard]] Mask is_missed() const {
    return is_flatter_ & ((top_.b.hi > e_b_) | (discriminant_ < -discriminant_error_));
  }
  /// Where q vanishes, near < far, if the signs at a 64th of their distance on both sides prove crossings.
  struct Crossings {
    Lanes near, far, aside;
    Mask proved;
  };
  [[nodiscard]] Crossings crossings() const {
    const Lanes far = (-top_.b.hi + sqrt(max(discriminant_, Lanes{}))) / top_.a.hi;
    const Lanes near = top_.w.hi / top_.a.hi / far;
    const Lanes aside = (far - near) / 64;
    // q' = 2 sqrt(b^2 - a w) there: what the cubic moves a zero by is less than a digit of l.
    const Mask is_sharp = cubic_ * far * far * far <= kU * m_ * sqrt(max(discriminant_, Lanes{}));
    const Mask proved = is_flatter_ & (top_.b.hi < -e_b_) & (discriminant_ > discriminant_error_) &
                        (near > aside) & (far < m_) & is_sharp & is_outside(near - aside) &
                        is_inside(near + aside) & is_inside(far - aside) & is_outside(far + aside);
    return {near, far, aside, proved};
  }
  /// delta at e.
  [[nodiscard]] Wide delta(Lanes e) const { return top_.delta + select(runs_up_, -e, e); }

 private:
  [[nodiscard]] Lanes q(Lanes e) const { return (top_.w + (top_.b * all(2.0) + top_.a * e) * e).hi; }
  [[nodiscard]] Lanes q_error(Lanes e) const {
    return e_w_ + 2 * e_b_ * e + 256 * kU2 * (top_.w.hi + 2 * abs(top_.b.hi) * e + 8 * e * e);
  }
  [[nodiscard]] Mask is_outside(Lanes e) const { return q(e) > q_error(e); }
  [[nodiscard]] Mask is_inside(Lanes e) const { return q(e) < -q_error(e) - cubic_ * e * e * e; }

  Lines::Top top_;
  Mask runs_up_, is_flatter_;
  double m_;
  Lanes cubic_, e_w_, e_b_, discriminant_, discriminant_error_;
};

/// The crossings in direction `sense` of inside points, in double. Newton's steps on G, which is concave:
/// from outside they never pass the root. On F in the lower half, where G rises like a root from the bottom.
Lanes approach(const Lines& lines, Lanes inside, Lanes g, Lanes sense, Mask wanted) {
  constexpr int kSteps = 40;
  constexpr double kShallow = 0x1p-30;
  const auto [lo, hi] = lines.slab();
  Lanes in = inside, out = select(sense > 0, hi, lo);
  // Near the deepest point G is a parabola; where it is shallow, to all of a double's digits.
  Lanes delta = inside + sense * sqrt(2 * max(g, Lanes{}) / -lines.depth(inside).ddg);
  Mask moves = wanted & ~(g < kShallow * 2 * lines.distance_from_axis(wide(inside)));
  for (int i = 0; i < kSteps && any(moves); ++i) {
    const Mask between = (sense * delta > sense * in) & (sense * delta < sense * out);
    delta = select(moves & ~between, 0.5 * (in + out), delta);
    const Lines::Descent here = lines.descent(delta);
    const Mask above = here.value > 0;
    in = select(moves & above, delta, in);
    out = select(moves & ~above, delta, out);
    const Lanes next = delta - here.value / here.slope;
    const Lanes step = abs(next - delta);
    delta = select(moves, next, delta);
    moves &= ~((step <= 0x1p-51 * abs(delta)) | (delta == in) | (delta == out));
  }
  // Beyond the poles' planes G is no number.
  const Lanes end = select(sense > 0, hi, lo);
  return select(is_finite(delta), min(max(delta, min(in, out)), max(in, out)), end);
}

/// Crossings between inside points and the outside, their sides proved.
struct Brackets {
  Wide root, in, out;
  Mask proved;
};

/// Widened about the approximation until the outer side is proved, and the inner one if it can be.
void widen(const Lines& lines, Lanes near, Lanes sense, Mask wanted, Brackets& bracket, Value& at_out) {
  constexpr int kWiden = 30;
  Lanes width = 0x1p-52 * (abs(near) + abs(lines.centre()) + 1);
  Mask looks = wanted;
  for (int i = 0; i < kWiden && any(looks); ++i) {
    const Wide further = two_sum(near, sense * width), closer = two_sum(near, -sense * width);
    const Value outer = lines.value(further), inner = lines.value(closer);
    const Mask beyond = select(sense > 0, further, bracket.in) > select(sense > 0, bracket.in, further);
    const Mask passed = looks & beyond & outer.is_outside();
    bracket.out = select(passed, further, bracket.out);
    at_out.f = select(passed, outer.f, at_out.f);
    at_out.error = select(passed, outer.error, at_out.error);
    const Mask between = select(sense > 0, closer, bracket.in) > select(sense > 0, bracket.in, closer);
    bracket.in = select(looks & between & inner.is_inside(), closer, bracket.in);
    bracket.proved |= passed;
    looks &= ~passed;
    width = width * 16;
  }
}

/// Newton's step from the outer end with the sharp value there; every third step halves, so that a slope that
/// misleads costs no more than a factor. Every end keeps its proved side; where the sign is lost in rounding
/// the surface is as near as can be told.
void narrow(const Lines& lines, Lanes sense, Brackets& bracket, Value& at_out) {
  constexpr int kRefine = 80;
  Mask moves = bracket.proved;
  for (int i = 0; i < kRefine && any(moves); ++i) {
    const Wide gap = bracket.out - bracket.in;
    const Lanes l = lines.l(bracket.in);
    bracket.root = select(moves, bracket.in + gap * all(0.5), bracket.root);
    moves &= ~(abs(gap.hi) <= 0x1p-51 * (abs(l) + 1));
    if (!any(moves)) return;
    const Lines::Descent s = lines.descent(bracket.out.hi);
    const Lanes on_depth = at_out.f.hi / (2 * lines.distance_from_axis(bracket.out) + s.value);
    const Lanes newton = select(s.on_depth, on_depth, at_out.f.hi) / (sense * s.slope);
    const Mask is_newton = (newton > 0) & (newton < abs(gap.hi)) & (all(i % 3 == 2 ? 0.0 : 1.0) > 0);
    const Lanes step = select(is_newton, newton, 0.5 * abs(gap.hi));
    const Lanes doubt = max(2 * abs(at_out.error / at_out.f.hi) * step,
                            0x1p-54 * (abs(bracket.out.hi) + abs(lines.centre()) + 1));
    const Lanes noise = select(is_newton, doubt, Lanes{});
    const Wide root = bracket.out + -sense * step;
    bracket.root = select(moves, root, bracket.root);
    for (const double side : {1.0, -1.0}) {
      const Wide probe = root + sense * noise * side;
      const Mask beyond_in = select(sense > 0, probe, bracket.in) > select(sense > 0, bracket.in, probe);
      const Mask before_out = select(sense > 0, bracket.out, probe) > select(sense > 0, probe, bracket.out);
      const Value there = lines.value(probe);
      const Mask inside = there.is_inside(), outside = there.is_outside();
      const Mask asked = moves & beyond_in & before_out;
      bracket.in = select(asked & inside, probe, bracket.in);
      bracket.out = select(asked & ~inside & outside, probe, bracket.out);
      at_out.f = select(asked & ~inside & outside, there.f, at_out.f);
      at_out.error = select(asked & ~inside & outside, there.error, at_out.error);
      moves &= ~(asked & ~inside & ~outside);
    }
  }
}

Brackets crossing(const Lines& lines, const Wide& inside, const Value& value, Lanes sense, Mask wanted) {
  // F = 2 rho G + G^2.
  const Lanes g = value.f.hi / (2 * lines.distance_from_axis(inside));
  const Lanes near = approach(lines, inside.hi, g, sense, wanted);
  Brackets bracket{inside, inside, inside, Mask{}};
  Value at_out = value;
  widen(lines, near, sense, wanted, bracket, at_out);
  narrow(lines, sense, bracket, at_out);
  return bracket;
}

/// What is proved of kLanes lines, as arrays.
struct Proofs {
  Mask misses, crosses, inside, outside;
  struct Side {
    Lanes l, lo, hi;
  } entry, exit;
};

Proofs::Side side_of(const Lines& lines, const Wide& root, const Wide& a, const Wide& b) {
  const Lanes at_a = lines.l(a), at_b = lines.l(b);
  return {lines.l(root), min(at_a, at_b), max(at_a, at_b)};
}
Proofs::Side select(Mask mask, const Proofs::Side& a, const Proofs::Side& b) {
  return {GRAZE_LANES::select(mask, a.l, b.l), GRAZE_LANES::select(mask, a.lo, b.lo),
          GRAZE_LANES::select(mask, a.hi, b.hi)};
}

Proofs prove(const Lines& lines, bool first_only) {
  Proofs proofs;
  const Value at_origin = lines.value_at_origin();
  proofs.inside = at_origin.is_inside();
  proofs.outside = at_origin.is_outside();
  const Wide top = deepest(lines);
  const Value value = lines.value(top);
  const Mask usable = lines.is_usable(), pierced = usable & value.is_inside();

  const Brackets entry = crossing(lines, top, value, all(-1.0), pierced);
  proofs.entry = side_of(lines, entry.root, entry.in, entry.out);
  const Mask enough = all(first_only ? 1.0 : 0.0) > 0;
  const Mask leaves = pierced & entry.proved & ~(enough & (proofs.entry.lo > 0));
  const Brackets exit = crossing(lines, top, value, all(1.0), leaves);
  proofs.exit = side_of(lines, exit.root, exit.in, exit.out);
  proofs.crosses = pierced & entry.proved & (~leaves | exit.proved);
  proofs.misses = Mask{};
  const Mask rest = usable & ~pierced;
  if (!any(rest)) return proofs;

  const Tip tip(lines);
  proofs.misses = rest & (misses(lines, top, value) | tip.is_missed());
  const Tip::Crossings e = tip.crossings();
  const Mask tipped = rest & ~proofs.misses & e.proved;
  if (!any(tipped)) return proofs;
  const auto at = [&](Lanes x) {
    return side_of(lines, tip.delta(x), tip.delta(x - e.aside), tip.delta(x + e.aside));
  };
  const Proofs::Side near = at(e.near), far = at(e.far);
  proofs.entry = select(tipped, select(lines.runs_up(), far, near), proofs.entry);
  proofs.exit = select(tipped, select(lines.runs_up(), near, far), proofs.exit);
  proofs.crosses |= tipped;
  return proofs;
}

void write(const Proofs& proofs, std::size_t count, LineAnswer* answers) {
  using Proved = LineAnswer::Proved;
  using Origin = LineAnswer::Origin;
  const unsigned misses = to_bits(proofs.misses), crosses = to_bits(proofs.crosses),
                 inside = to_bits(proofs.inside), outside = to_bits(proofs.outside);
  const auto bit = [](unsigned bits, std::size_t i) { return (bits >> i & 1U) != 0; };
  for (std::size_t i = 0; i < count; ++i) {
    LineAnswer& answer = answers[i];
    answer.proved = bit(misses, i) ? Proved::misses : bit(crosses, i) ? Proved::crosses : Proved::open;
    answer.origin = bit(inside, i) ? Origin::inside : bit(outside, i) ? Origin::outside : Origin::on;
    answer.entry = {proofs.entry.l[i], proofs.entry.lo[i], proofs.entry.hi[i]};
    answer.exit = {proofs.exit.l[i], proofs.exit.lo[i], proofs.exit.hi[i]};
  }
}

}  // namespace

void prove_teardrop_lines(const TeardropLines& lines, LineAnswer* answers) {
  for (std::size_t i = 0; i < lines.count; i += kLanes) {
    const std::size_t count = lines.count - i < kLanes ? lines.count - i : kLanes;
    // Lanes without a line of their own repeat the first.
    Ray rays[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) rays[k] = lines.lines[k < count ? i + k : i];
    write(prove(Lines(&rays[0].o.x, lines.m), lines.first_only), count, answers + i);
  }
}

}  // namespace graze::GRAZE_LANES
