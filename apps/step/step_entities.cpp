#include "step_entities.h"

#include <fmt/format.h>

#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <StepBasic_DocumentFile.hxx>
#include <StepBasic_DocumentType.hxx>
#include <StepGeom_Pcurve.hxx>
#include <StepGeom_Surface.hxx>
#include <StepRepr_DescriptiveRepresentationItem.hxx>
#include <StepRepr_Representation.hxx>
#include <TCollection_HAsciiString.hxx>
#include <algorithm>
#include <set>
#include <stdexcept>
#include <string_view>

namespace abbe {
namespace {

using Entities = std::set<const Standard_Transient*>;

std::string type_name(const Handle(Standard_Transient) & entity) {
  std::string type = entity->DynamicType()->Name();
  type.erase(0, type.find('_') + 1);
  return type;
}

/// True for what shape, place and size come from.
bool makes_the_shape(const Handle(Standard_Transient) & entity) {
  const std::string_view type = entity->DynamicType()->Name();
  // Words: the name of a material, say.
  if (entity->IsKind(STANDARD_TYPE(StepRepr_DescriptiveRepresentationItem))) return false;
  if (type.starts_with("StepBasic_")) {
    // Units and what assemblies are made of, but not persons, dates, approvals or roles.
    const auto has = [&](const char* word) { return type.find(word) != std::string_view::npos; };
    return has("Unit") || has("Measure") || has("Dimension") || has("Product");
  }
  return type.starts_with("StepGeom_") || type.starts_with("StepShape_") || type.starts_with("StepRepr_");
}

/// True where the only thing wrong is that a list of items has one that is no geometry, such as a note of a drawing. A
/// face that is missed for such a reason is found by its not becoming one.
bool has_foreign_items_only(const Handle(Standard_Transient) & entity, const Interface_Check& check) {
  if (!entity->IsKind(STANDARD_TYPE(StepRepr_Representation))) return false;
  for (int i = 1; i <= check.NbFails(); ++i) {
    const std::string_view fail = check.CFail(i);
    if (fail.find("representation_item") == std::string_view::npos ||
        fail.find("illegal type") == std::string_view::npos) {
      return false;
    }
  }
  return check.NbFails() > 0;
}

/// Adds an entity and all that it refers to, down to faces, which are left out.
void add_above_faces(const Interface_Graph& graph, const Handle(Standard_Transient) & entity, Entities& found) {
  if (entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface)) || !found.insert(entity.get()).second) return;
  Interface_EntityIterator parts = graph.Shareds(entity);
  for (parts.Start(); parts.More(); parts.Next()) add_above_faces(graph, parts.Value(), found);
}

const std::string* problem_below(const Interface_Graph& graph, const Handle(Standard_Transient) & entity,
                                 const BadEntities& bad, Entities& seen) {
  // A curve in the parameters of a face is given besides the one in space, and for both faces along an edge.
  if (entity->IsKind(STANDARD_TYPE(StepGeom_Pcurve)) || !seen.insert(entity.get()).second) return nullptr;
  if (const auto at = bad.problems.find(entity.get()); at != bad.problems.end()) return &at->second;
  Interface_EntityIterator parts = graph.Shareds(entity);
  for (parts.Start(); parts.More(); parts.Next()) {
    if (const std::string* problem = problem_below(graph, parts.Value(), bad, seen)) return problem;
  }
  return nullptr;
}

}  // namespace

std::string entity_label(const Interface_InterfaceModel& model, const Handle(Standard_Transient) & entity) {
  return model.StringLabel(entity)->ToCString();
}

std::string surface_type(const StepShape_FaceSurface& face) {
  const Handle(StepGeom_Surface) surface = face.FaceGeometry();
  return surface.IsNull() ? "" : type_name(surface);
}

BadEntities bad_entities(const StepData_StepModel& model) {
  BadEntities bad;
  for (int i = 1; i <= model.NbEntities(); ++i) {
    const Handle(Interface_Check)& check = model.Check(i, Standard_True);
    const bool has_fails = !check.IsNull() && check->NbFails() > 0;
    if (!model.IsErrorEntity(i) && !has_fails) continue;
    const Handle(Standard_Transient)& entity = model.Value(i);
    if (!makes_the_shape(entity) || (has_fails && has_foreign_items_only(entity, *check))) {
      ++bad.others;
      continue;
    }
    bad.problems[entity.get()] = fmt::format("{} ({}): {}", entity_label(model, entity), type_name(entity),
                                             has_fails ? check->CFail(1) : "not understood");
  }
  return bad;
}

const std::string* problem_below(const Interface_Graph& graph, const Handle(Standard_Transient) & entity,
                                 const BadEntities& bad) {
  if (bad.problems.empty()) return nullptr;
  Entities seen;
  return problem_below(graph, entity, bad, seen);
}

void require_sound_entities(const StepData_StepModel& model, const Interface_Graph& graph, const BadEntities& bad,
                            bool leave_out_faces) {
  if (bad.problems.empty()) return;
  if (leave_out_faces) {
    Entities needed;
    for (int i = 1; i <= model.NbEntities(); ++i) {
      const Handle(Standard_Transient)& entity = model.Value(i);
      if (graph.Sharings(entity).NbEntities() == 0) add_above_faces(graph, entity, needed);
    }
    const bool faces_only = std::none_of(bad.problems.begin(), bad.problems.end(),
                                         [&](const auto& entry) { return needed.count(entry.first) > 0; });
    if (faces_only) return;
  }
  // In the order of the file.
  for (int i = 1; i <= model.NbEntities(); ++i) {
    if (const auto at = bad.problems.find(model.Value(i).get()); at != bad.problems.end()) {
      throw std::runtime_error(at->second);
    }
  }
}

std::vector<std::string> files_referred_to(const Interface_InterfaceModel& model) {
  std::vector<std::string> names;
  for (int i = 1; i <= model.NbEntities(); ++i) {
    const auto file = Handle(StepBasic_DocumentFile)::DownCast(model.Value(i));
    if (file.IsNull() || file->Id().IsNull() || file->Kind().IsNull() || file->Kind()->ProductDataType().IsNull())
      continue;
    const std::string name = file->Id()->ToCString();
    // Not drawings and other documents.
    if (std::string_view(file->Kind()->ProductDataType()->ToCString()) != "geometry" && !name.ends_with(".stp") &&
        !name.ends_with(".step")) {
      continue;
    }
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace abbe
