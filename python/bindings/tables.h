#pragma once

// Tables of pandas and HTML for notebooks: written in Python (abbe/_tables.py), methods of the classes.
#include "bindings/bindings.h"

namespace abbe::python {

/// Adds to_dataframe() and, if `html_function` is not null, _repr_html_(); both call functions of abbe._tables.
template <class Class>
void add_tables(Class& bound, const char* frame_function, const char* html_function) {
  using Object = typename Class::Type;
  bound.def(
      "to_dataframe",
      [frame_function](nb::handle_t<Object> self) {
        return nb::module_::import_("abbe._tables").attr(frame_function)(self);
      },
      nb::sig("def to_dataframe(self) -> pandas.DataFrame"),
      "A table of pandas, which has to be installed. Lengths in um, angles in urad; commands in mm and degrees, "
      "readings\n"
      "in mm and rad, as the names of the columns say.");
  if (!html_function) return;
  bound.def(
      "_repr_html_",
      [html_function](nb::handle_t<Object> self) {
        return nb::module_::import_("abbe._tables").attr(html_function)(self);
      },
      nb::sig("def _repr_html_(self) -> str"));
}

}  // namespace abbe::python
