// Polynomial surfaces: worked rays, the catalogue of the page, and the same surfaces in other forms.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;

/// The rows "| `name` | formula | `[[...]]` |" of surfaces/implicit_polynomial.md.
std::map<std::string, Table> catalogue() {
  std::ifstream page(std::string(GRAZE_TEST_DATA) + "/../../surfaces/implicit_polynomial.md");
  std::map<std::string, Table> surfaces;
  for (std::string line; std::getline(page, line);) {
    const std::size_t start = line.find("`[[");
    if (line.rfind("| `", 0) != 0 || start == std::string::npos) continue;
    Table& terms = surfaces[line.substr(3, line.find('`', 3) - 3)];
    const char* at = line.c_str() + start + 2;
    while (*at == '[' || *at == ',') {
      if (*at == ',') ++at;
      ++at;
      std::vector<double> row;
      for (char* end = nullptr; *at != ']'; at = *end == ',' ? end + 1 : end)
        row.push_back(std::strtod(at, &end));
      terms.push_back(row);
      ++at;
    }
  }
  return surfaces;
}

double value(const Table& terms, Vec3 x) {
  double sum = 0;
  for (const auto& row : terms)
    sum += row[0] * std::pow(x.x, row[1]) * std::pow(x.y, row[2]) * std::pow(x.z, row[3]);
  return sum;
}

double size_of_terms(const Table& terms, Vec3 x) {
  double sum = 0;
  for (const auto& row : terms)
    sum += std::fabs(row[0] * std::pow(x.x, row[1]) * std::pow(x.y, row[2]) * std::pow(x.z, row[3]));
  return sum;
}

using Formula = std::function<double(double, double, double)>;

double cubed(double x) { return x * x * x; }
double squared(double x) { return x * x; }

/// The catalogue's formulas, as their column says.
std::map<std::string, Formula> formulas() {
  const double tau = (1 + std::sqrt(5.0)) / 2, t2 = tau * tau;
  const auto mixed = [](double x, double y, double z) {
    return x * x * y + x * x * z + x * y * y + y * y * z + x * z * z + y * z * z;
  };
  return {
      {"sphere", [](double x, double y, double z) { return x * x + y * y + z * z - 1; }},
      {"torus", [](double x, double y,
                   double z) { return squared(x * x + y * y + z * z + 0.9375) - 4 * (x * x + z * z); }},
      {"piriform", [](double x, double y, double z) { return 4 * cubed(x) * (x - 1) + y * y + z * z; }},
      {"lemniscate", [](double x, double y, double z) { return x * x * (x * x - 1) + y * y + z * z; }},
      {"glob", [](double x, double y, double z) { return x * cubed(x) * (x + 1) - 2 * (y * y + z * z); }},
      {"dingdong", [](double x, double y, double z) { return x * x + z * z - y * y * (1 - y); }},
      {"heart",
       [](double x, double y, double z) {
         return cubed(x * x + 2.25 * y * y + z * z - 1) - cubed(z) * (x * x + 0.1125 * y * y);
       }},
      {"kummer",
       [](double x, double y, double z) {
         const double a = x * x, b = y * y, c = z * z;
         return a * a + b * b + c * c - a - b - c - a * b - a * c - b * c + 1;
       }},
      {"devils_curve",
       [](double x, double y, double z) {
         return squared(x * x + z * z) - 0.36 * x * x - squared(y * y) + y * y / 4;
       }},
      {"quartic_cylinder",
       [](double x, double y, double z) { return (x * x + z * z) * (y * y + 0.01) - 0.01; }},
      {"cayley",
       [mixed](double x, double y, double z) { return 2 * (x * y + y * z + z * x) - 5 * mixed(x, y, z); }},
      {"clebsch",
       [mixed](double x, double y, double z) {
         return 81 * (cubed(x) + cubed(y) + cubed(z)) - 189 * mixed(x, y, z) + 54 * x * y * z +
                126 * (x * y + y * z + z * x) - 9 * (x * x + y * y + z * z) - 9 * (x + y + z) + 1;
       }},
      {"steiner", [](double x, double y,
                     double z) { return squared(x * y) + squared(y * z) + squared(z * x) - x * y * z; }},
      {"whitney", [](double x, double y, double z) { return x * x - y * y * z; }},
      {"crossed_trough", [](double x, double y, double z) { return squared(x * z) - y; }},
      {"monkey_saddle", [](double x, double y, double z) { return cubed(x) - 3 * x * z * z - y; }},
      {"tooth", [](double x, double y,
                   double z) { return x * x * (x * x - 1) + y * y * (y * y - 1) + z * z * (z * z - 1); }},
      {"tangle",
       [](double x, double y, double z) {
         return x * x * (x * x - 5) + y * y * (y * y - 5) + z * z * (z * z - 5) + 11.8;
       }},
      {"hunt",
       [](double x, double y, double z) {
         return 4 * cubed(x * x + y * y + z * z - 13) + 27 * squared(3 * x * x + y * y - 4 * z * z - 12);
       }},
      {"barth",
       [tau, t2](double x, double y, double z) {
         return 4 * (t2 * x * x - y * y) * (t2 * y * y - z * z) * (t2 * z * z - x * x) -
                (1 + 2 * tau) * squared(x * x + y * y + z * z - 1);
       }},
  };
}

class ImplicitPolynomialTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_surface("implicit_polynomial")) GTEST_SKIP() << "this build has no implicit_polynomial";
    companion_ = solver_named("companion");
    certified_ = solver_named("interval_bisection");
    if (companion_ == nullptr || certified_ == nullptr) GTEST_SKIP() << "this build lacks a solver";
  }
  [[nodiscard]] Answer certified(const Table& terms, const Ray& ray) const {
    return ask(scene_of(implicit_polynomial(terms), *certified_), {&ray, 1})[0];
  }
  const SolverEntry* companion_ = nullptr;
  const SolverEntry* certified_ = nullptr;
};

TEST_F(ImplicitPolynomialTest, TheCataloguesTermsAreItsFormulas) {
  const auto surfaces = catalogue();
  const auto known = formulas();
  EXPECT_EQ(surfaces.size(), known.size());
  Rng rng(kSeed);
  for (const auto& [name, terms] : surfaces) {
    ASSERT_TRUE(known.count(name)) << name;
    for (int i = 0; i < 100; ++i) {
      const Vec3 x{rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)};
      EXPECT_NEAR(value(terms, x), known.at(name)(x.x, x.y, x.z), 1e-11 * (1 + size_of_terms(terms, x)))
          << name;
    }
  }
}

TEST_F(ImplicitPolynomialTest, EverySurfaceOfTheCatalogueIsSolvedAndItsHitsLieOnIt) {
  for (const auto& [name, terms] : catalogue()) {
    const auto surface = find_surface("implicit_polynomial").make(implicit_polynomial(terms));
    const auto rays = camera_rays(*surface, 100, kSeed);
    const auto proved = ask(scene_of(implicit_polynomial(terms), *certified_), rays);
    const auto found = ask(scene_of(implicit_polynomial(terms), *companion_), rays);
    std::size_t hits = 0, undecided = 0, different = 0;
    double worst = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (proved[i].status != Status::ok) {
        ++undecided;
        continue;
      }
      hits += proved[i].l.size();
      different += proved[i].l.size() != found[i].l.size() ? 1U : 0U;
      for (std::size_t k = 0; k < proved[i].l.size(); ++k) {
        const Vec3 x = proved[i].point[k];
        worst = std::max(worst, std::fabs(value(terms, x)) / (size_of_terms(terms, x) + norm(x)));
      }
    }
    std::printf("%-16s %3zu hits, %zu undecided, %zu counts unlike companion's, worst residual %.2g\n",
                name.c_str(), hits, undecided, different, worst);
    EXPECT_GT(hits, 10U) << name;
    EXPECT_LE(undecided, 3U) << name;
    EXPECT_LE(different, 2U) << name;
    EXPECT_LE(worst, 1e-9) << name;
  }
}

