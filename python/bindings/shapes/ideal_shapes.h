#pragma once

#include <string>

#include "abbe/geometry/fits/shapes.h"
#include "bindings/bindings.h"

namespace abbe::python {

/// By the names of `abbe fit --shape`. @throws InputError that names them all
ShapeKind shape_kind(const std::string& shape);
std::string shape_kind_name(ShapeKind kind);

}  // namespace abbe::python
