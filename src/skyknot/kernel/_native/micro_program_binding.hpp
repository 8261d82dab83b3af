// Micro programs as Python sees them.
#pragma once

#include <nanobind/nanobind.h>

namespace skyknot::inline SKYKNOT_ISA {

void bind_micro_program(nanobind::module_& module);

}  // namespace skyknot::inline SKYKNOT_ISA
