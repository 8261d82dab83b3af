// Python bindings of one build of the kernel.

#include <nanobind/nanobind.h>

#include "lanes.hpp"

namespace nb = nanobind;

NB_MODULE(SKYKNOT_MODULE, module) {
    module.attr("vector_width") = skyknot::native_width;
}
