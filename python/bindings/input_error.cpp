#include "abbe/formats/text/input_error.h"

#include "abbe/geometry/stopped.h"
#include "bindings/bindings.h"
#include "bindings/use/arguments.h"

namespace abbe::python {
namespace {

/// abbe.InputError with the place of the mistake; defined in Python, where it has a documentation and types.
void raise_input_error(const InputError& error) {
  const nb::object type = nb::module_::import_("abbe._errors").attr("InputError");
  const InputError::Place& place = error.place();
  const auto number_or_none = [](std::size_t number) -> nb::object {
    return number == 0 ? nb::none() : nb::object(nb::int_(number));
  };
  const auto text_or_none = [](const std::string& text) -> nb::object {
    // File names are bytes, not necessarily UTF-8.
    return text.empty() ? nb::none() : text_of_bytes(text);
  };
  const nb::object raised = type(text_of_bytes(error.what()), text_or_none(place.file), number_or_none(place.line),
                                 number_or_none(place.column), text_or_none(place.field), text_or_none(error.problem()),
                                 text_or_none(error.expected()));
  PyErr_SetObject(type.ptr(), raised.ptr());
}

}  // namespace

void bind_input_error(nb::module_&) {
  nb::register_exception_translator([](const std::exception_ptr& pointer, void*) {
    try {
      std::rethrow_exception(pointer);
    } catch (const InputError& error) {
      raise_input_error(error);
    } catch (const Stopped&) {
      PyErr_SetNone(nb::module_::import_("abbe._errors").attr("Stopped").ptr());
    }
  });
}

}  // namespace abbe::python
