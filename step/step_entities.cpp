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

#include "abbe/formats/files/file_extension.h"

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

/// True where the only thing wrong is that a list of items has one that is not geometry, such as a note of a drawing.
/// A face that is missed for such a reason is found by its not becoming one.
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

bool is_face(const Handle(Standard_Transient) & entity) { return entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface)); }

bool is_pcurve(const Handle(Standard_Transient) & entity) { return entity->IsKind(STANDARD_TYPE(StepGeom_Pcurve)); }

/// Adds an entity and all that it refers to, but not what is left out or below that.
void add_with_parts(const Interface_Graph& graph, const Handle(Standard_Transient) & entity,
                    bool (*is_left_out)(const Handle(Standard_Transient) &), Entities& found) {
  if (is_left_out(entity) || !found.insert(entity.get()).second) return;
  Interface_EntityIterator parts = graph.Shareds(entity);
  for (parts.Start(); parts.More(); parts.Next()) add_with_parts(graph, parts.Value(), is_left_out, found);
}

}  // namespace

std::string entity_label(const Interface_InterfaceModel& model, const Handle(Standard_Transient) & entity) {
  return model.StringLabel(entity)->ToCString();
}

std::string face_label(const Interface_InterfaceModel& model, const Handle(StepShape_FaceSurface) & face) {
  const std::string label = entity_label(model, face);
  const Handle(StepGeom_Surface) surface = face->FaceGeometry();
  return surface.IsNull() ? label : fmt::format("{} ({})", label, type_name(surface));
}

std::map<int, Handle(StepShape_FaceSurface)> faces_in_use(const Interface_InterfaceModel& model,
                                                          const Interface_Graph& graph) {
  std::map<int, Handle(StepShape_FaceSurface)> faces;
  for (int i = 1; i <= model.NbEntities(); ++i) {
    const auto face = Handle(StepShape_FaceSurface)::DownCast(model.Value(i));
    if (!face.IsNull() && graph.Sharings(face).NbEntities() > 0) faces[i] = face;
  }
  return faces;
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
    bad.of_shape.push_back({entity.get(), fmt::format("{} ({}): {}", entity_label(model, entity), type_name(entity),
                                                      has_fails ? check->CFail(1) : "not understood")});
  }
  return bad;
}

BadFaces bad_faces(const StepData_StepModel& model, const Interface_Graph& graph, const BadEntities& bad) {
  BadFaces result;
  if (bad.of_shape.empty()) return result;
  Entities above_faces, in_faces;
  for (int i = 1; i <= model.NbEntities(); ++i) {
    const Handle(Standard_Transient)& entity = model.Value(i);
    if (graph.Sharings(entity).NbEntities() == 0) add_with_parts(graph, entity, is_face, above_faces);
  }
  for (const auto& [number, face] : faces_in_use(model, graph)) {
    Entities in_face;
    add_with_parts(graph, face, is_pcurve, in_face);
    for (const BadEntity& one : bad.of_shape) {
      if (in_face.count(one.entity) == 0) continue;
      const bool is_itself = one.entity == face.get();
      // Its own problem says more than that of a part of it.
      if (is_itself || result.problems.count(number) == 0) {
        result.problems[number] = is_itself ? one.problem : face_label(model, face) + " refers to " + one.problem;
      }
    }
    in_faces.insert(in_face.begin(), in_face.end());
  }
  for (const auto& [entity, problem] : bad.of_shape) {
    if (above_faces.count(entity) > 0) throw std::runtime_error(problem);
    if (in_faces.count(entity) == 0) ++result.not_needed;
  }
  return result;
}

std::vector<std::string> files_referred_to(const Interface_InterfaceModel& model) {
  std::vector<std::string> names;
  for (int i = 1; i <= model.NbEntities(); ++i) {
    const auto file = Handle(StepBasic_DocumentFile)::DownCast(model.Value(i));
    if (file.IsNull() || file->Id().IsNull() || file->Kind().IsNull() || file->Kind()->ProductDataType().IsNull())
      continue;
    const std::string name = file->Id()->ToCString();
    // Not drawings and other documents.
    const std::string extension = file_extension(name);
    if (std::string_view(file->Kind()->ProductDataType()->ToCString()) != "geometry" && extension != ".stp" &&
        extension != ".step") {
      continue;
    }
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace abbe
