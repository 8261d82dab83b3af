#pragma once

#include <nanobind/nanobind.h>

namespace skyknot::inline SKYKNOT_ISA {

void bind_interior_point(nanobind::module_& module);

}  // namespace skyknot::inline SKYKNOT_ISA
