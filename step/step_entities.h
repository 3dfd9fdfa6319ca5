#pragma once

#include <Interface_Graph.hxx>
#include <StepData_StepModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace abbe {

/// An entity that OpenCASCADE could not read; it goes on with zeros there.
struct BadEntity {
  const Standard_Transient* entity = nullptr;
  std::string problem;  ///< "#22 (SphericalSurface): Count of Parameters is not 3"
};

struct BadEntities {
  std::vector<BadEntity> of_shape;  ///< of shape, place or size, in the order of the file
  std::size_t others = 0;           ///< that are not geometry
};

BadEntities bad_entities(const StepData_StepModel& model);

/// Where bad entities belong to faces that something in the file refers to.
struct BadFaces {
  /// By the number of the face in the model: "#21 (SphericalSurface) refers to #22 (SphericalSurface): Count of ...".
  std::map<int, std::string> problems;
  /// Bad entities that no face in use needs: those of parameter-space curves (pcurves), each of which is given besides
  /// the curve in space and for both faces along an edge, and those of faces that nothing refers to.
  std::size_t not_needed = 0;
};

/// @throws std::runtime_error for the first bad entity, in the order of the file, that does not belong to faces alone
BadFaces bad_faces(const StepData_StepModel& model, const Interface_Graph& graph, const BadEntities& bad);

/// "#78": what the file calls an entity.
std::string entity_label(const Interface_InterfaceModel& model, const Handle(Standard_Transient) & entity);

/// "#78 (ConicalSurface)": a face with its surface as the schema names it; without that if there is none.
std::string face_label(const Interface_InterfaceModel& model, const Handle(StepShape_FaceSurface) & face);

/// The faces that something in the file refers to, by their numbers in the model.
std::map<int, Handle(StepShape_FaceSurface)> faces_in_use(const Interface_InterfaceModel& model,
                                                          const Interface_Graph& graph);

/// Names of the files that hold geometry of this one.
std::vector<std::string> files_referred_to(const Interface_InterfaceModel& model);

}  // namespace abbe
