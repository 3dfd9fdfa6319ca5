#include "step_shape.h"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepTools_ReShape.hxx>
#include <Bnd_Box.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/number_text.h"
#include "step_entities.h"

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

bool has_faces(const TopoDS_Shape& shape) { return !shape.IsNull() && TopExp_Explorer(shape, TopAbs_FACE).More(); }

/// Labels the faces of the shape by their entities, and finds those that something in the file refers to, but that did
/// not become a face or contain what was not understood. @returns the latter, to be left out of the shape
std::vector<TopoDS_Shape> label_faces(STEPControl_Reader& reader, const Interface_Graph& graph, const BadFaces& bad,
                                      StepShape& result) {
  const Handle(Interface_InterfaceModel) model = reader.Model();
  const Handle(Transfer_TransientProcess) process = reader.WS()->TransferReader()->TransientProcess();
  std::vector<TopoDS_Shape> unsound;
  for (const auto& [number, face] : faces_in_use(*model, graph)) {
    const std::string label = entity_label(*model, face);
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, face);
    for (TopExp_Explorer part(shape, TopAbs_FACE); !shape.IsNull() && part.More(); part.Next()) {
      result.face_labels[part.Current().TShape().get()] = label;
    }
    if (const auto problem = bad.problems.find(number); problem != bad.problems.end()) {
      result.left_out.push_back(problem->second);
      if (!shape.IsNull()) unsound.push_back(shape);
    } else if (!has_faces(shape)) {
      result.left_out.push_back(face_label(*model, face) + " could not be converted");
    }
  }
  return unsound;
}

TopoDS_Shape without(const TopoDS_Shape& shape, const std::vector<TopoDS_Shape>& parts) {
  const Handle(BRepTools_ReShape) edit = new BRepTools_ReShape;
  for (const TopoDS_Shape& part : parts) {
    for (TopExp_Explorer face(part, TopAbs_FACE); face.More(); face.Next()) edit->Remove(face.Current());
  }
  return edit->Apply(shape);
}

[[noreturn]] void refuse_without_shape(const Interface_InterfaceModel& model) {
  const std::vector<std::string> files = files_referred_to(model);
  if (files.empty()) throw std::runtime_error("there is no shape in the file");
  throw StepRefused("there is no shape in the file; it refers to the files " + first_few(files, ", "),
                    "these files one by one, or the assembly exported as one file");
}

std::string unit_name(STEPControl_Reader& reader) {
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.FileUnits(lengths, angles, solid_angles);
  std::string names;
  for (const TCollection_AsciiString& length : lengths) {
    std::string name = length.ToCString();
    std::transform(name.begin(), name.end(), name.begin(), lower_case);
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

std::string StepShape::face_name(const TopoDS_Face& face) const {
  static constexpr const char* kKinds[] = {"plane",
                                           "cylinder",
                                           "cone",
                                           "sphere",
                                           "torus",
                                           "Bezier surface",
                                           "B-spline surface",
                                           "surface of revolution",
                                           "surface of extrusion",
                                           "offset surface"};
  const auto kind = static_cast<std::size_t>(BRepAdaptor_Surface(face, Standard_False).GetType());
  Bnd_Box box;
  BRepBndLib::Add(face, box, Standard_False);
  std::string place;
  if (!box.IsVoid() && !box.IsOpen()) {
    const gp_XYZ middle = 0.5 * (box.CornerMin().XYZ() + box.CornerMax().XYZ());
    // No minus zero.
    const auto text = [](double x) { return fmt::format("{:.4g}", std::abs(x) < 1e-9 ? 0 : x); };
    place = fmt::format(" about ({}, {}, {}) mm", text(middle.X()), text(middle.Y()), text(middle.Z()));
  }
  const auto at = face_labels.find(face.TShape().get());
  return fmt::format("{} ({}{})", at != face_labels.end() ? at->second : "without a number",
                     kind < std::size(kKinds) ? kKinds[kind] : "surface", place);
}

void refuse_faces(const std::vector<std::string>& faces) {
  throw StepRefused(
      (faces.size() == 1 ? "face " : fmt::format("{} faces cannot be read: ", faces.size())) + first_few(faces, "; "),
      "faces that can be read, or --leave-out-faces to continue without them");
}

StepShape read_step_shape(const std::string& path, bool leave_out_faces, const Handle(TimeLimit) & limit) {
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
  const Interface_Graph graph(model);
  const BadEntities bad = bad_entities(*model);
  const BadFaces in_faces = bad_faces(*model, graph, bad);
  // Before OpenCASCADE makes a shape of zeros.
  if (!in_faces.problems.empty() && !leave_out_faces) {
    std::vector<std::string> faces;
    for (const auto& [number, problem] : in_faces.problems) faces.push_back(problem);
    refuse_faces(faces);
  }
  if (bad.others > 0) {
    result.notes.push_back(counted(bad.others, "entity that is not geometry was not understood",
                                   "entities that are not geometry were not understood"));
  }
  if (in_faces.not_needed > 0) {
    result.notes.push_back(
        counted(in_faces.not_needed, "entity of parameter-space curves (PCURVE) or of unused faces was not understood",
                "entities of parameter-space curves (PCURVE) or of unused faces were not understood"));
  }
  const int roots = reader.NbRootsForTransfer();
  const int done = reader.TransferRoots(limit->Start());
  if (limit->is_over()) throw TimeIsUp{};
  const std::vector<TopoDS_Shape> unsound = label_faces(reader, graph, in_faces, result);
  if (!result.left_out.empty() && !leave_out_faces) refuse_faces(result.left_out);
  result.shape = reader.OneShape();
  if (!result.shape.IsNull() && !unsound.empty()) result.shape = without(result.shape, unsound);
  if (!result.left_out.empty() && !has_faces(result.shape)) {
    throw std::runtime_error("no face of the file can be read: " + first_few(result.left_out, "; "));
  }
  if (result.shape.IsNull()) refuse_without_shape(*model);
  // All faces are there, so that these are products without a shape.
  if (done < roots) {
    result.notes.push_back(fmt::format("{} of {} products of the file {} no shape", roots - done, roots,
                                       roots - done == 1 ? "has" : "have"));
  }
  if (const std::vector<std::string> files = files_referred_to(*model); !files.empty()) {
    result.notes.push_back("what stands in other files is missing: " + first_few(files, ", "));
  }
  Interface_CheckIterator checks = reader.WS()->TransferReader()->TransientProcess()->CheckList(Standard_False);
  std::size_t failed = 0;
  for (checks.Start(); checks.More(); checks.Next()) failed += checks.Value()->HasFailed() ? 1U : 0U;
  if (failed > 0) {
    result.notes.push_back(
        counted(failed, "entity of the file could not be converted", "entities of the file could not be converted"));
  }
  result.unit = unit_name(reader);
  result.size_mm = shape_size(result.shape);
  return result;
}

}  // namespace abbe