TEST_F(ImplicitPolynomialTest, APiriformIsHitWhereItIs) {
  // y = z = 0: 4 x^3 (x - 1). From x = 2 towards the cusp: x = 1 is simple, x = 0 triple.
  const std::vector<Ray> rays{{{2, 0, 0}, {-1, 0, 0}}};
  const Answer answer = ask(scene_of(implicit_polynomial(piriform_terms()), *companion_), rays)[0];
  ASSERT_GE(answer.l.size(), 1U);
  EXPECT_NEAR(answer.l[0], 1, 1e-12);
  EXPECT_NEAR(answer.normal[0].x, 1, 1e-12);
  const auto marks =
      find_surface("implicit_polynomial").make(implicit_polynomial(piriform_terms()))->landmarks();
  ASSERT_EQ(marks.singular.size(), 1U);
  EXPECT_EQ(marks.singular[0].second, Landmarks::Singular::cusp);
}

TEST_F(ImplicitPolynomialTest, LinesInsideASurfaceAreCoincident) {
  const Table saddle{{1, 1, 1, 0}, {-1, 0, 0, 1}};  // z = x y, ruled by straight lines
  EXPECT_EQ(certified(saddle, {{3, -5, -15}, {0, 1, 3}}).status, Status::coincident);
  EXPECT_EQ(certified(saddle, {{0.3, 0.5, 0.3 * 0.5}, {1, 0, 0.5}}).status, Status::coincident)
      << "0.3 times 0.5 is exact";
  EXPECT_NE(certified(saddle, {{0.3, 0.7, 0.3 * 0.7}, {1, 0, 0.7}}).status, Status::coincident)
      << "0.3 times 0.7 is not: the line is beside the surface";
  const Table cayley = catalogue().at("cayley");
  EXPECT_EQ(certified(cayley, {{-30, 0, 0}, {1, 0, 0}}).status, Status::coincident);
  EXPECT_EQ(certified(cayley, {{-30, 0, 1}, {1, 0, 0}}).status, Status::ok);
}

TEST_F(ImplicitPolynomialTest, TheDegreeMayDropAlongARay) {
  const Table bowl{{1, 2, 0, 0}, {1, 0, 0, 2}, {-1, 0, 1, 0}};  // y = x^2 + z^2
  const Answer down = certified(bowl, {{0.5, 9, 1}, {0, -1, 0}});
  ASSERT_EQ(down.l.size(), 1U);
  EXPECT_NEAR(down.l[0], 7.75, 1e-11);
  EXPECT_EQ(down.status, Status::ok);
  // Exactly along a direction in which the cubic terms cancel: x y z with d = (1, -1, 0).
  const Table cubic{{1, 1, 1, 1}, {1, 2, 0, 0}, {-1, 0, 0, 0}};
  const Answer across = certified(cubic, {{-3, 3, 0}, {1, -1, 0}});
  ASSERT_EQ(across.l.size(), 2U);
  EXPECT_NEAR(across.l[0], 2, 1e-11);
  EXPECT_NEAR(across.l[1], 4, 1e-11);
}

TEST_F(ImplicitPolynomialTest, ARayThatStartsOnTheSurfaceDoesNotHitThere) {
  const Table sphere{{1, 2, 0, 0}, {1, 0, 2, 0}, {1, 0, 0, 2}, {-1, 0, 0, 0}};
  const Answer inward = certified(sphere, {{1, 0, 0}, {-1, 0, 0}});
  EXPECT_EQ(inward.status, Status::ok);
  ASSERT_EQ(inward.l.size(), 1U);
  EXPECT_NEAR(inward.l[0], 2, 1e-11);
  const Answer outward = certified(sphere, {{1, 0, 0}, {0.5, 3, 0}});
  EXPECT_EQ(outward.status, Status::ok);
  EXPECT_TRUE(outward.l.empty());
  EXPECT_TRUE(certified(sphere, {{1, 0, 0}, {0, 1, 0}}).l.empty()) << "touches where it starts";
}

