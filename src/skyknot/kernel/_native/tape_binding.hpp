// The tape as Python sees it.
#pragma once

#include <nanobind/nanobind.h>

namespace skyknot::inline SKYKNOT_ISA {

void bind_tape(nanobind::module_& module);

}  // namespace skyknot::inline SKYKNOT_ISA
