#include "face_deviation.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <ElSLib.hxx>
#include <GProp_GProps.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace abbe {
namespace {

/// Nearest point of a surface that has a formula for it.
template <typename Elementary>
double distance_in_closed_form(const Elementary& surface, const gp_Pnt& point) {
  double u = 0, v = 0;
  ElSLib::Parameters(surface, point, u, v);
  return point.Distance(ElSLib::Value(u, v, surface));
}

std::optional<double> distance_in_closed_form(const BRepAdaptor_Surface& surface, const gp_Pnt& point) {
  switch (surface.GetType()) {
    case GeomAbs_Plane:
      return distance_in_closed_form(surface.Plane(), point);
    case GeomAbs_Cylinder:
      return distance_in_closed_form(surface.Cylinder(), point);
    case GeomAbs_Cone:
      return distance_in_closed_form(surface.Cone(), point);
    case GeomAbs_Sphere:
      return distance_in_closed_form(surface.Sphere(), point);
    case GeomAbs_Torus:
      return distance_in_closed_form(surface.Torus(), point);
    default:
      return std::nullopt;
  }
}

/// Distance to the surface from a start near its nearest point; never less than the distance.
double distance_by_steps(const BRepAdaptor_Surface& surface, const gp_Pnt& point, double u, double v) {
  const auto within = [](double x, double first, double last, bool periodic) {
    return periodic ? x : std::clamp(x, first, last);
  };
  gp_Pnt at;
  gp_Vec du, dv;
  surface.D1(u, v, at, du, dv);
  double nearest = point.Distance(at);
  for (int step = 0; step < 8; ++step) {
    const gp_Vec rest(at, point);
    const double a = du.SquareMagnitude(), b = du.Dot(dv), c = dv.SquareMagnitude();
    const double determinant = a * c - b * b;
    if (!(determinant > 1e-12 * a * c)) break;
    const double along_u = du.Dot(rest), along_v = dv.Dot(rest);
    const double next_u = within(u + (c * along_u - b * along_v) / determinant, surface.FirstUParameter(),
                                 surface.LastUParameter(), surface.IsUPeriodic());
    const double next_v = within(v + (a * along_v - b * along_u) / determinant, surface.FirstVParameter(),
                                 surface.LastVParameter(), surface.IsVPeriodic());
    surface.D1(next_u, next_v, at, du, dv);
    const double distance = point.Distance(at);
    if (!(distance < nearest * (1 - 1e-6))) return std::min(nearest, distance);
    nearest = distance;
    u = next_u;
    v = next_v;
  }
  return nearest;
}

/// The larger one. A distance that is no number would otherwise be lost in comparisons.
double larger(double distance, double largest) {
  if (!std::isfinite(distance)) throw std::runtime_error("a point of it is not finite");
  return std::max(distance, largest);
}

double distance_to_piece(const gp_XYZ& point, const gp_XYZ& begin, const gp_XYZ& end) {
  const gp_XYZ along = end - begin;
  const double square = along.SquareModulus();
  const double share = square > 0 ? std::clamp((point - begin).Dot(along) / square, 0.0, 1.0) : 0;
  return (point - begin - along * share).Modulus();
}

double edge_deviation(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangulation,
                      const TopLoc_Location& location, double largest) {
  // The pole of a sphere and the apex of a cone are edges without length.
  if (BRep_Tool::Degenerated(edge)) return largest;
  const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
  if (polygon.IsNull() || !polygon->HasParameters()) throw std::runtime_error("one of its edges was not divided");
  const BRepAdaptor_Curve curve(edge);
  const gp_Trsf part_from_face = location.Transformation();
  for (int i = 1; i < polygon->NbNodes(); ++i) {
    const gp_XYZ begin = triangulation->Node(polygon->Node(i)).Transformed(part_from_face).XYZ();
    const gp_XYZ end = triangulation->Node(polygon->Node(i + 1)).Transformed(part_from_face).XYZ();
    largest = larger(curve_deviation(curve, polygon->Parameter(i), polygon->Parameter(i + 1), begin, end), largest);
  }
  return largest;
}

bool is_empty(const Handle(Poly_Triangulation) & triangulation) {
  return triangulation.IsNull() || triangulation->NbTriangles() == 0;
}

}  // namespace

bool has_triangles(const TopoDS_Face& face) {
  TopLoc_Location location;
  return !is_empty(BRep_Tool::Triangulation(face, location));
}

Handle(Poly_Triangulation) triangles_of(const TopoDS_Face& face, TopLoc_Location& location) {
  const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
  if (is_empty(triangulation)) throw std::runtime_error("it has no triangles");
  return triangulation;
}

double face_area_mm2(const TopoDS_Face& face) try {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  return std::abs(properties.Mass());
} catch (const Standard_Failure&) {
  return std::numeric_limits<double>::quiet_NaN();
}

double curve_deviation(const BRepAdaptor_Curve& curve, double from, double to, const gp_XYZ& begin, const gp_XYZ& end) {
  constexpr int kParts = 8;
  double largest = 0;
  for (int k = 1; k < kParts; ++k) {
    const gp_Pnt point = curve.Value(from + (to - from) * k / kParts);
    largest = larger(distance_to_piece(point.XYZ(), begin, end), largest);
  }
  return largest;
}

FaceDeviation triangle_deviation(const BRepAdaptor_Surface& surface, const std::array<gp_XYZ, 3>& corners,
                                 const std::array<gp_XY, 3>* parameters, double small_mm) {
  FaceDeviation found;
  constexpr int kParts = 6;
  for (int a = 0; a <= kParts; ++a) {
    for (int b = 0; a + b <= kParts; ++b) {
      const double wa = a / double{kParts}, wb = b / double{kParts}, wc = 1 - wa - wb;
      const gp_Pnt point(corners[0] * wa + corners[1] * wb + corners[2] * wc);
      const bool is_corner = a == kParts || b == kParts || a + b == 0;
      double distance = 0;
      if (const std::optional<double> closed = distance_in_closed_form(surface, point)) {
        distance = *closed;
      } else {
        if (parameters == nullptr) throw std::runtime_error("its triangles have no parameters");
        const gp_XY uv = (*parameters)[0] * wa + (*parameters)[1] * wb + (*parameters)[2] * wc;
        distance = point.Distance(surface.Value(uv.X(), uv.Y()));
        const double known = is_corner ? found.corners_mm : found.triangles_mm;
        // The nearest point is not farther, and only the largest distance counts.
        if (distance > std::max(known, small_mm)) distance = distance_by_steps(surface, point, uv.X(), uv.Y());
      }
      found.triangles_mm = larger(distance, found.triangles_mm);
      if (is_corner) found.corners_mm = larger(distance, found.corners_mm);
    }
  }
  return found;
}

double edges_deviation(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangulation = triangles_of(face, location);
  double largest = 0;
  for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
    largest = edge_deviation(TopoDS::Edge(edge.Current()), triangulation, location, largest);
  }
  return largest;
}

}  // namespace abbe
