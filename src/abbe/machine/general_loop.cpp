// Six axes without special geometry: elimination after Raghavan and Roth (1993), solved as an eigenvalue problem after
// Manocha and Canny (1994), written for lines in space instead of Denavit-Hartenberg parameters.
//
// The last axis turns its own line onto itself. So with p a point on that line and l its direction
//
//   E2 E3 E4 (p, l) = (E0 E1)^-1 target (p, l)
//
// has t2, t3, t4 on the left and t0, t1 on the right. Seen from a point on axis 2, the 14 numbers p, l, p x l,
// (p.p) l - 2 (p.l) p, p.p and p.l of both sides have no products but 1, c, s of t3 times 1, c, s of t4 on the left
// (their coefficients have 1, c, s of t2), and 1, c, s of t0 times those of t1 on the right. The right is eliminated:
// 6 equations remain, and times tan t3/2 another 6, for the 12 products of x3^0 ... x3^3 and x4^0 ... x4^2. Their
// matrix is quadratic in x2 and singular where there is a solution; its kernel gives x3 and x4. Zeros of angles are
// turned so that no half angle of interest is at infinity.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/orientation.h"
#include "abbe/machine/six_axis_loop.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

using Numbers14 = Eigen::Matrix<double, 14, 1>;
using Products9 = Eigen::Matrix<double, 14, 9>;  ///< columns: 1, c, s of one angle times 1, c, s of the next
using Square12 = Eigen::Matrix<double, 12, 12>;

/// The 14 numbers of a line; vectors first, three numbers each.
Numbers14 numbers_of(const Vector3d& p, const Vector3d& l) {
  Numbers14 n;
  const double pp = p.squaredNorm(), pl = p.dot(l);
  n << p, l, p.cross(l), pp * l - 2 * pl * p, pp, pl;
  return n;
}

/// Coefficients of 14 functions of two angles with no more than the first harmonic of each, from nine values.
template <typename Function>
Products9 products_of(const Function& function) {
  constexpr double kThird = 2 * std::numbers::pi / 3;
  Products9 coefficients = Products9::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double a = kThird * i, b = kThird * k;
      const double first[3] = {1.0 / 3, 2.0 / 3 * std::cos(a), 2.0 / 3 * std::sin(a)};
      const double second[3] = {1.0 / 3, 2.0 / 3 * std::cos(b), 2.0 / 3 * std::sin(b)};
      const Numbers14 value = function(a, b);
      for (int m = 0; m < 9; ++m) coefficients.col(m) += first[m / 3] * second[m % 3] * value;
    }
  }
  return coefficients;
}

/// 1, c, s of zero + 2 atan x, times 1 + x^2, in powers of x: row = function, column = power.
Matrix3d in_half_angle(double zero) {
  const double c = std::cos(zero), s = std::sin(zero);
  Matrix3d m;
  m << 1, 0, 1, c, -2 * s, -c, s, 2 * c, -s;
  return m;
}

/// Matrix of the two times six equations: base + cosine c + sine s of the hidden angle.
struct HiddenMatrix {
  Square12 base = Square12::Zero(), cosine = Square12::Zero(), sine = Square12::Zero();
  Square12 at(double t) const { return base + std::cos(t) * cosine + std::sin(t) * sine; }
};

class GeneralLoop {
 public:
  explicit GeneralLoop(const SixAxisLoop& loop) : loop_(loop) {
    goal_point_ = loop_.target * loop_.point[5];
    goal_direction_ = loop_.target.rotation * loop_.direction[5];
  }

  void eliminate() {
    collect_equations();
    choose_zero();
  }
  /// Whether the right side has the rank that it has in general.
  bool is_regular() const { return equations_ == 6; }
  /// Least pivot of the leading matrix against the largest: zero where the equations are dependent for every angle.
  double condition() const { return condition_; }

  void solve(LoopCandidates& candidates) {
    hidden_angles();
    for (std::size_t k = 0; k < hidden_count_; ++k) add_with_hidden(hidden_[k], candidates);
  }

 private:
  static constexpr double kZero3 = 0.7123, kZero4 = -1.0457;  // turned zeros without relation to anything

