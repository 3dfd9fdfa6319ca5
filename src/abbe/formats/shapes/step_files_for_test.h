#pragma once

// For tests: STEP files with known sizes.
#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace abbe::test {

inline std::filesystem::path golden_step_file(const char* name) {
  return std::filesystem::path(ABBE_GOLDEN) / "step" / name;
}

/// Text of a STEP file (mm) of one open shell, whose faces are added one by one.
class StepShell {
 public:
  using Corners = std::vector<std::array<double, 2>>;  // in the plane z = height

  /// A face in the plane z = height, with straight edges between these corners.
  void add_polygon(const Corners& corners, double height) {
    face(polygon(corners, height, corners.size()), plane(height, direction(0, 0, 1), direction(1, 0, 0)), true);
  }

  /// The same without the last edge.
  void add_open_polygon(const Corners& corners, double height) {
    face(polygon(corners, height, corners.size() - 1), plane(height, direction(0, 0, 1), direction(1, 0, 0)), true);
  }

  /// The edges of a polygon about a face in a plane across theirs, where they enclose no area.
  void add_polygon_across(const Corners& corners, double height) {
    face(polygon(corners, height, corners.size()), plane(height, direction(1, 0, 0), direction(0, 1, 0)), true);
  }

  /// The countersink of a hole along the x axis: from this radius at x = 0 at 45 degrees to the larger one at negative
  /// x. It is turned as a rotation leaves it, and OpenCASCADE 7.6 takes one side of its seam for the other.
  void add_countersink(double radius, double larger) {
    const double depth = larger - radius;
    const auto place = [&](double x) {
      const int at = point(x, 0, 0), axis = direction(-1, 0, 0);
      return add(fmt::format("AXIS2_PLACEMENT_3D('',#{},#{},#{})", at, axis, add("DIRECTION('',(0.,-1.,1.047E-14))")));
    };
    const int small = vertex(0, radius, 0), large = vertex(-depth, larger, 0);
    const int small_circle = edge(small, small, add(fmt::format("CIRCLE('',#{},{:.6f})", place(0), radius)));
    const int large_circle = edge(large, large, add(fmt::format("CIRCLE('',#{},{:.6f})", place(-depth), larger)));
    const int along = add(fmt::format("VECTOR('',#{},1.)", add("DIRECTION('',(-1.,1.,-1.06E-14))")));
    const int line = add(fmt::format("LINE('',#{},#{})", point(-depth, larger, 0), along));
    const int seam = edge(small, large, line);
    const std::string loop = oriented(small_circle, false) + "," + oriented(seam, true) + "," +
                             oriented(large_circle, true) + "," + oriented(seam, false);
    face(loop, add(fmt::format("CONICAL_SURFACE('',#{},{:.6f},0.785398163397448)", place(-depth), larger)), false);
  }

  std::string text() const {
    return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
           "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
           "#2=APPLICATION_CONTEXT('');\n#3=SHAPE_DEFINITION_REPRESENTATION(#4,#10);\n"
           "#4=PRODUCT_DEFINITION_SHAPE('','',#5);\n#5=PRODUCT_DEFINITION('','',#6,#9);\n"
           "#6=PRODUCT_DEFINITION_FORMATION('','',#7);\n#7=PRODUCT('','','',(#8));\n"
           "#8=PRODUCT_CONTEXT('',#2,'mechanical');\n#9=PRODUCT_DEFINITION_CONTEXT('part definition',#2,'design');\n"
           "#10=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#11),#13);\n#11=SHELL_BASED_SURFACE_MODEL('',(#12));\n"
           "#12=OPEN_SHELL('',(" +
           faces_ +
           "));\n#13=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#17))"
           "GLOBAL_UNIT_ASSIGNED_CONTEXT((#14,#15,#16))REPRESENTATION_CONTEXT('',''));\n"
           "#14=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
           "#15=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n"
           "#16=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n"
           "#17=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#14,'distance_accuracy_value','');\n" +
           data_ + "ENDSEC;\nEND-ISO-10303-21;\n";
  }

 private:
  int add(const std::string& entity) {
    data_ += fmt::format("#{}={};\n", next_, entity);
    return next_++;
  }
  int point(double x, double y, double z) {
    return add(fmt::format("CARTESIAN_POINT('',({:.6f},{:.6f},{:.6f}))", x, y, z));
  }
  int direction(double x, double y, double z) {
    return add(fmt::format("DIRECTION('',({:.6f},{:.6f},{:.6f}))", x, y, z));
  }
  int plane(double z, int normal, int reference) {
    const int placement = add(fmt::format("AXIS2_PLACEMENT_3D('',#{},#{},#{})", point(0, 0, z), normal, reference));
    return add(fmt::format("PLANE('',#{})", placement));
  }
  int vertex(double x, double y, double z) { return add(fmt::format("VERTEX_POINT('',#{})", point(x, y, z))); }
  int straight(double x, double y, double z, double dx, double dy, double dz) {
    const int from = point(x, y, z), along = direction(dx, dy, dz);
    return add(fmt::format("LINE('',#{},#{})", from, add(fmt::format("VECTOR('',#{},1.)", along))));
  }
  int edge(int from, int to, int curve) { return add(fmt::format("EDGE_CURVE('',#{},#{},#{},.T.)", from, to, curve)); }
  std::string oriented(int edge, bool forward) {
    return fmt::format("#{}", add(fmt::format("ORIENTED_EDGE('',*,*,#{},.{}.)", edge, forward ? 'T' : 'F')));
  }
  /// @returns the edges, as a loop has them
  std::string polygon(const Corners& corners, double height, std::size_t edges) {
    std::vector<int> vertices;
    std::string loop;
    for (const auto& [x, y] : corners) vertices.push_back(vertex(x, y, height));
    for (std::size_t i = 0; i < edges; ++i) {
      const std::size_t next = (i + 1) % corners.size();
      const double dx = corners[next][0] - corners[i][0], dy = corners[next][1] - corners[i][1];
      const int line = straight(corners[i][0], corners[i][1], height, dx, dy, 0);
      loop += (i > 0 ? "," : "") + oriented(edge(vertices[i], vertices[next], line), true);
    }
    return loop;
  }
  void face(const std::string& edges, int surface, bool same_sense) {
    const int bound = add(fmt::format("FACE_OUTER_BOUND('',#{},.T.)", add(fmt::format("EDGE_LOOP('',({}))", edges))));
    const int number = add(fmt::format("ADVANCED_FACE('',(#{}),#{},.{}.)", bound, surface, same_sense ? 'T' : 'F'));
    faces_ += fmt::format("{}#{}", faces_.empty() ? "" : ",", number);
  }

  int next_ = 20;
  std::string faces_, data_;
};

}  // namespace abbe::test
