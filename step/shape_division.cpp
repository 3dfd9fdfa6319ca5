#include "shape_division.h"

#include <fmt/format.h>

#include <BRepAdaptor_Curve.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_Context.hxx>
#include <BRepMesh_FaceDiscret.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IMeshData_Edge.hxx>
#include <IMeshData_Face.hxx>
#include <IMeshData_Model.hxx>
#include <IMeshData_PCurve.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "face_deviation.h"
#include "face_mesher.h"
#include "failure_words.h"

namespace abbe {
namespace {

constexpr int kMostRounds = 8, kMostEdgeRounds = 12;
/// Where so many rounds bring less than this, finer edges do not decide either.
constexpr double kRoundGain = 0.95;
constexpr int kRoundsWithoutGain = 2;
/// A face narrower than this part of the chord has no area to be covered.
constexpr double kNoWidth = 0.1;

/// Faces of the shape, each once.
std::vector<TopoDS_Face> faces_of(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Face> faces;
  std::set<const void*> seen;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    if (seen.insert(face.Current().TShape().get()).second) faces.push_back(TopoDS::Face(face.Current()));
  }
  return faces;
}

/// Nothing for an edge that cannot be measured, such as one with a point that is not finite: its faces cannot be
/// measured either, and are named for that.
double edge_deviation(const IMeshData_Edge& edge) {
  const IMeshData::ICurveHandle& points = edge.GetCurve();
  if (edge.GetDegenerated() || points.IsNull()) return 0;
  double largest = 0;
  const std::string problem = problem_of([&] {
    const BRepAdaptor_Curve curve(edge.GetEdge());
    for (int i = 1; i < points->ParametersNb(); ++i) {
      const double from = points->GetParameter(i - 1), to = points->GetParameter(i);
      largest =
          std::max(largest, curve_deviation(curve, from, to, points->GetPoint(i - 1).XYZ(), points->GetPoint(i).XYZ()));
    }
  });
  return problem.empty() ? largest : 0;
}

IMeshTools_Parameters parameters_for(double edge_deflection_mm, const DivisionOptions& options) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = std::max(edge_deflection_mm, Precision::Confusion());
  parameters.DeflectionInterior = parameters.Deflection;
  parameters.MinSize = std::max(IMeshTools_Parameters::RelMinSize() * parameters.Deflection, Precision::Confusion());
  parameters.Angle = options.angle_rad;
  parameters.AngleInterior = options.angle_rad;
  parameters.Relative = Standard_False;
  parameters.CleanModel = Standard_False;
#ifndef ABBE_SANITIZED
  // Faces one by one give the same triangles; the thread sanitizer does not see OpenCASCADE's locks.
  parameters.InParallel = Standard_True;
#endif
  return parameters;
}

/// Divides the edges until they keep to the chord, if they do. @returns with the deflection that was needed
Handle(IMeshTools_Context)
    divided_edges(const TopoDS_Shape& shape, const DivisionOptions& options, double& deflection_mm) {
  Handle(IMeshTools_Context) context;
  for (int round = 0; round < kMostEdgeRounds; ++round) {
    BRepTools::Clean(shape);
    context = new BRepMesh_Context(IMeshTools_MeshAlgoType_Watson);
    context->SetShape(shape);
    context->ChangeParameters() = parameters_for(deflection_mm, options);
    if (!context->BuildModel() || !context->DiscretizeEdges())
      throw std::runtime_error("the edges could not be divided");
    double deviation = 0;
    for (int i = 0; i < context->GetModel()->EdgesNb(); ++i) {
      deviation = std::max(deviation, edge_deviation(*context->GetModel()->GetEdge(i)));
    }
    if (options.limit->is_over()) throw TimeIsUp{};
    deviation *= kBetweenPoints;
    if (!(deviation > options.chord_mm)) break;
    deflection_mm *= std::clamp(0.95 * options.chord_mm / deviation, 0.3, 0.9);
  }
  return context;
}

/// OpenCASCADE's reader may take the two parameter-space curves (pcurves) of a seam for one another. Its mesher
/// corrects only their ends, and later inserts points between them where the face is a cone: the curves then cross to
/// the other side and back, and the face is not divided (https://github.com/Open-Cascade-SAS/OCCT/issues/572).
void exchange_curves_of_seams(const IMeshData_Model& model) {
  for (int i = 0; i < model.EdgesNb(); ++i) {
    const IMeshData::IEdgeHandle& edge = model.GetEdge(i);
    if (edge->PCurvesNb() != 2 || edge->GetPCurve(0)->GetFace() != edge->GetPCurve(1)->GetFace()) continue;
    const IMeshData::IPCurveHandle &one = edge->GetPCurve(0), &other = edge->GetPCurve(1);
    const int last = one->ParametersNb() - 1;
    if (last < 2 || other->ParametersNb() != last + 1) continue;
    const auto is_nearer_to_other = [&](int at, int end) {
      const gp_Pnt2d of_one = one->GetPoint(at), of_other = other->GetPoint(at);
      return of_one.Distance(other->GetPoint(end)) < of_one.Distance(one->GetPoint(end)) &&
             of_other.Distance(one->GetPoint(end)) < of_other.Distance(other->GetPoint(end));
    };
    if (!is_nearer_to_other(1, 0) || !is_nearer_to_other(last - 1, last)) continue;
    for (int k = 1; k < last; ++k) std::swap(one->GetPoint(k), other->GetPoint(k));
  }
}