TEST_F(ImplicitPolynomialTest, EqualTermsAddExactly) {
  // 1e16 + 1 - 1e16 is 1 only without rounding.
  const Table parts{{1e16, 2, 0, 0}, {1, 2, 0, 0}, {-1e16, 2, 0, 0},
                    {1, 0, 2, 0},    {1, 0, 0, 2}, {-1, 0, 0, 0}};
  const Answer answer = certified(parts, {{-3, 0, 0}, {1, 0, 0}});
  ASSERT_EQ(answer.l.size(), 2U);
  EXPECT_NEAR(answer.l[0], 2, 1e-11);
}

TEST_F(ImplicitPolynomialTest, ASphereAndATorusAnswerAsThoseSurfacesDo) {
  SurfaceSpec ball;
  ball.type = "sphere";
  ball.parameters.set("radius", 1.0);
  const std::array<std::pair<SurfaceSpec, std::string>, 2> pairs{
      {{ball, "sphere"}, {torus(1, 0.25), "torus"}}};
  for (const auto& [spec, name] : pairs) {
    if (!has_surface(spec.type)) continue;
    const auto rays = camera_rays(*find_surface(spec.type).make(spec), 300, kSeed);
    const auto a = ask(scene_of(spec, *companion_), rays);
    const auto b = ask(scene_of(implicit_polynomial(catalogue().at(name)), *companion_), rays);
    double worst = 0, worst_normal = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(a[i].l.size(), b[i].l.size()) << name << " " << i;
      for (std::size_t k = 0; k < a[i].l.size(); ++k) {
        worst = std::max(worst, std::fabs(a[i].l[k] - b[i].l[k]) / a[i].l[k]);
        worst_normal = std::max(worst_normal, norm(a[i].normal[k] - b[i].normal[k]));
      }
    }
    std::printf("%s: worst relative difference %.2g, of normals %.2g\n", name.c_str(), worst, worst_normal);
    EXPECT_LE(worst, 1e-9);
    EXPECT_LE(worst_normal, 1e-8);
  }
}

TEST_F(ImplicitPolynomialTest, SamplesLieOnTheSurface) {
  Rng rng(kSeed);
  for (const auto& [name, terms] : catalogue()) {
    const auto surface = find_surface("implicit_polynomial").make(implicit_polynomial(terms));
    double worst = 0;
    for (int i = 0; i < 100; ++i) {
      const double u = rng.uniform(), v = rng.uniform();
      const SurfaceSample s = surface->sample(u, v);
      EXPECT_EQ(s.point, surface->sample(u, v).point);
      worst = std::max(worst, std::fabs(value(terms, s.point)) / size_of_terms(terms, s.point));
      EXPECT_NEAR(norm(s.normal), 1, 1e-15) << name;
    }
    EXPECT_LE(worst, 1e-14) << name;
  }
}

TEST_F(ImplicitPolynomialTest, TermsThatAreNoSurfaceAreRefused) {
  const SurfaceEntry& entry = find_surface("implicit_polynomial");
  const std::vector<Table> bad{{{1, 0, 0, 0}},
                               {{1, 2, 0, 0}, {-1, 2, 0, 0}},
                               {{1, 2, 0, 0}, {-1, 2, 0, 0}, {3, 0, 0, 0}},
                               {{1, -1, 0, 0}},
                               {{1, 0.5, 0, 0}},
                               {{1, 33, 0, 0}},
                               {{1, 2, 0}},
                               {{1, 1e9, 0, 0}}};
  for (const Table& terms : bad) EXPECT_THROW(entry.make(implicit_polynomial(terms)), std::invalid_argument);
  EXPECT_NO_THROW(entry.make(implicit_polynomial({{1, 32, 0, 0}, {-1, 0, 0, 0}})));
  EXPECT_NO_THROW(entry.make(implicit_polynomial({{1, 40, 0, 0}, {-1, 40, 0, 0}, {1, 1, 0, 0}})));
}

}  // namespace
}  // namespace graze::test
