#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/formats/text/unit.h"

namespace abbe {

/// A named quantity at every point of a map.
struct MapField {
  std::string name;  ///< "before", "standard_uncertainty", "X"
  Quantity quantity = Quantity::length;
  std::string unit;                             ///< as written, one of the quantity's: "um", "urad", "deg", "mm"
  std::vector<std::vector<double>> components;  ///< [1 or 3][count], mm or rad
};

/// Points with quantities: what a map file holds. Structure of arrays.
struct MapData {
  std::array<std::vector<double>, 3> points;  ///< [count] mm, in the workpiece frame
  std::vector<MapField> fields;               ///< axis commands first, then errors
  /// Points per grid direction, first varying fastest; empty: the points are no grid.
  std::vector<std::size_t> grid;

  std::size_t count() const { return points[0].size(); }
};

/// CSV: point_x_mm.., then each field (three components: name_x_unit, ...).
std::string map_csv(const MapData& map);

/// VTK XML file for ParaView, binary data: a structured grid (.vts) where map_is_structured(), else an unstructured one
/// (.vtu) of single points. Field names carry the unit: "before (um)".
std::string map_vtk(const MapData& map);

/// What a file of this name holds: map_csv() of .csv, else map_vtk().
std::string map_text(const std::string& name, const MapData& map);
/// @throws InputError for a name that does not end in .csv, nor as map_vtk() of this map has it
void require_map_name(const std::string& name, const MapData& map);

/// True for a grid with at most three directions of more than one point.
bool map_is_structured(const MapData& map);

}  // namespace abbe
