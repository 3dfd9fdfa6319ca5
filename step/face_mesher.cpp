#include "face_mesher.h"

#include <fmt/format.h>

#include <BRepMesh_DelabellaMeshAlgoFactory.hxx>
#include <BRepMesh_MeshAlgoFactory.hxx>
#include <IMeshData_Face.hxx>
#include <IMeshTools_MeshAlgo.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Precision.hxx>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "face_refinement.h"
#include "failure_words.h"

namespace abbe {
namespace {

/// The algorithms in the order in which they are tried: the one that OpenCASCADE has for this kind of surface, the same
/// with its other triangulation, and both with the algorithm for B-spline surfaces, which suits every kind.
enum Method : std::size_t { kOwn, kOwnDelabella, kAny, kAnyDelabella, kMethods };

Handle(IMeshTools_MeshAlgo)
    algorithm(std::size_t method, GeomAbs_SurfaceType type, const IMeshTools_Parameters& parameters) {
  const GeomAbs_SurfaceType as = method == kAny || method == kAnyDelabella ? GeomAbs_BSplineSurface : type;
  if (method == kOwnDelabella || method == kAnyDelabella)
    return BRepMesh_DelabellaMeshAlgoFactory().GetAlgo(as, parameters);
  return BRepMesh_MeshAlgoFactory().GetAlgo(as, parameters);
}

/// What BRepMesh_FaceDiscret calls.
class MeasuredDivision : public IMeshTools_MeshAlgo {
 public:
  explicit MeasuredDivision(FaceMesher& mesher) : mesher_(mesher) {}
  void Perform(const IMeshData::IFaceHandle& face, const IMeshTools_Parameters& parameters,
               const Message_ProgressRange& /*range*/) override {
    mesher_.divide(face, parameters);
  }

 private:
  FaceMesher& mesher_;
};

class MeasuredDivisions : public IMeshTools_MeshAlgoFactory {
 public:
  explicit MeasuredDivisions(FaceMesher& mesher) : mesher_(mesher) {}
  Handle(IMeshTools_MeshAlgo)
      GetAlgo(GeomAbs_SurfaceType /*type*/, const IMeshTools_Parameters& /*parameters*/) const override {
    return new MeasuredDivision(mesher_);
  }

 private:
  FaceMesher& mesher_;
};

}  // namespace

struct FaceMesher::OneFace {
  const IMeshData::IFaceHandle& face;
  const IMeshTools_Parameters& parameters;
  Handle(TimeLimit) limit;
  DividedFace result;

  /// @returns false if there are no triangles then. @throws TimeIsUp
  bool divide(double chord_mm) {
    IMeshTools_Parameters of_chord = parameters;
    of_chord.DeflectionInterior = chord_mm;
    of_chord.MinSize = std::max(IMeshTools_Parameters::RelMinSize() * std::min(chord_mm, parameters.Deflection),
                                Precision::Confusion());
    face->SetDeflection(chord_mm);
    face->UnsetStatus(IMeshData_Failure);
    algorithm(result.method, face->GetSurface()->GetType(), of_chord)->Perform(face, of_chord, limit->Start());
    if (limit->is_over()) throw TimeIsUp{};
    return !face->IsSet(IMeshData_Failure) && has_triangles(face->GetFace());
  }
};

FaceMesher::FaceMesher(double chord_mm, double face_seconds, Handle(TimeLimit) limit,
                       std::function<void()> face_is_done)
    : chord_mm_(chord_mm),
      face_seconds_(face_seconds),
      limit_(std::move(limit)),
      face_is_done_(std::move(face_is_done)) {}

Handle(IMeshTools_MeshAlgoFactory) FaceMesher::factory() { return new MeasuredDivisions(*this); }

std::optional<DividedFace> FaceMesher::result(const TopoDS_Face& face) const {
  const std::lock_guard lock(mutex_);
  const auto at = results_.find(face.TShape().get());
  return at != results_.end() ? std::optional(at->second) : std::nullopt;
}

void FaceMesher::keep(const TopoDS_Face& face, const DividedFace& result) {
  const std::lock_guard lock(mutex_);
  results_[face.TShape().get()] = result;
}

void FaceMesher::divide(const IMeshData::IFaceHandle& face, const IMeshTools_Parameters& parameters) {
  OneFace one{face, parameters, new TimeLimit(std::min(TimeLimit::after(face_seconds_), limit_->end())),
              result(face->GetFace()).value_or(DividedFace{})};
  if (!one.result.timed_out) {
    try {
      const std::string problem = problem_of([&] { divide_finely_enough(one); });
      one.result.problem = problem.empty() ? "" : kNotDivided + problem;
    } catch (const TimeIsUp&) {
      one.result.problem = fmt::format("was not divided into triangles within {:.3g} s", face_seconds_);
      one.result.timed_out = true;
    }
    keep(face->GetFace(), one.result);
  }
  face_is_done_();
}

void FaceMesher::divide_finely_enough(OneFace& one) const {
  while (!one.divide(chord_mm_)) {
    if (++one.result.method < kMethods) continue;
    // Along other edges the first one may succeed.
    one.result.method = kOwn;
    throw std::runtime_error(kNoneFound);
  }
  one.result.deviation = refine_face(one.face->GetFace(), chord_mm_, *one.limit);
}

}  // namespace abbe
