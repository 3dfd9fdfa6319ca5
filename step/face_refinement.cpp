#include "face_refinement.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRep_Builder.hxx>
#include <Poly_Triangulation.hxx>
#include <TopLoc_Location.hxx>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "abbe/geometry/surface/halved_triangle.h"

namespace abbe {
namespace {

constexpr int kMostPasses = 20;
/// Halving that brings less than this in some passes does not help.
constexpr double kPassGain = 0.9;
constexpr int kPassesWithoutGain = 3;

/// Of the chord: how near a triangle is matters no more below it.
constexpr double kSmall = 0.5;

class Refinement {
 public:
  Refinement(const TopoDS_Face& face, double chord_mm, const TimeLimit& limit)
      : face_(face), surface_(face, Standard_False), chord_mm_(chord_mm), limit_(limit) {
    const Handle(Poly_Triangulation) triangulation = triangles_of(face, location_);
    has_parameters_ = triangulation->HasUVNodes();
    for (int i = 1; i <= triangulation->NbNodes(); ++i) {
      points_.push_back(triangulation->Node(i).Transformed(location_.Transformation()).XYZ());
      if (has_parameters_) parameters_.push_back(triangulation->UVNode(i).XY());
    }
    for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
      int a = 0, b = 0, c = 0;
      triangulation->Triangle(i).Get(a, b, c);
      triangles_.push_back({index(a), index(b), index(c)});
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
  using Middles = std::unordered_map<std::uint64_t, std::uint32_t>;  ///< by side_key()

  /// OpenCASCADE counts nodes from 1.
  static std::uint32_t index(int node) { return static_cast<std::uint32_t>(node - 1); }
  static int node(std::uint32_t index) { return static_cast<int>(index) + 1; }

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
          const std::uint32_t node = triangles_[i][k];
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
  double bulge(std::uint32_t a, std::uint32_t b) const {
    const gp_XY middle = 0.5 * (parameters_[a] + parameters_[b]);
    return (surface_.Value(middle.X(), middle.Y()).XYZ() - 0.5 * (points_[a] + points_[b])).Modulus();
  }

  /// The sides to be halved. @returns false if there are none
  bool halve(const FaceDeviation& whole) {
    std::unordered_map<std::uint64_t, int> triangles_at;
    triangles_at.reserve(2 * triangles_.size());
    for (const TriangleCorners& t : triangles_) {
      for (std::size_t k = 0; k < 3; ++k) ++triangles_at[side_key(t[k], t[(k + 1) % 3])];
    }
    Middles middles;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (is_near_enough(measured_[i].deviation, whole)) continue;
      const TriangleCorners& t = triangles_[i];
      double largest = -1;
      std::pair<std::uint32_t, std::uint32_t> worst;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        if (triangles_at[side_key(a, b)] != 2) continue;
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

  void add_middle(std::uint32_t a, std::uint32_t b, Middles& middles) {
    if (!middles.try_emplace(side_key(a, b), static_cast<std::uint32_t>(points_.size())).second) return;
    const gp_XY middle = 0.5 * (parameters_[a] + parameters_[b]);
    parameters_.push_back(middle);
    points_.push_back(surface_.Value(middle.X(), middle.Y()).XYZ());
  }

  void divide_at(const Middles& middles) {
    const auto middle_of = [&](std::uint32_t a, std::uint32_t b) {
      const auto at = middles.find(side_key(a, b));
      return at != middles.end() ? at->second : kNoMiddle;
    };
    const auto squared_distance = [&](std::uint32_t a, std::uint32_t b) {
      return (points_[a] - points_[b]).SquareModulus();
    };
    std::vector<TriangleCorners> divided;
    std::vector<Measured> measured;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const TriangleCorners& t = triangles_[i];
      add_halved(t, {middle_of(t[0], t[1]), middle_of(t[1], t[2]), middle_of(t[2], t[0])}, squared_distance,
                 [&](const TriangleCorners& part) {
                   divided.push_back(part);
                   measured.push_back(part == t ? measured_[i] : Measured{});
                 });
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
      const TriangleCorners& t = triangles_[i];
      triangulation->SetTriangle(static_cast<int>(i) + 1, Poly_Triangle(node(t[0]), node(t[1]), node(t[2])));
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
  std::vector<TriangleCorners> triangles_;
  std::vector<Measured> measured_;
};

}  // namespace

FaceDeviation refine_face(const TopoDS_Face& face, double chord_mm, const TimeLimit& limit) {
  return Refinement(face, chord_mm, limit).run();
}

}  // namespace abbe