  void collect_equations() {
    const Vector3d& origin = loop_.point[2];
    const Vector3d third = loop_.direction[2], first = third.unitOrthogonal(), second = third.cross(first);
    Matrix3d frame;  // rows: components along which vectors are taken
    frame << first.transpose(), second.transpose(), third.transpose();
    const Products9 left = products_of([&](double a, double b) {
      const RigidTransform moved = loop_.turn(3, a) * loop_.turn(4, b);
      return numbers_of(frame * (moved * loop_.point[5] - origin), frame * (moved.rotation * loop_.direction[5]));
    });
    const Products9 right = products_of([&](double a, double b) {
      const RigidTransform moved = (loop_.turn(0, a) * loop_.turn(1, b)).inverse();
      return numbers_of(frame * (moved * goal_point_ - origin), frame * (moved.rotation * goal_direction_));
    });
    // Left by 1, c, s of t2.
    Products9 by[3] = {Products9::Zero(), Products9::Zero(), Products9::Zero()};
    for (int group = 0; group < 4; ++group) {
      const int row = 3 * group;
      by[1].row(row) = left.row(row);
      by[2].row(row) = -left.row(row + 1);
      by[1].row(row + 1) = left.row(row + 1);
      by[2].row(row + 1) = left.row(row);
      by[0].row(row + 2) = left.row(row + 2);
    }
    by[0].bottomRows<2>() = left.bottomRows<2>();
    by[0].col(0) -= right.col(0);
    // Rows without the right side: the orthogonal complement of its columns.
    PivotedQr factors(right.rightCols<8>());
    factors.set_threshold(1e-10);
    const MatrixXd all = factors.orthonormal(14);
    equations_ = 14 - factors.rank();
    const Matrix3d half3 = in_half_angle(kZero3), half4 = in_half_angle(kZero4);
    for (std::size_t part = 0; part < 3; ++part) {
      const MatrixXd trigonometric = all.rightCols(equations_).transpose() * by[part];
      rows_[part].setZero();
      for (int m = 0; m < 9; ++m) {
        for (int power = 0; power < 9; ++power) {
          rows_[part].col(power).head(equations_) +=
              half3(m / 3, power / 3) * half4(m % 3, power % 3) * trigonometric.col(m);
        }
      }
    }
    // Where there are more than six equations, because the right side is simpler than in general, fixed mixtures of
    // them go into the eigenvalue problem.
    Eigen::Matrix<double, 6, 14> mixture = Eigen::Matrix<double, 6, 14>::Zero();
    for (Index k = 0; k < 6; ++k) {
      if (equations_ == 6) mixture(k, k) = 1;
      for (Index i = 0; equations_ > 6 && i < equations_; ++i) {
        mixture(k, i) = std::cos(1.0 + 2.3 * static_cast<double>((i + 1) * (k + 1)) + 0.7 * static_cast<double>(i * i));
      }
    }
    Square12* const parts[3] = {&matrix_.base, &matrix_.cosine, &matrix_.sine};
    for (std::size_t part = 0; part < 3; ++part) {
      const Eigen::Matrix<double, 6, 9> mixed = mixture * rows_[part];
      parts[part]->topLeftCorner<6, 9>() = mixed;
      parts[part]->bottomRightCorner<6, 9>() = mixed;
    }
  }

  /// All equations at a value of the hidden angle, and times x3: their kernel has no more than the solutions.
  MatrixXd all_equations(double t) const {
    const Eigen::Matrix<double, 14, 9> rows = rows_[0] + std::cos(t) * rows_[1] + std::sin(t) * rows_[2];
    MatrixXd both = MatrixXd::Zero(2 * equations_, 12);
    both.topLeftCorner(equations_, 9) = rows.topRows(equations_);
    both.bottomRightCorner(equations_, 9) = rows.topRows(equations_);
    return both;
  }

  /// Half a turn from the zero of the hidden angle its half angle is infinite: no solution should be near there.
  void choose_zero() {
    condition_ = -1;
    for (int i = 0; i < 6; ++i) {
      const double t = 0.3917 + std::numbers::pi / 3 * i;
      const double condition = FullLu<12>(matrix_.at(t + std::numbers::pi)).pivot_ratio();
      if (condition > condition_) {
        condition_ = condition;
        zero_ = t;
      }
    }
  }