/// Area over half of the circumference, in mm; not a number where OpenCASCADE does not find them.
double mean_width(const TopoDS_Face& face) try {
  GProp_GProps length;
  BRepGProp::LinearProperties(face, length);
  return length.Mass() > 0 ? 2 * face_area_mm2(face) / length.Mass() : 0;
} catch (const Standard_Failure&) {
  return std::numeric_limits<double>::quiet_NaN();
}

/// What the statuses of a face without triangles say.
std::string words_for_status(const IMeshData_Face& face) {
  // OpenCASCADE marks an open wire, but not its face.
  if (face.IsSet(IMeshData_SelfIntersectingWire)) return "its edges cross one another or do not close";
  if (face.IsSet(IMeshData_TooFewPoints)) return "its edges enclose nothing";
  return kNoneFound;
}

class Division {
 public:
  Division(const TopoDS_Shape& shape, const DivisionOptions& options)
      : shape_(shape),
        options_(options),
        faces_(faces_of(shape)),
        mesher_(options.chord_mm, options.face_seconds, options.limit, [this] { face_is_done(); }) {}

  ShapeDivision run() {
    double edge_deflection = options_.chord_mm, last = std::numeric_limits<double>::infinity();
    int without_gain = 0;
    bool tried_finer = false;
    for (int round = 0; round < kMostRounds; ++round) {
      const ShapeDivision result = divided_along(edge_deflection);
      if (round == 0 || is_better(result, best_)) keep(result);
      const bool may_help =
          std::any_of(result.lost.begin(), result.lost.end(), [](const LostFace& face) { return !face.timed_out; });
      if (may_help && !tried_finer) {
        // Coarse pieces of edges may cross one another where the edges do not.
        tried_finer = true;
        edge_deflection *= 0.3;
        continue;
      }
      if (result.excess_mm <= options_.chord_mm) break;
      without_gain = result.excess_mm > kRoundGain * last ? without_gain + 1 : 0;
      if (without_gain == kRoundsWithoutGain) break;
      last = result.excess_mm;
      edge_deflection *= std::clamp(0.95 * options_.chord_mm / result.excess_mm, 0.3, 0.9);
    }
    for (std::size_t i = 0; i < faces_.size(); ++i) BRep_Builder().UpdateFace(faces_[i], best_triangles_[i]);
    return best_;
  }

 private:
  /// Of divisions that keep to the chord the earlier one is as good.
  bool is_better(const ShapeDivision& one, const ShapeDivision& other) const {
    if (one.lost.size() != other.lost.size()) return one.lost.size() < other.lost.size();
    return one.excess_mm < other.excess_mm && other.excess_mm > options_.chord_mm;
  }

  void keep(const ShapeDivision& division) {
    best_ = division;
    best_triangles_.clear();
    for (const TopoDS_Face& face : faces_) {
      TopLoc_Location location;
      best_triangles_.push_back(BRep_Tool::Triangulation(face, location));
    }
  }

  void face_is_done() {
    if (options_.progress) options_.progress(std::min(++done_, faces_.size()), faces_.size());
  }

  ShapeDivision divided_along(double& edge_deflection_mm) {
    done_ = 0;
    const Handle(IMeshTools_Context) context = divided_edges(shape_, options_, edge_deflection_mm);
    context->SetFaceDiscret(new BRepMesh_FaceDiscret(mesher_.factory()));
    context->HealModel();
    context->PreProcessModel();
    exchange_curves_of_seams(*context->GetModel());
    context->DiscretizeFaces(options_.limit->Start());
    if (options_.limit->is_over()) throw TimeIsUp{};
    context->PostProcessModel();
    std::map<const void*, std::string> statuses;
    for (int i = 0; i < context->GetModel()->FacesNb(); ++i) {
      const IMeshData::IFaceHandle& face = context->GetModel()->GetFace(i);
      statuses[face->GetFace().TShape().get()] = words_for_status(*face);
    }
    ShapeDivision result;
    for (const TopoDS_Face& face : faces_) add(face, statuses[face.TShape().get()], result);
    return result;
  }

  void add(const TopoDS_Face& face, const std::string& status, ShapeDivision& result) const {
    DividedFace divided = mesher_.result(face).value_or(DividedFace{.problem = kNotDivided + status});
    double edges_mm = 0;
    const std::string problem = problem_of([&] { edges_mm = edges_deviation(face); });
    if (!problem.empty() && mean_width(face) < kNoWidth * options_.chord_mm) {
      ++result.without_area;
      return;
    }
    if (divided.problem.empty() && !problem.empty()) divided.problem = kNotDivided + problem;
    if (!divided.problem.empty()) {
      result.lost.push_back({face, divided.problem, divided.timed_out});
      return;
    }
    const double deviation = kBetweenPoints * std::max(edges_mm, divided.deviation.triangles_mm);
    const ShapeDivision::Off off{face, deviation, divided.deviation.corners_mm};
    if (result.farthest.face.IsNull() || deviation > result.farthest.deviation_mm) result.farthest = off;
    const double excess = deviation - unavoidable_mm(divided.deviation, options_.chord_mm);
    if (result.most_in_excess.face.IsNull() || excess > result.excess_mm) {
      result.excess_mm = std::max(excess, 0.0);
      result.most_in_excess = off;
    }
  }

  const TopoDS_Shape& shape_;
  const DivisionOptions& options_;
  std::vector<TopoDS_Face> faces_;
  FaceMesher mesher_;
  ShapeDivision best_;
  std::vector<Handle(Poly_Triangulation)> best_triangles_;  ///< [faces]
  std::atomic<std::size_t> done_{0};
};

}  // namespace

ShapeDivision divide_shape(const TopoDS_Shape& shape, const DivisionOptions& options) {
  return Division(shape, options).run();
}

}  // namespace abbe
