// The frozen metric as Python sees it.
#pragma once

#include <nanobind/nanobind.h>

namespace skyknot::inline SKYKNOT_ISA {

// After bind_interior_point, whose class it takes.
void bind_frozen_metric(nanobind::module_& module);

}  // namespace skyknot::inline SKYKNOT_ISA