  void hidden_angles() {
    const double c = std::cos(zero_), s = std::sin(zero_);
    const Square12 cosine = c * matrix_.cosine + s * matrix_.sine, sine = c * matrix_.sine - s * matrix_.cosine;
    const FullLu<12> leading(matrix_.base - cosine);
    Eigen::Matrix<double, 24, 24> companion = Eigen::Matrix<double, 24, 24>::Zero();
    companion.topRightCorner<12, 12>().setIdentity();
    const Square12 constant = matrix_.base + cosine;
    for (Index k = 0; k < 12; ++k) {
      companion.block<12, 1>(12, k) = -leading.solve(constant.col(k));
      companion.block<12, 1>(12, 12 + k) = -2 * leading.solve(sine.col(k));
    }
    const GeneralEigenvalues<24> eigen(companion);
    constexpr double kNearlyRealEigenvalue = 1e-3;
    for (const std::complex<double>& x : eigen.values()) {
      if (!(std::abs(x.imag()) <= kNearlyRealEigenvalue * (1 + std::norm(x)))) continue;
      const double t = zero_ + 2 * std::atan(x.real());
      const auto end = hidden_.begin() + static_cast<std::ptrdiff_t>(hidden_count_);
      const bool seen = std::any_of(hidden_.begin(), end, [t](double other) {
        return std::abs(std::remainder(t - other, 2 * std::numbers::pi)) < 1e-9;
      });
      if (!seen) hidden_[hidden_count_++] = t;
    }
  }

  /// Solutions with one value of the hidden angle: as many as its matrix has kernel.
  void add_with_hidden(double t, LoopCandidates& candidates) {
    PivotedQr factors(all_equations(t).transpose());
    const MatrixXd all = factors.orthonormal(12);
    Index before = 0;
    for (const double threshold : {1e-10, 1e-5}) {
      factors.set_threshold(threshold);
      const Index kernel_size = std::max<Index>(12 - factors.rank(), 1);
      if (kernel_size > 8 || kernel_size == before) continue;
      before = kernel_size;
      const MatrixXd kernel = all.rightCols(kernel_size);
      // Rows of x3^(i+1) are x3 times those of x3^i for each solution, so a small eigenvalue problem separates them.
      const MatrixXd low = kernel.topRows(9), high = kernel.bottomRows(9);
      if (kernel_size == 1) {
        add_with_products(t, low.col(0).dot(high.col(0)) / low.col(0).squaredNorm(), kernel.col(0), candidates);
        continue;
      }
      const MatrixXd shift = CompleteOrthogonal(low).solve_columns(high);
      const GeneralEigenvectors shifts(shift);
      for (Index k = 0; k < kernel_size; ++k) {
        if (std::abs(shifts.values()[k].imag()) > 1e-3 * (1 + std::norm(shifts.values()[k]))) continue;
        add_with_products(t, shifts.values()[k].real(), kernel * shifts.vectors().col(k).real(), candidates);
      }
    }
  }

  void add_with_products(double t, double x3, const Eigen::VectorXd& products, LoopCandidates& candidates) {
    double upper = 0, lower = 0;
    for (Index i = 0; i < 4; ++i) {
      for (Index k = 0; k < 2; ++k) {
        upper += products[3 * i + k] * products[3 * i + k + 1];
        lower += products[3 * i + k] * products[3 * i + k];
      }
    }
    LoopCandidate candidate;
    candidate.angle[2] = t;
    candidate.angle[3] = kZero3 + 2 * std::atan(x3);
    candidate.angle[4] = kZero4 + 2 * std::atan2(upper, lower);
    add_first_two(candidate, candidates);
  }

