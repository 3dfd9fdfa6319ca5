#include "face_refinement.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <TopLoc_Location.hxx>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

namespace abbe {
namespace {

constexpr int kMostPasses = 20;
/// Halving that brings less than this in some passes does not help.
constexpr double kPassGain = 0.9;
constexpr int kPassesWithoutGain = 3;

/// Of the chord: how near a triangle is matters no more below it.
constexpr double kSmall = 0.5;

using Corners = std::array<int, 3>;

/// A side, whichever way it runs.
std::uint64_t side_of(int a, int b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32U) | static_cast<std::uint64_t>(std::max(a, b));
}

class Refinement {
 public:
  Refinement(const TopoDS_Face& face, double chord_mm, const TimeLimit& limit)
      : face_(face), surface_(face, Standard_False), chord_mm_(chord_mm), limit_(limit) {
    const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location_);
    if (triangulation.IsNull() || triangulation->NbTriangles() == 0) throw std::runtime_error("it has no triangles");
    has_parameters_ = triangulation->HasUVNodes();
    for (int i = 1; i <= triangulation->NbNodes(); ++i) {
      points_.push_back(triangulation->Node(i).Transformed(location_.Transformation()).XYZ());
      if (has_parameters_) parameters_.push_back(triangulation->UVNode(i).XY());
    }
    for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
      Corners corners{};
      triangulation->Triangle(i).Get(corners[0], corners[1], corners[2]);
      for (int& corner : corners) --corner;
      triangles_.push_back(corners);
    }
    measured_.resize(triangles_.size());
  }

  FaceDeviation run() {
    FaceDeviation largest = measure();
    double best = largest.triangles_mm;
    int without_gain = 0;
    for (int pass = 0; pass < kMostPasses && !is_near_enough(largest) && has_parameters_; ++pass) {
      if (!halve(largest)) break;
      changed_ = true;
      largest = measure();
      without_gain = largest.triangles_mm > kPassGain * best ? without_gain + 1 : 0;
      best = std::min(best, largest.triangles_mm);
      if (without_gain == kPassesWithoutGain) break;
    }
    if (changed_) store();
    return largest;
  }

 private:
  struct Measured {
    bool is = false;
    FaceDeviation deviation;
  };

  bool is_near_enough(const FaceDeviation& deviation, const FaceDeviation& whole) const {
    return kBetweenPoints * deviation.triangles_mm <= chord_mm_ + unavoidable_mm(whole, chord_mm_);
  }
  bool is_near_enough(const FaceDeviation& whole) const { return is_near_enough(whole, whole); }

  FaceDeviation measure() {
    FaceDeviation largest;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (!measured_[i].is) {
        if (i % 64 == 0 && limit_.is_over()) throw TimeIsUp{};
        std::array<gp_XYZ, 3> corners;
        std::array<gp_XY, 3> parameters;
        for (std::size_t k = 0; k < 3; ++k) {
          const auto node = static_cast<std::size_t>(triangles_[i][k]);
          corners[k] = points_[node];
          if (has_parameters_) parameters[k] = parameters_[node];
        }
        measured_[i] = {
            true, triangle_deviation(surface_, corners, has_parameters_ ? &parameters : nullptr, kSmall * chord_mm_)};
      }
      largest.triangles_mm = std::max(largest.triangles_mm, measured_[i].deviation.triangles_mm);
      largest.corners_mm = std::max(largest.corners_mm, measured_[i].deviation.corners_mm);
    }
    return largest;
  }

  /// Distance of the middle of a side from what becomes its middle.
  double bulge(int a, int b) const {
    const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
    const gp_XY middle = 0.5 * (parameters_[i] + parameters_[k]);
    return (surface_.Value(middle.X(), middle.Y()).XYZ() - 0.5 * (points_[i] + points_[k])).Modulus();
  }

  /// The sides to be halved. @returns false if there are none
  bool halve(const FaceDeviation& whole) {
    std::unordered_map<std::uint64_t, int> triangles_at;
    triangles_at.reserve(2 * triangles_.size());
    for (const Corners& t : triangles_) {
      for (std::size_t k = 0; k < 3; ++k) ++triangles_at[side_of(t[k], t[(k + 1) % 3])];
    }
    std::unordered_map<std::uint64_t, int> middles;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (is_near_enough(measured_[i].deviation, whole)) continue;
      const Corners& t = triangles_[i];
      double largest = -1;
      std::pair<int, int> worst;
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        if (triangles_at[side_of(a, b)] != 2) continue;
        const double distance = bulge(a, b);
        if (distance > largest) {
          largest = distance;
          worst = {a, b};
        }
        if (distance > 0.5 * chord_mm_) add_middle(a, b, middles);
      }
      if (largest >= 0) add_middle(worst.first, worst.second, middles);
    }
    if (middles.empty()) return false;
    divide_at(middles);
    return true;
  }

  void add_middle(int a, int b, std::unordered_map<std::uint64_t, int>& middles) {
    const auto [at, is_new] = middles.try_emplace(side_of(a, b), static_cast<int>(points_.size()));
    if (!is_new) return;
    const gp_XY middle = 0.5 * (parameters_[static_cast<std::size_t>(a)] + parameters_[static_cast<std::size_t>(b)]);
    parameters_.push_back(middle);
    points_.push_back(surface_.Value(middle.X(), middle.Y()).XYZ());
  }

  void divide_at(const std::unordered_map<std::uint64_t, int>& middles) {
    std::vector<Corners> divided;
    std::vector<Measured> measured;
    const auto add = [&](int a, int b, int c) {
      divided.push_back({a, b, c});
      measured.emplace_back();
    };
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      Corners t = triangles_[i];
      std::array<int, 3> middle{-1, -1, -1};
      int count = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = middles.find(side_of(t[k], t[(k + 1) % 3]));
        if (at != middles.end()) {
          middle[k] = at->second;
          ++count;
        }
      }
      if (count == 0) {
        divided.push_back(t);
        measured.push_back(measured_[i]);
        continue;
      }
      // Turned until the first side is one with a middle, and the third is without one if any is.
      while (middle[0] < 0 || (count == 2 && middle[2] >= 0)) {
        std::rotate(t.begin(), t.begin() + 1, t.end());
        std::rotate(middle.begin(), middle.begin() + 1, middle.end());
      }
      const int a = t[0], b = t[1], c = t[2], ab = middle[0], bc = middle[1], ca = middle[2];
      if (count == 1) {
        add(a, ab, c);
        add(ab, b, c);
      } else if (count == 2) {
        add(ab, b, bc);
        const auto apart = [&](int p, int q) {
          return (points_[static_cast<std::size_t>(p)] - points_[static_cast<std::size_t>(q)]).SquareModulus();
        };
        const bool from_a = apart(a, bc) < apart(ab, c);
        add(a, ab, from_a ? bc : c);
        add(from_a ? a : ab, bc, c);
      } else {
        add(a, ab, ca);
        add(ab, b, bc);
        add(ca, bc, c);
        add(ab, bc, ca);
      }
    }
    triangles_ = std::move(divided);
    measured_ = std::move(measured);
  }

  /// In the face. Nodes keep their numbers, by which the edges know theirs.
  void store() const {
    const gp_Trsf face_from_part = location_.Transformation().Inverted();
    const Handle(Poly_Triangulation) triangulation =
        new Poly_Triangulation(static_cast<int>(points_.size()), static_cast<int>(triangles_.size()), Standard_True);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      triangulation->SetNode(static_cast<int>(i) + 1, gp_Pnt(points_[i]).Transformed(face_from_part));
      triangulation->SetUVNode(static_cast<int>(i) + 1, parameters_[i]);
    }
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const Corners& t = triangles_[i];
      triangulation->SetTriangle(static_cast<int>(i) + 1, Poly_Triangle(t[0] + 1, t[1] + 1, t[2] + 1));
    }
    triangulation->Deflection(chord_mm_);
    BRep_Builder().UpdateFace(face_, triangulation);
  }

  const TopoDS_Face& face_;
  BRepAdaptor_Surface surface_;
  double chord_mm_;
  const TimeLimit& limit_;
  TopLoc_Location location_;
  bool has_parameters_ = false, changed_ = false;
  std::vector<gp_XYZ> points_;  ///< in the part
  std::vector<gp_XY> parameters_;
  std::vector<Corners> triangles_;
  std::vector<Measured> measured_;
};

}  // namespace

FaceDeviation refine_face(const TopoDS_Face& face, double chord_mm, const TimeLimit& limit) {
  return Refinement(face, chord_mm, limit).run();
}

}  // namespace abbe
