#pragma once

#include <Interface_Graph.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <map>
#include <string>
#include <vector>

namespace abbe {

/// Entities of shape, place or size that OpenCASCADE could not read; it goes on with zeros there.
struct BadEntities {
  std::map<const Standard_Transient*, std::string>
      problems;    ///< "#22 (SphericalSurface): Count of Parameters is not 3"
  int others = 0;  ///< that make no shape
};

BadEntities bad_entities(const StepData_StepModel& model);

/// @throws std::runtime_error for the first of the bad entities, unless faces may be left out and it is faces alone
/// that refer to them
void require_sound_entities(const StepData_StepModel& model, const Interface_Graph& graph, const BadEntities& bad,
                            bool leave_out_faces);

/// The problem of a bad entity that this one refers to, directly or not, or null.
const std::string* problem_below(const Interface_Graph& graph, const Handle(Standard_Transient) & entity,
                                 const BadEntities& bad);

/// "#78": what the file calls an entity.
std::string entity_label(const Interface_InterfaceModel& model, const Handle(Standard_Transient) & entity);

/// "ConicalSurface" of a face, as the schema names it; empty if there is none.
std::string surface_type(const StepShape_FaceSurface& face);

/// Names of the files that hold geometry of this one.
std::vector<std::string> files_referred_to(const Interface_InterfaceModel& model);

}  // namespace abbe