  /// The first two angles bring the line to its goal, the last one the body about it.
  void add_first_two(LoopCandidate& candidate, LoopCandidates& candidates) {
    const RigidTransform inner = loop_.turns(2, 3, candidate.angle);
    const Vector3d line = inner.rotation * loop_.direction[5], point = inner * loop_.point[5];
    const Vector3d &u0 = loop_.direction[0], &u1 = loop_.direction[1];
    std::array<std::array<double, 2>, 4> first{};
    std::size_t count = 0;
    const auto add_from_points = [&] {
      // |E1 point - o0| across and along u0; used where directions say nothing.
      const Vector3d m = loop_.point[1] - loop_.point[0], w = point - loop_.point[1];
      const Vector3d across = w - u1 * u1.dot(w), aside = u1.cross(w);
      const double c = 2 * m.dot(across), s = 2 * m.dot(aside);
      const double rest =
          (goal_point_ - loop_.point[0]).squaredNorm() - m.squaredNorm() - w.squaredNorm() - 2 * m.dot(u1) * u1.dot(w);
      const double amplitude = std::hypot(c, s);
      if (!(amplitude > 0) || std::abs(rest) > 1.05 * amplitude) return;
      const double phase = std::atan2(s, c), half = std::acos(std::clamp(rest / amplitude, -1.0, 1.0));
      for (const double t1 : {phase + half, phase - half}) {
        const Vector3d reached = m + rotation_about(u1, t1) * w;
        first[count++] = {angle_about(u0, reached, goal_point_ - loop_.point[0]), t1};
      }
    };
    if (u0.cross(u1).norm() > 1e-6) {
      const RotaryBranches branches = turn_direction({loop_.direction.data(), 2}, line, goal_direction_, 0);
      for (int b = 0; b < branches.count; ++b) {
        const RotaryAngles& found = branches.branch[static_cast<std::size_t>(b)];
        first[count++] = {found.angle[0], found.angle[1]};
        if (found.singularity != RotarySingularity::none) add_from_points();
      }
    } else {
      add_from_points();
    }
    double least = 1e300;
    std::array<double, 4> miss{};
    for (std::size_t k = 0; k < count; ++k) {
      candidate.angle[0] = first[k][0];
      candidate.angle[1] = first[k][1];
      const RigidTransform outer = loop_.turns(0, 2, candidate.angle);
      miss[k] = goal_direction_.cross(outer * point - goal_point_).norm() +
                angle_between(outer.rotation * line, goal_direction_);
      least = std::min(least, miss[k]);
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (miss[k] > 10 * least + 1e-6) continue;
      candidate.angle[0] = first[k][0];
      candidate.angle[1] = first[k][1];
      const Matrix3d rest = loop_.turns(0, 5, candidate.angle).rotation.transpose() * loop_.target.rotation;
      candidate.angle[5] = turn_frame({&loop_.direction[5], 1}, rest, 0).branch[0].angle[0];
      candidates.add(candidate);
    }
  }

  SixAxisLoop loop_;
  Vector3d goal_point_, goal_direction_;
  std::array<Eigen::Matrix<double, 14, 9>, 3> rows_;  ///< by 1, c, s of the hidden angle; powers of x3 times x4
  Index equations_ = 0;
  HiddenMatrix matrix_;
  double zero_ = 0, condition_ = 0;
  std::array<double, 24> hidden_{};
  std::size_t hidden_count_ = 0;
};

}  // namespace

void add_general_candidates(const SixAxisLoop& given, LoopCandidates& candidates) {
  // The loop may be begun at any axis. Where pairs of axes meet or are parallel, some beginnings have equations that
  // are dependent for every angle, or a right side of lower rank: those come last. And solutions may share an angle
  // there, so that more than one beginning is tried.
  constexpr double kIrregular = 1e-3;
  struct Beginning {
    double quality = 0;
    std::size_t axis = 0;
  };
  const double size = given.size();
  SixAxisLoop scaled = given;
  for (Vector3d& point : scaled.point) point /= size;
  scaled.target.translation /= size;
  constexpr double kSingular = 1e-9;
  bool special = false;
  std::array<Beginning, kLoopAxes> beginnings;
  for (std::size_t i = 0; i < kLoopAxes; ++i) {
    GeneralLoop loop(scaled.begun_at(i));
    loop.eliminate();
    beginnings[i] = {loop.condition() * (loop.is_regular() ? 1 : kIrregular), i};
    special = special || !loop.is_regular() || loop.condition() < kSingular;
  }
  std::sort(beginnings.begin(), beginnings.end(),
            [](const Beginning& a, const Beginning& b) { return a.quality > b.quality; });
  for (std::size_t k = 0; k < (special ? 3U : 1U); ++k) {
    GeneralLoop loop(scaled.begun_at(beginnings[k].axis));
    LoopCandidates found;
    loop.eliminate();
    loop.solve(found);
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].angle = SixAxisLoop::in_first_order(found[i].angle, beginnings[k].axis);
      candidates.add(found[i]);
    }
  }
}

}  // namespace abbe
