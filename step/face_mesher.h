#pragma once

#include <IMeshData_Face.hxx>
#include <IMeshTools_MeshAlgoFactory.hxx>
#include <TopoDS_Face.hxx>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "face_deviation.h"
#include "time_limit.h"

namespace abbe {

/// What became of one face.
struct DividedFace {
  std::size_t method = 0;  ///< algorithm to begin with, of those in face_mesher.cpp
  FaceDeviation deviation{};
  std::string problem;     ///< why it has no triangles; empty if it has
  bool timed_out = false;  ///< whether that is because it took too long
};

/// Divides faces one by one, each as finely as it needs (refine_face()); OpenCASCADE's mesher has one deflection for
/// all faces. Where one of OpenCASCADE's algorithms gives a face no triangles, the others are tried.
class FaceMesher {
 public:
  /// @param chord_mm      largest deviation wanted
  /// @param face_seconds  for one face, after which it has a problem
  /// @param limit         for all; faces after it have a problem
  /// @param face_is_done  called for every face, by several threads
  FaceMesher(double chord_mm, double face_seconds, Handle(TimeLimit) limit, std::function<void()> face_is_done);

  /// For BRepMesh_FaceDiscret, which calls what it makes for several faces at a time. This object must outlive it.
  Handle(IMeshTools_MeshAlgoFactory) factory();

  /// The last division of a face, with which the next one begins; nothing if OpenCASCADE never came to the face.
  std::optional<DividedFace> result(const TopoDS_Face& face) const;

  /// A face that once took too long is not tried again: each trial takes as long.
  void divide(const IMeshData::IFaceHandle& face, const IMeshTools_Parameters& parameters);

 private:
  struct OneFace;
  void divide_finely_enough(OneFace& one) const;
  void keep(const TopoDS_Face& face, const DividedFace& result);

  double chord_mm_, face_seconds_;
  Handle(TimeLimit) limit_;
  std::function<void()> face_is_done_;
  mutable std::mutex mutex_;
  std::map<const void*, DividedFace> results_;  ///< by TShape
};

}  // namespace abbe
