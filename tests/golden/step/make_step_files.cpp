// Writes the STEP files of this folder by OpenCASCADE; see README.md.
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>
#include <gp_Ax2.hxx>

namespace {

void write(const TopoDS_Shape& shape, const char* file, const char* unit = "MM", int assembly = 0) {
  // The writer takes the unit when it is made.
  Interface_Static::SetCVal("write.step.unit", unit);
  Interface_Static::SetIVal("write.step.assembly", assembly);
  STEPControl_Writer writer;
  writer.Transfer(shape, STEPControl_AsIs);
  writer.Write(file);
}

/// Ellipse 30 mm by 6 mm in the plane z, turned by `turn`, as an interpolating spline.
TopoDS_Wire section(double z, double turn) {
  const Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, 16);
  for (int i = 0; i < 16; ++i) {
    const double t = 2 * M_PI * i / 16, x = 15 * std::cos(t), y = 3 * std::sin(t);
    points->SetValue(i + 1,
                     gp_Pnt(x * std::cos(turn) - y * std::sin(turn), x * std::sin(turn) + y * std::cos(turn), z));
  }
  GeomAPI_Interpolate curve(points, Standard_True, 1e-9);
  curve.Perform();
  return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(curve.Curve()).Edge()).Wire();
}

}  // namespace

int main() {
  STEPControl_Controller::Init();
  const TopoDS_Shape block = BRepPrimAPI_MakeBox(gp_Pnt(-10, -20, -30), gp_Pnt(30, 20, 10)).Shape();
  write(block, "block.step");
  write(BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), gp_Pnt(25.4, 50.8, 76.2)).Shape(), "block_inch.step", "INCH");
  const TopoDS_Shape plate = BRepPrimAPI_MakeBox(gp_Pnt(-20, -20, 0), gp_Pnt(20, 20, 30)).Shape();
  write(BRepAlgoAPI_Cut(plate, BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -1), gp_Dir(0, 0, 1)), 10, 32).Shape())
            .Shape(),
        "bored_block.step");
  write(BRepPrimAPI_MakeSphere(gp_Pnt(5, 6, 7), 12.703).Shape(), "sphere.step");
  write(BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -15), gp_Dir(0, 0, 1)), 12, 40).Shape(), "cylinder.step");
  write(BRepPrimAPI_MakeCone(10, 0, 20).Shape(), "cone.step");
  write(BRepPrimAPI_MakeTorus(25, 6).Shape(), "torus.step");
  BRep_Builder builder;
  TopoDS_Compound assembly;
  builder.MakeCompound(assembly);
  const TopoDS_Shape pin = BRepPrimAPI_MakeCylinder(4, 10).Shape();
  for (int i = 0; i < 3; ++i) {
    gp_Trsf place;
    place.SetTranslation(gp_Vec(20.0 * i, 0, 5));
    builder.Add(assembly, pin.Moved(TopLoc_Location(place)));
  }
  builder.Add(assembly, block);
  write(assembly, "assembly.step", "MM", 1);
  BRepOffsetAPI_ThruSections blade(Standard_True);
  for (int i = 0; i < 5; ++i) blade.AddWire(section(20.0 * i, 0.2 * i));
  write(blade.Shape(), "blade.step");
}
