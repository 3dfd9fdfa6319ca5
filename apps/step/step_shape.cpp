#include "step_shape.h"

#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "abbe/formats/number_text.h"

namespace abbe {
namespace {

/// Keeps what OpenCASCADE says.
class KeepingPrinter : public Message_Printer {
 public:
  explicit KeepingPrinter(std::ostringstream& text) : text_(text) { SetTraceLevel(Message_Trace); }

 protected:
  void send(const TCollection_AsciiString& words, Message_Gravity /*gravity*/) const override {
    text_ << words.ToCString() << '\n';
  }

 private:
  std::ostringstream& text_;
};

/// The place of an error of syntax in what OpenCASCADE said while it read.
std::string place_of_syntax_error(const std::string& messages) {
  const std::size_t at = messages.rfind("Line ");
  if (at == std::string::npos) return "OpenCASCADE does not understand the file";
  std::string text = messages.substr(at, messages.find('\n', at) - at);
  text.erase(std::min(text.size(), text.find("****")));
  while (!text.empty() && text.back() == ' ') text.pop_back();
  text.front() = 'l';
  return text;
}

/// True for what shape, place and size come from.
bool makes_the_shape(const Handle(Standard_Transient) & entity) {
  const std::string_view type = entity->DynamicType()->Name();
  return type.starts_with("StepGeom_") || type.starts_with("StepShape_") || type.starts_with("StepRepr_") ||
         type.starts_with("StepBasic_");
}

/// OpenCASCADE goes on with zeros where it could not read a parameter. @throws std::runtime_error
void require_sound_entities(const StepData_StepModel& model, std::vector<std::string>& notes) {
  int others = 0;
  for (int i = 1; i <= model.NbEntities(); ++i) {
    const Handle(Interface_Check)& check = model.Check(i, Standard_True);
    if (!model.IsErrorEntity(i) && (check.IsNull() || check->NbFails() == 0)) continue;
    const Handle(Standard_Transient)& entity = model.Value(i);
    if (!makes_the_shape(entity)) {
      ++others;
      continue;
    }
    std::string type = entity->DynamicType()->Name();
    type.erase(0, type.find('_') + 1);
    throw std::runtime_error(fmt::format("{} ({}): {}", model.StringLabel(entity)->ToCString(), type,
                                         check.IsNull() || check->NbFails() == 0 ? "not understood" : check->CFail(1)));
  }
  if (others > 0) notes.push_back(fmt::format("{} entities that are no geometry were not understood", others));
}

/// Faces that something in the file refers to, but that did not become a face.
int lost_faces(STEPControl_Reader& reader) {
  const Handle(Interface_InterfaceModel) model = reader.Model();
  const Handle(Transfer_TransientProcess) process = reader.WS()->TransferReader()->TransientProcess();
  const Interface_Graph graph(model);
  int lost = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    if (!entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface))) continue;
    if (graph.Sharings(entity).NbEntities() == 0) continue;
    if (TransferBRep::ShapeResult(process, entity).IsNull()) ++lost;
  }
  return lost;
}

std::string unit_name(STEPControl_Reader& reader) {
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.FileUnits(lengths, angles, solid_angles);
  std::string names;
  for (const TCollection_AsciiString& length : lengths) {
    std::string name = length.ToCString();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    if (names.find(name) == std::string::npos) names += (names.empty() ? "" : ", ") + name;
  }
  return names;
}

/// Largest extent. @throws std::runtime_error if there is none or it is beyond all measure
double shape_size(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (box.IsVoid()) throw std::runtime_error("there is no shape in the file");
  double numbers[6] = {};
  box.Get(numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]);
  for (const double number : numbers) {
    // Not "larger than": NaN has to fail, and an open box is very large.
    if (!(std::abs(number) <= kLargestInput)) {
      throw std::runtime_error(fmt::format("the shape reaches beyond {:g} mm", kLargestInput));
    }
  }
  return std::max({numbers[3] - numbers[0], numbers[4] - numbers[1], numbers[5] - numbers[2]});
}

}  // namespace

StepShape read_step_shape(const std::string& path) {
  std::ostringstream messages;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  Message::DefaultMessenger()->AddPrinter(new KeepingPrinter(messages));
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  const IFSelect_ReturnStatus status = reader.ReadFile(path.c_str());
  const Handle(StepData_StepModel) model = reader.StepModel();
  if (status != IFSelect_RetDone || model.IsNull()) {
    throw std::runtime_error(place_of_syntax_error(messages.str()));
  }
  StepShape result;
  require_sound_entities(*model, result.notes);
  const int roots = reader.NbRootsForTransfer();
  if (roots == 0) throw std::runtime_error("there is no shape in the file");
  const int done = reader.TransferRoots();
  if (done < roots) {
    throw std::runtime_error(fmt::format("{} of {} shapes of the file could not be converted", roots - done, roots));
  }
  if (const int lost = lost_faces(reader); lost > 0) {
    throw std::runtime_error(fmt::format("{} of the file's faces could not be converted", lost));
  }
  Interface_CheckIterator checks = reader.WS()->TransferReader()->TransientProcess()->CheckList(Standard_False);
  int failed = 0;
  for (checks.Start(); checks.More(); checks.Next()) failed += checks.Value()->HasFailed() ? 1 : 0;
  if (failed > 0) result.notes.push_back(fmt::format("{} entities of the file could not be converted", failed));
  result.unit = unit_name(reader);
  result.shape = reader.OneShape();
  if (result.shape.IsNull()) throw std::runtime_error("there is no shape in the file");
  result.size_mm = shape_size(result.shape);
  return result;
}

}  // namespace abbe
